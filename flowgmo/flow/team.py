"""Threads: each takes its part of the columns.

Kernels release Python's lock while they run (kernel.flow_kernel), so that plain threads work side by side. A kernel
writes only to its own columns: the answer does not depend on how many there are. Small jobs are done by one.

A thread that sleeps takes 50 to 80 µs to wake (on a virtual machine), a step has some 250 jobs: who waits looks for a
tenth of a millisecond before it sleeps, and offers its processor to others each time.
"""

from __future__ import annotations

import os
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from queue import SimpleQueue
from threading import Thread

import numpy as np
from numba import types

from flowgmo.kernel import free_kernel

WORTHWHILE = 4000  # cells for each thread: waking one costs about as much as a stencil on this many (15 µs)
COLUMN = 20  # cells that a column costs beside its own; the slower of two threads took 1.35 of its half, now 1.14
PIECES = 4  # for each thread, of work that lies unevenly
LOOKS = 200 if os.name == "posix" else 0  # before a thread sleeps, .3 to .5 µs each
REMEMBERED = 64  # tables of columns whose parts are kept: a step has some ten, and every level of multigrid one


_offer_processor = types.ExternalFunction("sched_yield", types.int32())


@free_kernel
def _look_for(count, seen, looks):
    """Wait until count[0] is another than `seen`, at most so many looks."""
    for _ in range(looks):
        if count[0] != seen:
            return
        _offer_processor()


class _Mailbox:
    """Jobs one way or answers the other, and how many have been posted."""

    def __init__(self) -> None:
        self._queue, self._posted, self._taken = SimpleQueue(), np.zeros(1, np.int64), 0

    def post(self, what: object) -> None:
        self._queue.put(what)
        self._posted[0] += 1

    def take(self) -> object:
        if LOOKS:
            _look_for(self._posted, self._taken, LOOKS)
        self._taken += 1
        return self._queue.get()


class Team:
    """`threads` workers, the caller being one of them."""

    def __init__(self, threads: int) -> None:
        self.threads = max(int(threads), 1)
        self._jobs = [_Mailbox() for _ in range(self.threads - 1)]
        self._done = [_Mailbox() for _ in self._jobs]
        self._parts: dict[tuple[int, int], tuple[np.ndarray, list]] = {}
        for jobs, done in zip(self._jobs, self._done, strict=True):
            Thread(target=_work, args=(jobs, done), name="flow", daemon=True).start()
        weakref.finalize(self, _send_home, self._jobs)

    def run(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """kernel(columns, first, last, *arguments) on all columns, in parts that take about equally long.

        columns must not be changed later: how they are shared is kept.
        """
        self._run(kernel, columns, [[part] for part in self.parts(columns)], arguments)

    def run_uneven(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """The same for work at the surface or at solids: each thread takes a piece when it has done its last one."""
        pieces = self.parts(columns, PIECES)
        threads = -(-len(pieces) // PIECES)
        left = deque(pieces)
        self._run(kernel, columns, [left] * threads, arguments)

    def run_rows(self, work: Callable, rows: np.ndarray, least: int, *arguments: object) -> None:
        """work(rows, first, last, *arguments) on all rows in equal parts, as many as have `least` of them each."""
        n = len(rows)
        count = int(max(min(self.threads, n // least), 1))
        ends = [p * n // count for p in range(count + 1)]
        self._run(work, rows, [[part] for part in zip(ends[:-1], ends[1:], strict=True)], arguments)

    def run_all(self, works: Sequence[Callable[[], None]]) -> None:
        """Each of the works once; a thread takes the next when it has done its last one."""
        left = deque((n, n + 1) for n in range(len(works)))
        self._run(_do, works, [left] * min(self.threads, len(works)), ())

    def _run(self, kernel: Callable, columns: np.ndarray, shares: list, arguments: tuple) -> None:
        """One share, ranges in a list or left in a deque, for each thread; the first is the caller's."""
        for jobs, share in zip(self._jobs, shares[1:], strict=False):
            jobs.post((kernel, columns, share, arguments))
        try:
            for first, last in _ranges(shares[0]):
                kernel(columns, first, last, *arguments)
        finally:
            errors = [done.take() for done, _ in zip(self._done, shares[1:], strict=False)]
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


def _do(works: Sequence[Callable[[], None]], first: int, last: int) -> None:
    """Some of the works."""
    for work in works[first:last]:
        work()


def _ranges(share: list | deque) -> Iterator[tuple[int, int]]:
    """Those of a list; those that are left in a deque that several threads share."""
    if isinstance(share, list):
        yield from share
        return
    while True:
        try:
            piece = share.popleft()
        except IndexError:
            return
        yield piece


def _work(jobs: _Mailbox, done: _Mailbox) -> None:
    """Do jobs until None comes; the error of each, or None, goes to `done`."""
    while (job := jobs.take()) is not None:
        kernel, columns, share, arguments = job
        error = None
        try:
            for first, last in _ranges(share):
                kernel(columns, first, last, *arguments)
        except Exception as raised:  # it is raised again by the caller
            error = raised
        del job, kernel, columns, share, arguments  # arrays of a scene that has ended must not live on here
        done.post(error)


def _send_home(boxes: list[_Mailbox]) -> None:
    for jobs in boxes:
        jobs.post(None)
