"""Untrusted: what grading runs, what that can reach, and how to confine it, stated plainly.

``primkit teach grade --help`` ends with these words.
"""

UNTRUSTED_WORDS = """\
what grading runs, and what it can reach:
  Grading runs the code that students hand in, on this computer and as you: it
  can read and write what you can, and use the network. Each submission runs
  in a scratch copy of its folder, with limits of time and memory, a home
  folder of its own and none of your environment's variables. That keeps
  accidents apart: endless loops, deleted files, a kernel that ends. It is no
  wall against malice: code that means harm can open your files by their full
  names, the gradebook, grader/ and salt.txt among them, and can make its own
  hidden tests pass. For people you do not know, grade as another user who
  owns a copy of the course and nothing else, or in a container without a
  network, and bring gradebook.db and the reports back:
    docker run --rm --network none --memory 6g -v "$PWD":/course -w /course \\
      IMAGE primkit teach grade ps1
  (IMAGE: one with the project installed). On Linux the kernel is refused more
  memory than its limit; on Windows and macOS it is ended about a second after
  it has taken more.
"""
