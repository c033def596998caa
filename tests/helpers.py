"""What several tests share."""

import re

WAITS = "waits"  # by this name a test tells who was waited for, and how long from each key press to the picture [ms]


def exactly(sentence):
    """A pattern for ``pytest.raises`` that matches this sentence and nothing more."""
    return f"^{re.escape(sentence)}$"
