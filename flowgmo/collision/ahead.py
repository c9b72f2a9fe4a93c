"""A second process that compiles contact forces and impacts while the first one compiles the search for contacts.

Only on a first start, and where a second core is there. Both write to the same cache of kernels; what the second one
has ready when the first one comes to it is loaded from there, what it has not is compiled as ever: nothing depends on
it. A file in the cache's folder says that it was done.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from pathlib import Path

_started: list[subprocess.Popen] = []


def compile_ahead() -> None:
    """Start the second process if this is a first start."""
    mark = _mark()
    if _started or mark is None or mark.exists() or _cores() < 2:
        return
    try:
        mark.touch(exist_ok=False)
        child = subprocess.Popen(
            [sys.executable, "-c", "from flowgmo.collision.ahead import compile_all; compile_all()"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
    except OSError:  # no place, no process, or another run was faster: this one compiles all by itself
        return
    _started.append(child)
    atexit.register(_stop, child, mark)


def _stop(child: subprocess.Popen, mark: Path) -> None:
    """At the end of a run that was shorter than the compilation: the next one starts it again."""
    if child.poll() is None:
        child.terminate()
        child.wait()
        mark.unlink(missing_ok=True)


def _mark() -> Path | None:
    folder = os.environ.get("NUMBA_CACHE_DIR")
    return Path(folder) / "contacts-compiled-ahead" if folder else None


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def compile_all() -> None:
    """Call the kernels that every scene with contacts comes to, with a body that nothing touches."""
    import numpy as np

    from flowgmo.collision.clusters import resolve
    from flowgmo.collision.contact import CONTACT, RESPONSE, TWIST
    from flowgmo.collision.persistent import solve
    from flowgmo.collision.single import strike_exactly

    responses, twists = np.zeros(7, RESPONSE), np.zeros(7, TWIST)
    contacts = np.zeros(1, CONTACT)
    contacts["normal"], contacts["b"] = (0.0, 0.0, 1.0), 1
    nothing = contacts[:0].copy()
    solve(nothing, np.zeros((0, 3)), responses, twists, 1e-9, 1)
    resolve(nothing, responses, twists, 1.5, 0.03)
    strike_exactly(contacts, responses, twists)
