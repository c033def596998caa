"""Machine: what the times were measured on, and which of the others' tools are there.

In:  nothing.
Out: lines of text, without paths and names; ``version_of`` a peer, None when it is absent.

>>> version_of("no such package") is None
True
"""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version

LIBRARIES = ("numpy", "scipy", "scikit-learn", "shapely", "joblib")
PEERS = ("ir-sim", "numba", "scikit-image", "pyransac3d", "circle-fit")
HOW_TO = 'pip install -e ".[peers]"'


def version_of(package: str) -> str | None:
    """Return the version of an installed package, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def described(primkit: str) -> str:
    """Return the machine, the libraries and the peers in three lines; ``primkit`` is its version."""
    found = {peer: version_of(peer) for peer in PEERS}
    there = ", ".join(f"{peer} {number}" for peer, number in found.items() if number) or "none"
    missing = ", ".join(peer for peer, number in found.items() if not number)
    load = f", load {os.getloadavg()[0]:.1f} at the start" if hasattr(os, "getloadavg") else ""
    return "\n".join(
        [
            f"Machine    {platform.system()} on {platform.machine()}, {usable_cores()} cores{load}; "
            f"{platform.python_implementation()} {platform.python_version()}",
            f"Libraries  primkit {primkit}, " + ", ".join(f"{name} {version(name)}" for name in LIBRARIES),
            f"Peers      {there}" + (f"; absent: {missing} ({HOW_TO})" if missing else ""),
        ]
    )


def usable_cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
