"""Threads: each takes its part of the columns.

Kernels release Python's lock while they run (kernel.flow_kernel), so that plain threads work side by side. A kernel
writes only to its own columns: the answer does not depend on who does what. How long a job will take is what its kernel
took for a cell the last time: short ones are done by one.

A thread that sleeps takes 50 to 80 µs to wake (on a virtual machine), a step has some 250 jobs: who waits looks for
half a millisecond before it sleeps, and offers its processor to others each time. Who asks for Python's lock while
another one has it sleeps as well, so nobody asks too early: a worker that sees a job leaves its caller the time to be
in the kernel, where the lock is free, and an answer is told when the lock has been given back. A job of 50 µs takes two
threads 20 to 25 µs so, and would take 65.
"""

from __future__ import annotations

import os
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from queue import SimpleQueue
from threading import Thread
from time import perf_counter

import numpy as np
from numba import types

from flowgmo.kernel import free_kernel

WORTHWHILE = 4e-5  # s for each thread: to share a job costs some 2e-5
PIECES = 4  # for each thread, of work that lies unevenly, at most,
PIECE = 6e-5  # s each, of which .5 to 1e-5 go into the call
COLUMN = 20  # cells that a column costs beside its own; the slower of two threads took 1.35 of its half, now 1.14
LOOKS = 1000 if os.name == "posix" else 0  # before a thread sleeps, .3 to .5 µs each; with 200 a step took 4 % longer
PATIENCE = 40  # looks that a worker leaves its caller, each worker as many more; 10 to 40 do, 5 are too few
REMEMBERED = 64  # tables of columns whose parts are kept: a step has some ten, and every level of multigrid one


_offer_processor = types.ExternalFunction("sched_yield", types.int32())


@free_kernel
def _look_for(count, seen, looks, patience):
    """Wait until count[0] is another than `seen`, at most so many looks, and then for `patience` looks more."""
    for _ in range(looks):
        if count[0] != seen:
            break
        _offer_processor()
    for _ in range(patience):
        _offer_processor()


@free_kernel
def _tell_and_look_for(told, count, seen, looks, patience):
    """Add 1 to told[0], then as `_look_for`: who sees it finds Python's lock free."""
    told[0] += 1
    _look_for(count, seen, looks, patience)


@free_kernel
def _add_up(columns, ends):
    """ends[c]: cells in columns 0 to c, and COLUMN for each."""
    total = 0
    for c in range(len(columns)):
        total += columns[c, 3] - columns[c, 2] + COLUMN
        ends[c] = total


class _Worker:
    """What passes between a worker and its team: jobs, answers, and how many of either have been given."""

    def __init__(self, number: int) -> None:
        self._jobs, self._posted = SimpleQueue(), np.zeros(1, np.int64)
        self._answers, self._answered = SimpleQueue(), np.zeros(1, np.int64)
        self._taken, self._heard, self._patience = 0, 0, number * PATIENCE

    def post(self, job: object) -> None:
        """The team gives a job; None sends the worker home."""
        self._jobs.put(job)
        self._posted[0] += 1

    def hear(self) -> Exception | None:
        """The team waits for the answer to the last job."""
        if LOOKS:
            _look_for(self._answered, self._heard, LOOKS, 0)
        self._heard += 1
        return self._answers.get()

    def jobs(self) -> Iterator[object]:
        """The worker's jobs, until it is sent home. It answers each before it asks for the next."""
        while True:
            if LOOKS and self._taken:
                _tell_and_look_for(self._answered, self._posted, self._taken, LOOKS, self._patience)
            self._taken += 1
            job = self._jobs.get()
            if job is None:
                return
            yield job
            del job  # arrays of a scene that has ended must not live on here

    def answer(self, error: Exception | None) -> None:
        self._answers.put(error)


class Team:
    """`threads` workers, the caller being one of them."""

    def __init__(self, threads: int) -> None:
        self.threads = max(int(threads), 1)
        self._workers = [_Worker(number) for number in range(1, self.threads)]
        self._parts: dict[int, tuple[np.ndarray, np.ndarray, dict[int, list]]] = {}
        self._seconds: dict[Callable, float] = {}  # that a kernel takes for a cell
        for worker in self._workers:
            Thread(target=_work, args=(worker,), name="flow", daemon=True).start()
        weakref.finalize(self, _send_home, self._workers)

    def run(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """kernel(columns, first, last, *arguments) on all columns, in parts that take about equally long.

        columns must not be changed later: how they are shared is kept.
        """
        self._run_columns(kernel, columns, 1, arguments)

    def run_uneven(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """The same for work at the surface or at solids: each thread takes a piece when it has done its last one."""
        self._run_columns(kernel, columns, PIECES, arguments)

    def _run_columns(self, kernel: Callable, columns: np.ndarray, most: int, arguments: tuple) -> None:
        """Up to so many pieces for each thread."""
        if self.threads == 1 or len(columns) < 2:
            kernel(columns, 0, len(columns), *arguments)
            return
        cells = int(self._ends(columns)[-1])
        known = self._seconds.get(kernel)
        threads, pieces = self.threads, most
        if known is not None:
            while threads > 1 and known * cells < threads * WORTHWHILE:
                threads -= 1
            pieces = max(min(most, int(known * cells / (threads * PIECE))), 1)
        parts = self.parts(columns, threads * pieces if threads > 1 else 1)
        began = perf_counter()
        self._run(kernel, columns, [deque(parts)] * threads if pieces > 1 else [[part] for part in parts], arguments)
        took = (perf_counter() - began) * threads / cells
        self._seconds[kernel] = took if known is None else min(took, 0.5 * (took + known))  # others hold it up at times

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
        busy = self._workers[: len(shares) - 1]
        for worker, share in zip(busy, shares[1:], strict=True):
            worker.post((kernel, columns, share, arguments))
        try:
            for first, last in _ranges(shares[0]):
                kernel(columns, first, last, *arguments)
        finally:
            errors = [worker.hear() for worker in busy]
        for error in errors:
            if error is not None:
                raise error

    def parts(self, columns: np.ndarray, count: int) -> list[tuple[int, int]]:
        """At most so many ranges of columns, of about as many cells."""
        if count == 1:
            return [(0, len(columns))]
        ends = self._ends(columns)
        kept = self._parts[id(columns)][2]
        if count not in kept:
            cuts = np.searchsorted(ends, ends[-1] * np.arange(1, count) / count).tolist()
            cuts = [0, *cuts, len(columns)]
            kept[count] = [(a, b) for a, b in zip(cuts[:-1], cuts[1:], strict=True) if a < b]
        return kept[count]

    def _ends(self, columns: np.ndarray) -> np.ndarray:
        """Cells of all columns up to each, with what a column costs."""
        kept = self._parts.get(id(columns))  # the table is kept with its parts: no other one has this id meanwhile
        if kept is None:
            if len(self._parts) >= REMEMBERED:
                self._parts.clear()
            ends = np.empty(len(columns), np.int64)
            _add_up(columns, ends)
            kept = self._parts[id(columns)] = (columns, ends, {})
        return kept[1]


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


def _work(worker: _Worker) -> None:
    """Do its jobs; the error of each, or None, is the answer."""
    for kernel, columns, share, arguments in worker.jobs():
        error = None
        try:
            for first, last in _ranges(share):
                kernel(columns, first, last, *arguments)
        except Exception as raised:  # it is raised again by the caller
            error = raised
        del kernel, columns, share, arguments  # arrays of a scene that has ended must not live on here
        worker.answer(error)


def _send_home(workers: list[_Worker]) -> None:
    for worker in workers:
        worker.post(None)
