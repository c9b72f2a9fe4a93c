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
COLUMN = 20  # cells that a column costs beside its own; the slower of two threads took 1.35 of its half, now 1.14
PIECES = 4  # for each thread, of work that lies unevenly
REMEMBERED = 64  # tables of columns whose parts are kept: a step has some ten, and every level of multigrid one


class Team:
    """`threads` workers, the caller being one of them."""

    def __init__(self, threads: int) -> None:
        self.threads = max(int(threads), 1)
        self._jobs = [SimpleQueue() for _ in range(self.threads - 1)]
        self._done = SimpleQueue()
        self._parts: dict[tuple[int, int], tuple[np.ndarray, list]] = {}
        for jobs in self._jobs:
            Thread(target=_work, args=(jobs, self._done), name="flow", daemon=True).start()
        weakref.finalize(self, _send_home, self._jobs)

    def run(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """kernel(columns, first, last, *arguments) on all columns, in parts that take about equally long.

        columns must not be changed later: how they are shared is kept.
        """
        self._run(kernel, columns, [[part] for part in self.parts(columns)], arguments)

    def run_uneven(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """The same for work at the surface or at solids: each thread takes pieces from all over the columns."""
        pieces = self.parts(columns, PIECES)
        threads = -(-len(pieces) // PIECES)
        self._run(kernel, columns, [pieces[n::threads] for n in range(threads)], arguments)

    def run_rows(self, work: Callable, rows: np.ndarray, least: int, *arguments: object) -> None:
        """work(rows, first, last, *arguments) on all rows in equal parts, as many as have `least` of them each."""
        n = len(rows)
        count = int(max(min(self.threads, n // least), 1))
        ends = [p * n // count for p in range(count + 1)]
        self._run(work, rows, [[part] for part in zip(ends[:-1], ends[1:], strict=True)], arguments)

    def _run(self, kernel: Callable, columns: np.ndarray, shares: list, arguments: tuple) -> None:
        """One share, a list of ranges, for each thread; the first is the caller's."""
        for jobs, share in zip(self._jobs, shares[1:], strict=False):
            jobs.put((kernel, columns, share, arguments))
        try:
            for first, last in shares[0]:
                kernel(columns, first, last, *arguments)
        finally:
            errors = [self._done.get() for _ in shares[1:]]
        for error in errors:
            if error is not None:
                raise error

    def parts(self, columns: np.ndarray, pieces: int = 1) -> list[tuple[int, int]]:
        """Ranges of columns, so many pieces for each thread that is worth it."""
        n = len(columns)
        if self.threads == 1 or n < 2:
            return [(0, n)]
        key = id(columns), pieces  # the table is kept with its parts: no other one has this id meanwhile
        kept = self._parts.get(key)
        if kept is None:
            if len(self._parts) >= REMEMBERED:
                self._parts.clear()
            kept = self._parts[key] = (columns, self._share(columns, pieces))
        return kept[1]

    def _share(self, columns: np.ndarray, pieces: int) -> list[tuple[int, int]]:
        cells = columns[:, 3] - columns[:, 2]
        ends = np.cumsum(cells + COLUMN)
        load = ends[-1] if pieces > 1 else cells.sum()  # where single faces of cut cells are rows, each is work
        threads = int(min(self.threads, max(load // WORTHWHILE, 1)))
        count = threads * pieces if threads > 1 else 1
        cuts = [0, *np.searchsorted(ends, ends[-1] * np.arange(1, count) / count).tolist(), len(columns)]
        return [(a, b) for a, b in zip(cuts[:-1], cuts[1:], strict=True) if a < b]


def _work(jobs: SimpleQueue, done: SimpleQueue) -> None:
    """Do jobs until None comes; the error of each, or None, goes to `done`."""
    while (job := jobs.get()) is not None:
        kernel, columns, share, arguments = job
        error = None
        try:
            for first, last in share:
                kernel(columns, first, last, *arguments)
        except Exception as raised:  # it is raised again by the caller
            error = raised
        del job, kernel, columns, share, arguments  # arrays of a scene that has ended must not live on here
        done.put(error)


def _send_home(queues: list[SimpleQueue]) -> None:
    for jobs in queues:
        jobs.put(None)
