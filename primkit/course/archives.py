"""Archives: every file in zips, folders and e-mails, unpacked within limits, wherever it lies.

In:  files and folders as a teacher has them from an LMS, nbgrader's exchange or a mail program.
Out: a ``Found`` for each file: the names that lead to it, its time, and a copy in a scratch folder under a name of our
     own, so that no name in an archive ever leads anywhere; a ``Refused`` for what cannot be opened, with the reason.

A small archive that unpacks to much, within others or not, is stopped at ``MOST_INNER`` bytes; the download itself may
be large, as each of its files may have ``MOST_FILE`` bytes.
"""

from __future__ import annotations

import email
import email.policy
import email.utils
import os
import re
import struct
import time
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ..formats.files import bounded_read

MOST_FILE = 64 * 2**20  # bytes of a file: a notebook with a dozen large pictures has 54 MB
MOST_INNER = 256 * 2**20  # bytes that one archive within a download, and those within it, unpack to
MOST_MEMBERS = {True: 100_000, False: 1_000}  # of a download, and of an archive within it
DEEPEST = 4  # archives within archives
PIECE = 2**20  # bytes that are unpacked at once
JUNK = re.compile(r"\..*|__MACOSX|__pycache__|Thumbs\.db|desktop\.ini|~.*", re.IGNORECASE)
OTHER_ARCHIVES = (".rar", ".7z", ".tar", ".gz", ".tgz", ".bz2", ".xz")
UNKNOWN_TIME = time.mktime((1980, 1, 2, 0, 0, 0, 0, 0, -1))  # nothing was handed in before
BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, struct.error)


@dataclass(frozen=True)
class Found:
    """A file: the names that lead to it, when it was written (s since 1970, 0 if unknown), and where its copy lies."""

    parts: tuple[str, ...]
    when: float
    path: Path
    mail: str = ""  # the address it came from

    @property
    def place(self) -> str:
        """Say where it was found."""
        return "/".join(self.parts)


@dataclass(frozen=True)
class Refused:
    """What cannot be opened, and why."""

    place: str
    says: str


def unpack(paths: Iterable[Path], scratch: Path) -> Iterator[Found | Refused]:
    """Yield every file in files and folders."""
    unpacking = _Unpacking(scratch)
    for path in paths:
        if not path.exists():
            raise ValueError(f"there is no {path} to collect from")
        if not path.is_dir():
            yield from unpacking.file((readable_name(path.name),), path, path.stat().st_mtime, "")
            continue
        for folder, folders, files in os.walk(path):
            folders[:] = sorted(name for name in folders if not JUNK.fullmatch(name))
            for name in sorted(files):
                file = Path(folder, name)
                parts = (path.resolve().name, *file.relative_to(path).parts)
                if file.is_file() and not file.is_symlink() and not JUNK.fullmatch(name):
                    yield from unpacking.file(tuple(map(readable_name, parts)), file, file.stat().st_mtime, "")


def readable_name(name: str) -> str:
    r"""Return a name that is no UTF-8, as from an old archive of Windows, with the letters of cp1252.

    >>> readable_name(os.fsdecode(b"aufgabe_\xfc.txt")) if os.name == "posix" else "aufgabe_ü.txt"
    'aufgabe_ü.txt'
    """
    return name if name.isprintable() else os.fsencode(name).decode("cp1252", "replace")


