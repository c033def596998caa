"""Versions: all that a student has handed in for a problem set, each of it kept, the latest where grading finds it.

In:  the files of one submission, and when it came.
Out: ``collected/<problem set>/<student>/<version>/`` and, beside them, ``collected.json``, which says where they came
     from; ``submitted/<student>/<problem set>/``, a copy of the latest.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from ..arguments import short
from ..formats.files import bounded_read, naming, write_atomically
from ..formats.values import parsed
from .course import Course
from .handed_in import tree_hash
from .late import NBGRADER_TIME

TIMESTAMP = "timestamp.txt"  # nbgrader's own: beside a notebook, the time it came
BY_HAND = "submitted/"  # the source of what a teacher has put there


@dataclass
class Version:
    """One submission of one student: when it came, from where, and what is to be known about it."""

    student: str
    when: str  # it was handed in, by ISO 8601, in UTC; empty if nothing tells
    packed: str  # what its file says; an LMS's archive may say when it was made
    source: str
    notebook: str  # the name it came with
    sender: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    folder: str = ""  # in collected/
    hash: str = ""

    @property
    def order(self) -> tuple[str, str]:
        """The latest is the greatest; of the same time, Canvas's later attachment."""
        return self.when or self.packed, self.sender.get("attachment", "").zfill(20)


def versions_of(course: Course, name: str) -> dict[str, list[Version]]:
    """Return what was collected of a problem set, student by student, the latest last."""
    path = course.root / "collected" / name / "collected.json"
    versions: dict[str, list[Version]] = {}
    if path.is_file():
        with naming(f"collected/{name}/{path.name}"):
            for told in parsed(bounded_read(path)):
                if not isinstance(told, dict) or {*told} != {*Version.__dataclass_fields__}:
                    raise ValueError(f"must hold what was collected, got {short(told)}: put it away, and collect again")
                versions.setdefault(told["student"], []).append(Version(**told))
    return versions


class Book:
    """What was collected of a problem set, in a file and folders; written whole after each change."""

    def __init__(self, course: Course, name: str) -> None:
        self.course, self.name = course, name
        self.root = course.root / "collected" / name
        self.versions = versions_of(course, name)

    def add(self, new: Version, files: Mapping[str, bytes]) -> None:
        """Keep a version and its files, unless they are here already."""
        new.hash, have = _hash(files), self.versions.setdefault(new.student, [])
        came = (version for version in reversed(have) if version.source != BY_HAND)
        same = next((version for version in came if version.hash == new.hash), None)
        # A copy of what counts is no later submission; what was handed in again after another one is.
        if same is not None and (same is have[-1] or new.order[0] <= have[-1].order[0]):
            if (same.sender or new.sender, same.when or new.when) == (same.sender, same.when):
                return
            same.sender, same.when = same.sender or new.sender, same.when or new.when
            new = same
        else:
            stamp = re.sub(r"[-:]|\+.*", "", new.order[0]).replace("T", "-") or "unknown"
            new.folder = f"{new.student}/{stamp}-{new.hash[:8]}"
            for path, content in files.items():
                target = self.root / new.folder / path
                target.parent.mkdir(parents=True, exist_ok=True)
                write_atomically(target, content)
            have.append(new)
        if new.when:  # as nbgrader reads it
            when = datetime.fromisoformat(new.when).astimezone(UTC)
            write_atomically(self.root / new.folder / TIMESTAMP, when.strftime(NBGRADER_TIME))
        have.sort(key=lambda version: version.order)
        self.write()

    def write(self) -> None:
        """Write down what is kept."""
        told = [asdict(version) for _, versions in sorted(self.versions.items()) for version in versions]
        self.root.mkdir(parents=True, exist_ok=True)
        write_atomically(self.root / "collected.json", json.dumps(told, indent=1, ensure_ascii=False))

    def hand_over(self, student: str) -> bool:
        """Put a student's latest version where grading finds it; return whether it was not there.

        What somebody has put there by hand, an earlier version among them, becomes one more version, of the time when
        it was written; how late it is says its ``timestamp.txt`` alone.
        """
        place, have = self.course.root / "submitted" / student / self.name, self.versions[student]
        files, latest = _files(place), have[-1]
        code = _hash({path.relative_to(place).as_posix(): path.read_bytes() for path in files})
        written = _written(files)
        chosen = code != latest.hash and written > _written(_files(self.root / latest.folder))
        if files and (chosen or all(version.hash != code for version in have)):
            moment = datetime.fromtimestamp(written, UTC)
            folder, told = f"{student}/{moment:%Y%m%d-%H%M%S}-{code[:8]}", moment.isoformat(timespec="seconds")
            shutil.copytree(place, self.root / folder, dirs_exist_ok=True)
            sender = next((version.sender for version in reversed(have) if version.sender), {})
            have.append(Version(student, "", told, BY_HAND, "by hand", sender, folder=folder, hash=code))
            have.sort(key=lambda version: version.order)
            self.write()
        latest = have[-1]
        if not files or tree_hash(place) != tree_hash(self.root / latest.folder):
            new, old = (place.with_name(f".{self.name}.{which}") for which in ("new", "old"))
            for each in (new, old):
                shutil.rmtree(each, ignore_errors=True)
            shutil.copytree(self.root / latest.folder, new)
            if place.exists():
                place.rename(old)
            new.rename(place)
            shutil.rmtree(old, ignore_errors=True)
        return latest.hash != code


def _files(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.is_file() and path.name != TIMESTAMP]


def _written(files: Iterable[Path]) -> float:
    return max((path.stat().st_mtime for path in files), default=0.0)


def _hash(files: Mapping[str, bytes]) -> str:
    """Return a hash of files: their names and what is in them."""
    digest = hashlib.sha256()
    for path, content in sorted(files.items()):
        digest.update(os.fsencode(path) + f"\0{len(content)}\0".encode() + content)
    return digest.hexdigest()
