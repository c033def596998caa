"""Untrusted: what grading runs, what that can reach, and how to confine it, stated plainly.

``primkit teach grade --help`` ends with these words.
"""

UNTRUSTED_WORDS = """\
what grading runs, and what it can reach:
  Grading runs the code that students hand in. It runs in a process of its own;
  tests, truth, points and gradebook never are in that process: they stay with
  the judge, which calls the student's functions from outside and compares what
  comes back. So no code can make its own tests pass.
  Where bubblewrap is installed (Linux), that process stands behind walls: it
  sees Python, the library and a scratch copy of the submission, read only but
  for the copy; no other file, no network, no other process; and what it leaves
  behind ends with it. `primkit teach check` says whether the walls stand.
  Where they do not, every report says "unprotected": the code then runs as
  you, and can open and delete your files. For people whom you do not know,
  grade in a container without a network then, and say so by the variable:
    docker run --rm --network none --memory 6g -v "$PWD":/course -w /course \\
      -e PRIMKIT_CONFINED_BY="a container" IMAGE primkit teach grade ps1
  (IMAGE: one with the project installed; mount a copy of the course.) On Linux
  the process is refused more memory than its limit; on Windows and macOS it is
  ended about a second after it has taken more.
"""
