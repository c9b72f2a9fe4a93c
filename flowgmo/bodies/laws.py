"""Functions of time from the deck, packed for kernels: tables (linear between entries, constant outside) and sinusoids.

A law is a row (kind, first, last, amplitude, frequency, phase); tables point into the shared columns t, y.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from flowgmo.bodies.body import Sinusoid, Table

TABLE, SINUSOID = 0, 1


class Laws(NamedTuple):
    """kind (k,); first, last (k,) entries of a table; wave (k, 3) amplitude, frequency, phase; t, y (entries,)."""

    kind: np.ndarray
    first: np.ndarray
    last: np.ndarray
    wave: np.ndarray
    t: np.ndarray
    y: np.ndarray


class LawBook:
    """Collects laws while a model is packed; `add` returns a law's number, -1 for one that is zero."""

    def __init__(self) -> None:
        self._rows: list[tuple[int, int, int, float, float, float]] = []
        self._t: list[float] = []
        self._y: list[float] = []

    def add(self, law: Table | Sinusoid) -> int:
        if isinstance(law, Sinusoid):
            if law.amplitude == 0.0:
                return -1
            self._rows.append((SINUSOID, 0, 0, law.amplitude, law.frequency, law.phase))
        else:
            if law.is_zero:
                return -1
            first = len(self._t)
            self._t.extend(law.t)
            self._y.extend(law.y)
            self._rows.append((TABLE, first, len(self._t) - 1, 0.0, 0.0, 0.0))
        return len(self._rows) - 1

    def pack(self) -> Laws:
        rows = np.array(self._rows, dtype=float).reshape(-1, 6)
        return Laws(
            kind=rows[:, 0].astype(np.int64),
            first=rows[:, 1].astype(np.int64),
            last=rows[:, 2].astype(np.int64),
            wave=np.ascontiguousarray(rows[:, 3:]),
            t=np.array(self._t, dtype=float),
            y=np.array(self._y, dtype=float),
        )


@njit(cache=True)
def _entry(laws, k, t):
    """Index i of the table entry with t[i] <= t < t[i + 1]; first - 1 before the table, last behind it."""
    lo, hi = laws.first[k] - 1, laws.last[k]
    while lo < hi:
        mid = (lo + hi + 1) // 2
        if laws.t[mid] <= t:
            lo = mid
        else:
            hi = mid - 1
    return lo


@njit(cache=True)
def value(laws, k, t):
    """y(t) of law k; 0 for k = -1."""
    if k < 0:
        return 0.0
    if laws.kind[k] == SINUSOID:
        return laws.wave[k, 0] * np.sin(2.0 * np.pi * laws.wave[k, 1] * t + laws.wave[k, 2])
    i = _entry(laws, k, t)
    if i < laws.first[k]:
        return laws.y[laws.first[k]]
    if i == laws.last[k]:
        return laws.y[i]
    return laws.y[i] + (laws.y[i + 1] - laws.y[i]) * ((t - laws.t[i]) / (laws.t[i + 1] - laws.t[i]))


@njit(cache=True)
def rate(laws, k, t, after):
    """dy/dt just after t, or just before it (the motion that led here); 0 for k = -1."""
    if k < 0:
        return 0.0
    if laws.kind[k] == SINUSOID:
        turn = 2.0 * np.pi * laws.wave[k, 1]
        return laws.wave[k, 0] * turn * np.cos(turn * t + laws.wave[k, 2])
    i = _entry(laws, k, t)
    if not after and i >= laws.first[k] and laws.t[i] == t:
        i -= 1
    if i < laws.first[k] or i == laws.last[k]:
        return 0.0
    return (laws.y[i + 1] - laws.y[i]) / (laws.t[i + 1] - laws.t[i])


@njit(cache=True)
def integral(laws, k, t0, t1):
    """∫ y dt from t0 to t1, exact; a sinusoid by a product form that does not cancel for short intervals."""
    if k < 0 or t1 == t0:
        return 0.0
    if laws.kind[k] == SINUSOID:
        turn = 2.0 * np.pi * laws.wave[k, 1]
        if turn == 0.0:
            return laws.wave[k, 0] * np.sin(laws.wave[k, 2]) * (t1 - t0)
        return (
            laws.wave[k, 0]
            * 2.0
            / turn
            * np.sin(turn * 0.5 * (t0 + t1) + laws.wave[k, 2])
            * np.sin(turn * 0.5 * (t1 - t0))
        )
    total = 0.0
    t = t0
    while t < t1:
        stop = min(t1, next_kink(laws, k, t))
        total += 0.5 * (stop - t) * (value(laws, k, t) + value(laws, k, stop))
        t = stop
    return total


@njit(cache=True)
def next_kink(laws, k, t):
    """The first time after t at which law k is not smooth; infinity if there is none."""
    if k < 0 or laws.kind[k] == SINUSOID:
        return np.inf
    i = _entry(laws, k, t)
    return laws.t[i + 1] if i < laws.last[k] else np.inf


@njit(cache=True)
def next_turn(laws, k, t):
    """The first time after t at which law k may change sign or kink: between two of them ∫ y is monotone."""
    if k < 0:
        return np.inf
    if laws.kind[k] == SINUSOID:
        frequency = laws.wave[k, 1]
        if frequency == 0.0:
            return np.inf
        halves = 2.0 * frequency * t + laws.wave[k, 2] / np.pi
        step = 1.0 if frequency > 0.0 else -1.0
        n = np.floor(halves) + 1.0 if frequency > 0.0 else np.ceil(halves) - 1.0
        at = (n - laws.wave[k, 2] / np.pi) / (2.0 * frequency)
        return at if at > t else at + step / (2.0 * frequency)
    kink = next_kink(laws, k, t)
    y0 = value(laws, k, t)
    y1 = value(laws, k, kink) if kink < np.inf else y0
    if y0 * y1 < 0.0:
        zero = t + (kink - t) * (y0 / (y0 - y1))
        if zero > t:
            return zero
    return kink
