"""Late: when a problem set is due, for whom later, and what a late day costs.

In:  ``course.toml`` in the course folder; a ``timestamp.txt`` beside what was handed in, as nbgrader writes it.
Out: the due date that the gradebook gets, and nbgrader's late penalty. Without a due date nothing is late.

>>> rule = Late({"due": {"ps1": datetime(2026, 3, 1, 12, tzinfo=UTC)}, "late": {"percent_a_day": 10}})
>>> rule.penalty("ps1", "ada", 15.0, datetime(2026, 3, 2, 13, tzinfo=UTC))  # a day and an hour: two days begun
3.0
"""

from __future__ import annotations

import math
import tomllib
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from nbgrader.plugins import LateSubmissionPlugin

from ..arguments import short
from ..formats.files import bounded_read, naming
from .course import SETTINGS

RULES = {"grace_minutes": 0.0, "percent_a_day": 0.0, "days": math.inf}
NBGRADER_TIME = "%Y-%m-%d %H:%M:%S.%f UTC"


class Late:
    """A course's due dates and its late rule, by its settings; raises ValueError for what they cannot hold."""

    def __init__(self, settings: dict[str, Any]) -> None:
        if unknown := sorted({*settings} - {"due", "later", "late"}):
            raise ValueError(f"has the tables due, later and late, got {', '.join(unknown)}")
        self.due = {name: _moment(value, name) for name, value in settings.get("due", {}).items()}
        self.later = {
            (name, student): _moment(value, f"{student}, {name}")
            for name, students in settings.get("later", {}).items()
            for student, value in students.items()
        }
        rules = settings.get("late", {})
        if wrong := {name: v for name, v in rules.items() if name not in RULES or type(v) not in (int, float) or v < 0}:
            raise ValueError(f"[late] has {', '.join(RULES)}, numbers >= 0, got {short(wrong)}")
        self.grace, self.percent, self.days = ({**RULES, **rules}[name] for name in RULES)

    @classmethod
    def of(cls, course: Path) -> Late:
        """Return the rule of a course folder; no due dates where it has no settings."""
        path = course / SETTINGS
        if not path.is_file():
            return cls({})
        with naming(SETTINGS):
            return cls(tomllib.loads(bounded_read(path).decode("utf-8-sig")))

    def due_for(self, name: str, student: str) -> datetime | None:
        """Return when a set is due for a student, or None."""
        due = self.due.get(name)
        return due and max(due, self.later.get((name, student), due))

    def by(self, name: str, student: str, when: datetime) -> timedelta:
        """Return by how much it is late: nothing within the minutes of grace."""
        due = self.due_for(name, student)
        over = when - due if due else timedelta()
        return over if over > timedelta(minutes=self.grace) else timedelta()

    def penalty(self, name: str, student: str, score: float, when: datetime) -> float:
        """Return the points that coming late costs."""
        days = math.ceil(self.by(name, student, when) / timedelta(days=1))
        return score if days > self.days else score * min(1.0, days * self.percent / 100)


def _moment(value: Any, whose: str) -> datetime:
    if not isinstance(value, datetime):
        got = value.isoformat() if hasattr(value, "isoformat") else short(value)
        raise ValueError(f"{whose} must be due at a day and a time such as 2026-03-01T23:59:00+01:00, got {got}")
    return value.astimezone(UTC)  # without a zone, by this computer's clock


class LateRule(LateSubmissionPlugin):  # type: ignore[misc]  # nbgrader has no types
    """The course's rule, in the place of nbgrader's own: it grades, ``course.toml`` says how."""

    def late_submission_penalty(self, student_id: str, score: float, total_seconds_late: float) -> float | None:
        """Return the points that coming late costs."""
        name, course = self.parent.assignment_id, Path(self.parent.config.CourseDirectory.root)
        rule = Late.of(course)
        if name not in rule.due:
            return None
        return rule.penalty(name, student_id, score, rule.due[name] + timedelta(seconds=total_seconds_late)) or None
