"""Functions of time from the deck, packed for kernels: tables (linear between entries, constant outside) and sinusoids.

A law is a row (LAW); tables point into shared entries.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.bodies.body import PointLoad, Sinusoid, Table
from flowgmo.kernel import inner

TABLE, SINUSOID = 0, 1


class Laws(NamedTuple):
    """rows (k,) of LAW; entries (e, 2) of all tables: time, value; loads (j,) of LOAD.

    ballistic, hinged, forced, stops: None unless the scene has free bodies, bodies on a fixed axis, bodies whose
    equations of motion are integrated, stops; a function that gets None for one compiles no code for it.
    """

    rows: np.ndarray
    entries: np.ndarray
    loads: np.ndarray
    ballistic: np.ndarray | None
    hinged: np.ndarray | None
    forced: np.ndarray | None
    stops: np.ndarray | None


#: A law: kind, first and last entry of a table, or a wave's amplitude, frequency, phase.
LAW = np.dtype([("kind", "i8"), ("first", "i8"), ("last", "i8"), ("wave", "f8", 3)], align=True)
#: A control force at a point: its three laws, the point from B in body axes, whether the force is in body axes.
LOAD = np.dtype([("law", "i8", 3), ("arm", "f8", 3), ("in_body", "i8")], align=True)


class LawBook:
    """Collects laws while a model is packed; `add` returns a law's number, -1 for one that is zero."""

    def __init__(self) -> None:
        self._rows: list[tuple] = []
        self._entries: list[tuple[float, float]] = []
        self._loads: list[tuple] = []

    @property
    def loads(self) -> int:
        """Point loads so far."""
        return len(self._loads)

    def add(self, law: Table | Sinusoid) -> int:
        if isinstance(law, Sinusoid):
            if law.amplitude == 0.0:
                return -1
            self._rows.append((SINUSOID, 0, 0, (law.amplitude, law.frequency, law.phase)))
        else:
            if law.is_zero:
                return -1
            first = len(self._entries)
            self._entries.extend(zip(law.t.tolist(), law.y.tolist(), strict=True))
            self._rows.append((TABLE, first, len(self._entries) - 1, (0.0, 0.0, 0.0)))
        return len(self._rows) - 1

    def add_load(self, load: PointLoad, origin: np.ndarray) -> None:
        self._loads.append(([self.add(f) for f in load.force], load.point - origin, load.in_body_axes))

    def pack(self, **present: bool) -> Laws:
        """present: for each of the optional parts of Laws whether the scene has it (default: it has)."""
        some = np.zeros(0)
        parts = ("ballistic", "hinged", "forced", "stops")
        return Laws(
            **{name: some if present.get(name, True) else None for name in parts},
            rows=np.array(self._rows, LAW),
            entries=np.array(self._entries, dtype=float).reshape(-1, 2),
            loads=np.array(self._loads, LOAD),
        )


@inner
def _entry(laws, k, t):
    """Index i of the table entry with t[i] <= t < t[i + 1]; first - 1 before the table, last behind it."""
    lo, hi = laws.rows[k].first - 1, laws.rows[k].last
    while lo < hi:
        mid = (lo + hi + 1) // 2
        if laws.entries[mid, 0] <= t:
            lo = mid
        else:
            hi = mid - 1
    return lo


@inner
def value(laws, k, t):
    """y(t) of law k; 0 for k = -1."""
    if k < 0:
        return 0.0
    if laws.rows[k].kind == SINUSOID:
        return laws.rows[k].wave[0] * np.sin(2.0 * np.pi * laws.rows[k].wave[1] * t + laws.rows[k].wave[2])
    i = _entry(laws, k, t)
    if i < laws.rows[k].first:
        return laws.entries[laws.rows[k].first, 1]
    if i == laws.rows[k].last:
        return laws.entries[i, 1]
    return laws.entries[i, 1] + (laws.entries[i + 1, 1] - laws.entries[i, 1]) * (
        (t - laws.entries[i, 0]) / (laws.entries[i + 1, 0] - laws.entries[i, 0])
    )


@inner
def rate(laws, k, t, after):
    """dy/dt just after t, or just before it (the motion that led here); 0 for k = -1."""
    if k < 0:
        return 0.0
    if laws.rows[k].kind == SINUSOID:
        turn = 2.0 * np.pi * laws.rows[k].wave[1]
        return laws.rows[k].wave[0] * turn * np.cos(turn * t + laws.rows[k].wave[2])
    i = _entry(laws, k, t)
    if not after and i >= laws.rows[k].first and laws.entries[i, 0] == t:
        i -= 1
    if i < laws.rows[k].first or i == laws.rows[k].last:
        return 0.0
    return (laws.entries[i + 1, 1] - laws.entries[i, 1]) / (laws.entries[i + 1, 0] - laws.entries[i, 0])


@inner
def integral(laws, k, t0, t1):
    """∫ y dt from t0 to t1, exact; a sinusoid by a product form that does not cancel for short intervals."""
    if k < 0 or t1 == t0:
        return 0.0
    if laws.rows[k].kind == SINUSOID:
        turn = 2.0 * np.pi * laws.rows[k].wave[1]
        if turn == 0.0:
            return laws.rows[k].wave[0] * np.sin(laws.rows[k].wave[2]) * (t1 - t0)
        return (
            laws.rows[k].wave[0]
            * 2.0
            / turn
            * np.sin(turn * 0.5 * (t0 + t1) + laws.rows[k].wave[2])
            * np.sin(turn * 0.5 * (t1 - t0))
        )
    total = 0.0
    t = t0
    while t < t1:
        stop = min(t1, next_kink(laws, k, t))
        total += 0.5 * (stop - t) * (value(laws, k, t) + value(laws, k, stop))
        t = stop
    return total


@inner
def next_kink(laws, k, t):
    """The first time after t at which law k is not smooth; infinity if there is none."""
    if k < 0 or laws.rows[k].kind == SINUSOID:
        return np.inf
    i = _entry(laws, k, t)
    return laws.entries[i + 1, 0] if i < laws.rows[k].last else np.inf


@inner
def next_turn(laws, k, t):
    """The first time after t at which law k may change sign or kink: between two of them ∫ y is monotone."""
    if k < 0:
        return np.inf
    if laws.rows[k].kind == SINUSOID:
        frequency = laws.rows[k].wave[1]
        if frequency == 0.0:
            return np.inf
        halves = 2.0 * frequency * t + laws.rows[k].wave[2] / np.pi
        step = 1.0 if frequency > 0.0 else -1.0
        n = np.floor(halves) + 1.0 if frequency > 0.0 else np.ceil(halves) - 1.0
        at = (n - laws.rows[k].wave[2] / np.pi) / (2.0 * frequency)
        return at if at > t else at + step / (2.0 * frequency)
    kink = next_kink(laws, k, t)
    y0 = value(laws, k, t)
    y1 = value(laws, k, kink) if kink < np.inf else y0
    if y0 * y1 < 0.0:
        zero = t + (kink - t) * (y0 / (y0 - y1))
        if zero > t:
            return zero
    return kink
