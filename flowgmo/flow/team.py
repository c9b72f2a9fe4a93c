"""Threads: each takes its part of the columns.

Kernels release Python's lock while they run (kernel.flow_kernel), so that plain threads work side by side. A kernel
writes only to its own columns: the answer does not depend on how many there are. Small jobs are done by one.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait

import numpy as np

WORTHWHILE = 4000  # cells for each thread: waking one costs about as much as a stencil on this many (30 µs)


class Team:
    """`threads` workers, the caller being one of them."""

    def __init__(self, threads: int) -> None:
        self.threads = max(int(threads), 1)
        self._pool = ThreadPoolExecutor(self.threads - 1, "flow") if self.threads > 1 else None

    def run(self, kernel: Callable, columns: np.ndarray, *arguments: object) -> None:
        """kernel(columns, first, last, *arguments) on all columns, in parts of about equal numbers of cells."""
        n = len(columns)
        parts = self.parts(columns)
        if len(parts) == 1 or self._pool is None:
            kernel(columns, 0, n, *arguments)
            return
        others = [self._pool.submit(kernel, columns, a, b, *arguments) for a, b in parts[1:]]
        kernel(columns, *parts[0], *arguments)
        wait(others)
        for other in others:
            other.result()

    def parts(self, columns: np.ndarray) -> list[tuple[int, int]]:
        """Ranges of columns, one for each thread that is worth it."""
        n = len(columns)
        if self.threads == 1 or n < 2:
            return [(0, n)]
        ends = np.cumsum(columns[:, 3] - columns[:, 2])
        count = int(min(self.threads, max(ends[-1] // WORTHWHILE, 1)))
        cuts = [0, *np.searchsorted(ends, ends[-1] * np.arange(1, count) / count).tolist(), n]
        return [(a, b) for a, b in zip(cuts[:-1], cuts[1:], strict=True) if a < b]
