"""What several tests share."""

import re


def exactly(sentence):
    """A pattern for ``pytest.raises`` that matches this sentence and nothing more."""
    return f"^{re.escape(sentence)}$"
