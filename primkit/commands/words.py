"""Words: reading what was typed, and printing.

In:  words of the command line.
Out: values; or one sentence that states the rule and the word, and the nearest word that is known.

>>> whole("4"), millimetres("0.5")
(4, 0.5)
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from ..installed import Finding, install_line
from ..table import count

# What the library's sentences call differently.
OPTIONS = {'style="free"': "--style free"}
LOOK: dict[str, Any] = {"formatter_class": argparse.RawDescriptionHelpFormatter, "allow_abbrev": False}


# --- in -----------------------------------------------------------------------------------------------------


class Parser(argparse.ArgumentParser):
    """A parser that refuses in one sentence, without the usage in front of it."""

    def error(self, message: str) -> NoReturn:
        """End with a sentence."""
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Refuse unknown words here, where the options of this very command are known."""
        known, others = super().parse_known_args(args, namespace)
        if others:
            word = others[0].partition("=")[0]
            if not word.startswith("-"):
                self.error(f"there is no place for {word!r}")
            options = [option for action in self._actions for option in action.option_strings]
            self.error(f"there is no option {word!r}{nearest(word, options)}")
        return known, others

    def option(self, name: str, metavar: str, kind: Callable[[str], Any], default: Any, text: str, **more: Any) -> None:
        """Add an option whose help ends with its default."""
        if "shown" in more:
            default, shown = None, more.pop("shown")
        else:
            shown = f"{default:g}" if isinstance(default, float) else default
        self.add_argument(name, metavar=metavar, type=kind, default=default, help=f"{text} (default: {shown})", **more)

    def choice(self, name: str, words: Sequence[str], text: str, **more: Any) -> None:
        """Add an option that takes one of these words, the first by default."""

        def one_of(word: str) -> str:
            if word not in words:
                raise argparse.ArgumentTypeError(f"must be {' or '.join(words)}, got {word!r}")
            return word

        self.option(name, "|".join(words), one_of, words[0], text, **more)


def nearest(word: str, known: Iterable[str]) -> str:
    """Return the end of a sentence that names the known word which looks most like this one, if any does.

    >>> nearest("--shape", ["--shapes", "--seed"]), nearest("--colour", ["--shapes", "--seed"])
    ("; did you mean '--shapes'?", '')
    """
    names = {name.lstrip("-"): name for name in known}  # the dashes are alike in all of them
    close = get_close_matches(word.lstrip("-"), names, n=1)
    return f"; did you mean {names[close[0]]!r}?" if close else ""


def path(word: str) -> Path:
    """Read the name of a file or folder."""
    if not word.strip():
        raise argparse.ArgumentTypeError(f"must be the name of a file or folder, got {word!r}")
    return Path(word)


def whole(word: str, least: int = 0, most: int = 10**19) -> int:
    """Read a whole number."""
    if not (word.isascii() and word.isdigit() and len(word) < 20 and least <= int(word) <= most):
        rule = f"must be a whole number >= {least}" + (f" and at most {most:,}" if most < 10**19 else "")
        raise argparse.ArgumentTypeError(f"{rule}, got {word!r}")
    return int(word)


def _number(word: str, most: float, rule: str) -> float:
    try:
        number = float(word)
    except ValueError:
        number = -1.0
    if not 0 <= number <= most:
        raise argparse.ArgumentTypeError(f"must be {rule}, got {word!r}")
    return number


millimetres = partial(_number, most=sys.float_info.max, rule="a number of millimetres >= 0")
share = partial(_number, most=1.0, rule="a share from 0 to 1")


# --- out ----------------------------------------------------------------------------------------------------


def say(text: str) -> None:
    """Print; what the console has no sign for, in the name of a file, is spelled out."""
    encoding = sys.stdout.encoding or "utf-8"
    print(text.encode(encoding, "backslashreplace").decode(encoding))


def tell_faults(findings: Sequence[Finding]) -> None:
    """Print what was looked at, and how many faults there are; end with 1 if there is one."""
    for finding in findings:
        say(str(finding))
    faults = sum(not finding.fine for finding in findings)
    say(f"{count(faults, 'fault')} found" if faults else "All is there.")
    if faults:
        raise SystemExit(1)


def meanwhile(text: str) -> None:
    """Tell who waits at a terminal what takes more than two seconds from now on."""
    if sys.stderr.isatty():
        print(f"primkit: {text}", file=sys.stderr)


def exit_code(run: Callable[[], None]) -> int:
    """Run a command, and return its exit code: 0 done, 2 a sentence on stderr says what was wrong, 130 Ctrl-C."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # under pythonw, and after `>&-`: nobody listens
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 - as long as Python runs
    try:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = partial(_note, warnings.showwarning)
                run()
        finally:
            sys.stdout.flush()  # that nobody reads on is noticed here, not while Python shuts down
    except SystemExit as end:  # argparse's, after --help or a wrong value
        return int(end.code or 0)
    except BrokenPipeError:  # as in `primkit study | head`: nobody reads on, and nothing is wrong
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt as stop:
        return _complain(str(stop) or "stopped by Ctrl-C", 130)
    except MemoryError:
        return _complain("there is not enough memory for this: is a map, a size or a number too large?")
    except ModuleNotFoundError as error:
        if (error.name or __name__).partition(".")[0] == __name__.partition(".")[0]:
            raise
        teachers = install_line("teach")
        return _complain(f"{error.name} is not installed: run primkit doctor; what teachers need comes with {teachers}")
    except OSError as error:
        # Sentences from formats stand alone; the system's own come in parts.
        return _complain(f"{error.filename}: {error.strerror}" if error.filename else str(error))
    except ValueError as error:
        sentence = str(error)
        for name, option in OPTIONS.items():
            sentence = sentence.replace(name, option)
        return _complain(f"{sentence}{''.join(f' ({note})' for note in getattr(error, '__notes__', ()))}")
    return 0


def _note(otherwise: Callable[..., None], message: Warning | str, category: type[Warning], *place: Any) -> None:
    """Print what is likely wrong as a sentence; other warnings as usual."""
    from ..arguments import LikelyWrong

    if issubclass(category, LikelyWrong):
        print(f"primkit: {message}", file=sys.stderr)
    else:
        otherwise(message, category, *place)


def _complain(sentence: str, code: int = 2) -> int:
    print(f"primkit: {sentence}", file=sys.stderr)
    return code
