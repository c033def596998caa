"""The command line: ``primkit``, or ``python -m primkit``.

In:  a command and its options; ``primkit map --help`` explains them.
Out: text on the screen, files in a folder, and an exit code: 0 done, 1 ``primkit teach`` found a fault, 2 a wrong
     value or a file that cannot be read or written (one sentence on stderr says which), 130 stopped by Ctrl-C.

>>> main(["--version"])  # doctest: +ELLIPSIS
primkit ...
0

Only argparse is loaded at first; each command loads what it needs, so that ``--help`` answers at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from . import __version__
from .commands import board, doctor, lessons, studies, teach
from .commands.words import LOOK, Parser, exit_code, nearest

COMMANDS = {
    "map": (board.map_board, board.MAP_TEXT, board.MAP_EXAMPLES, board.map_options),
    "study": (studies.study, studies.STUDY_TEXT, studies.STUDY_EXAMPLES, studies.study_options),
    "accuracy": (studies.accuracy, studies.ACCURACY_TEXT, studies.ACCURACY_EXAMPLES, studies.accuracy_options),
    "make-map": (board.make_map, board.MAKE_TEXT, board.MAKE_EXAMPLES, board.make_map_options),
    "lessons": (lessons.write_lessons, lessons.LESSONS_TEXT, lessons.LESSONS_EXAMPLES, lessons.lessons_options),
    "doctor": (doctor.doctor, doctor.DOCTOR_TEXT, doctor.DOCTOR_EXAMPLES, doctor.doctor_options),
    "teach": (teach.teach, teach.TEACH_TEXT, teach.TEACH_EXAMPLES, teach.teach_options),
}
TEXT = "Map circles, triangles, rectangles and pentagons with a simulated robot and its LiDAR."
EXAMPLES = """\
examples:
  primkit map                            a random board with four shapes, into out/
  primkit study                          repeat the paper's Tables 1 and 2
  primkit make-map --shapes 6 --style free --out room.geojson
  primkit map --map room.geojson         a board of your own
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Parameters
    ----------
    argv : sequence of str, optional
        The words after ``primkit``; those of the command line when not given.
    """

    def run() -> None:
        arguments = _parse(sys.argv[1:] if argv is None else list(argv))
        arguments.run(arguments)

    return exit_code(run)


def _parse(words: list[str]) -> argparse.Namespace:
    """Read the words of the command line."""
    parser = Parser(prog="primkit", description=TEXT, epilog=EXAMPLES, **LOOK)
    parser.add_argument("--version", action="version", version=f"primkit {__version__}")
    parser.set_defaults(run=lambda _: parser.print_help())
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for name, (run, text, examples, add_options) in COMMANDS.items():
        description = f"{text[0].upper()}{text[1:]}."
        command = commands.add_parser(name, help=text, description=description, epilog=examples, **LOOK)
        command.set_defaults(run=run)
        add_options(command)
    if words and not words[0].startswith("-") and words[0] not in COMMANDS:
        parser.error(f"there is no command {words[0]!r}{nearest(words[0], COMMANDS)}")
    return parser.parse_args(words)


if __name__ == "__main__":
    sys.exit(main())
