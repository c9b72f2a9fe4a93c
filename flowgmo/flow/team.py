"""Threads: each takes its part of the columns.

Kernels release Python's lock while they run (kernel.flow_kernel), so that plain threads work side by side. A kernel
writes only to its own columns: the answer does not depend on how many there are. Small jobs are done by one.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from queue import SimpleQueue
from threading import Thread

import numpy as np

WORTHWHILE = 4000  # cells for each thread: waking one costs about as much as a stencil on this many (15 µs)
REMEMBERED = 64  # tables of columns whose parts are kept: a step has some ten, and every level of multigrid one


class Team:
    """`threads` workers, the caller being one of them."""

    def __init__(self, threads: int) -> None:
        self.threads = max(int(threads), 1)
        self._jobs = [SimpleQueue() for _ in range(self.threads - 1)]
        self._done = SimpleQueue()
        self._parts: dict[int, tuple[np.ndarray, list]] = {}
        for jobs in self._jobs:
            Thread(target=_work, args=(jobs, self._done), name="flow", daemon=True).start()
        weakref.finalize(self, _send_home, self._jobs)

    def run(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """kernel(columns, first, last, *arguments) on all columns, in parts of about equal numbers of cells.

        columns must not be changed later: how they are shared is kept.
        """
        parts = self.parts(columns)
        others = len(parts) - 1
        for jobs, (first, last) in zip(self._jobs, parts[1:], strict=False):
            jobs.put((kernel, columns, first, last, arguments))
        try:
            kernel(columns, *parts[0], *arguments)
        finally:
            errors = [self._done.get() for _ in range(others)]
        for error in errors:
            if error is not None:
                raise error

    def parts(self, columns: np.ndarray) -> list[tuple[int, int]]:
        """Ranges of columns, one for each thread that is worth it."""
        n = len(columns)
        if self.threads == 1 or n < 2:
            return [(0, n)]
        kept = self._parts.get(id(columns))  # the table is kept with its parts: no other one has this id meanwhile
        if kept is None:
            if len(self._parts) >= REMEMBERED:
                self._parts.clear()
            kept = self._parts[id(columns)] = (columns, self._share(columns))
        return kept[1]

    def _share(self, columns: np.ndarray) -> list[tuple[int, int]]:
        ends = np.cumsum(columns[:, 3] - columns[:, 2])
        count = int(min(self.threads, max(ends[-1] // WORTHWHILE, 1)))
        cuts = [0, *np.searchsorted(ends, ends[-1] * np.arange(1, count) / count).tolist(), len(columns)]
        return [(a, b) for a, b in zip(cuts[:-1], cuts[1:], strict=True) if a < b]


def _work(jobs: SimpleQueue, done: SimpleQueue) -> None:
    """Do jobs until None comes; the error of each, or None, goes to `done`."""
    while (job := jobs.get()) is not None:
        kernel, columns, first, last, arguments = job
        error = None
        try:
            kernel(columns, first, last, *arguments)
        except Exception as raised:  # it is raised again by the caller
            error = raised
        del job, kernel, columns, arguments  # arrays of a scene that has ended must not live on here
        done.put(error)


def _send_home(queues: list[SimpleQueue]) -> None:
    for jobs in queues:
        jobs.put(None)
