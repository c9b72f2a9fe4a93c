"""Signals that end a run: after the step in progress, and at once when they come again."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

INTERRUPTED = 130  # exit code (DESIGN 8)


class Stoppable(Protocol):
    """What is asked to stop."""

    stop_asked: bool


@contextmanager
def stopping_on_signals(job: Stoppable) -> Iterator[None]:
    """Ctrl-C, a polite kill and a closed terminal end the run after the step in progress; a second one at once."""

    def ask(number: int, frame: object) -> None:
        if job.stop_asked:
            os._exit(INTERRUPTED)
        job.stop_asked = True

    wanted = [signal.SIGINT, signal.SIGTERM]
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) == signal.SIG_DFL:  # nohup ignores it: so do we
        wanted.append(signal.SIGHUP)
    old = {s: signal.signal(s, ask) for s in wanted}
    try:
        yield
    finally:
        for s, handler in old.items():
            signal.signal(s, handler)