class _Unpacking:
    """Unpacks into a scratch folder, where files have numbers for names."""

    def __init__(self, scratch: Path) -> None:
        self.scratch, self.count, self.left = scratch, 0, 0

    def file(
        self, parts: tuple[str, ...], path: Path, when: float, mail: str, depth: int = 0
    ) -> Iterator[Found | Refused]:
        """Yield a file, or those in it."""
        place, ending = "/".join(parts), Path(parts[-1]).suffix.lower()
        if depth == 0:
            self.left = MOST_INNER
        try:
            if path.stat().st_size > MOST_FILE and not (depth == 0 and ending in (".zip", ".eml")):
                yield Refused(place, f"has more than {MOST_FILE >> 20} MB: let its outputs be cleared")
            elif ending == ".zip":
                yield from self._zip(parts, path, when, mail, depth)
            elif ending == ".eml":
                yield from self._mail(parts, path, depth)
            elif ending in OTHER_ARCHIVES:
                yield Refused(place, f"is a {ending} archive: unpack it, and collect the folder")
            else:
                yield Found(parts, when if when > UNKNOWN_TIME else 0.0, path, mail)
        except BROKEN as error:
            yield Refused(place, f"cannot be unpacked: {' '.join(str(error).split()) or type(error).__name__}")
        except ValueError as error:
            yield Refused(place, str(error))

    def _zip(self, parts: tuple[str, ...], path: Path, when: float, mail: str, depth: int) -> Iterator[Found | Refused]:
        if depth >= DEEPEST:
            raise ValueError(f"lies within {DEEPEST} archives: unpack it, and collect the folder")
        with zipfile.ZipFile(path) as archive:
            members = [member for member in archive.infolist() if not member.is_dir()]
            if len(members) > MOST_MEMBERS[depth == 0]:
                raise ValueError(f"must hold at most {MOST_MEMBERS[depth == 0]:,} files, got {len(members):,}")
            for member in members:
                inner = tuple(part for part in re.split(r"[/\\]+", _name(member)) if part)
                if not inner or any(JUNK.fullmatch(part) and part not in (".", "..") for part in inner):
                    continue
                if {".", ".."} & set(inner) or re.match(r"[/\\]|\w:", member.filename):
                    yield Refused("/".join((*parts, *inner)), "has a name that leads out of its archive")
                    continue
                if depth == 0:
                    self.left = MOST_INNER
                try:
                    copy = self._copied(archive, member)
                except BROKEN as error:
                    yield Refused("/".join((*parts, *inner)), f"cannot be unpacked: {error}")
                    continue
                # The times in an archive within another one are its student's own.
                written = _time(member) if depth == 0 else 0.0
                yield from self.file((*parts, *inner), copy, max(written, 0.0) or when, mail, depth + 1)

    def _mail(self, parts: tuple[str, ...], path: Path, depth: int) -> Iterator[Found | Refused]:
        message = email.message_from_bytes(bounded_read(path, MOST_INNER), policy=email.policy.default)
        sender = email.utils.parseaddr(str(message.get("From", "")))[1]
        when = path.stat().st_mtime
        with suppress(ValueError, TypeError):
            when = email.utils.parsedate_to_datetime(str(message["Date"])).timestamp()
        for attached in message.iter_attachments():
            name = readable_name(Path((attached.get_filename() or "").replace("\\", "/")).name)
            content = attached.get_payload(decode=True)
            if name and isinstance(content, bytes) and not JUNK.fullmatch(name):
                with self._new().open("xb") as file:
                    file.write(content)
                yield from self.file((*parts, name), Path(file.name), when, sender, depth + 1)

    def _copied(self, archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> Path:
        """Unpack a member piece by piece, until it has taken too much."""
        path, taken = self._new(), 0
        with archive.open(member) as packed, path.open("xb") as file:
            while piece := packed.read(PIECE):
                taken += file.write(piece)
                self.left -= len(piece)
                if self.left < 0:
                    raise ValueError(f"unpacks to more than {MOST_INNER >> 20} MB")
                if taken > MOST_FILE:
                    break  # its size tells that it is too large
        return path

    def _new(self) -> Path:
        self.count += 1
        return self.scratch / f"{self.count}"


def _name(member: zipfile.ZipInfo) -> str:
    """Return a member's name: zipfile takes what is not marked as UTF-8 for cp437, and often it is another one."""
    if member.flag_bits & 0x800:
        return member.filename
    raw = member.orig_filename.encode("cp437", "replace")
    with suppress(UnicodeDecodeError):
        return raw.decode()
    upper = [byte for byte in raw if byte >= 0x80]
    return raw.decode("cp1252", "replace") if min(upper) >= 0xC0 else member.filename


def _time(member: zipfile.ZipInfo) -> float:
    """Return when a member was written: in UTC where its archive says so, else by this computer's clock."""
    extra = member.extra
    while len(extra) >= 9:
        kind, size = struct.unpack_from("<HH", extra)
        if kind == 0x5455 and size >= 5 and extra[4] & 1:
            return float(struct.unpack_from("<i", extra, 5)[0])
        extra = extra[4 + size :]
    try:
        return time.mktime((*member.date_time, 0, 0, -1))
    except (ValueError, OverflowError):
        return 0.0
