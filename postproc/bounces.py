"""Rebounds of a body that falls again and again on the same thing: when and how high, from history.h5 alone.

Between two impacts the height follows from the rows as a cubic with their positions and velocities (exact in free
flight); its top is where the vertical velocity is zero. The height counts from the body's point at the impact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.impacts import hits
from postproc.results import Results

UPRIGHT = 0.9  # cosine; contacts steeper than this are not a floor


@dataclass(frozen=True)
class Rebound:
    """One bounce: times of the impact and of the top after it, height of the top above the impact; nan: not reached."""

    impact: float
    top: float
    height: float


def vertical_axis(results: Results) -> tuple[int, float]:
    """Axis of what is up (0, 1, 2) and its sign: against gravity, z without one."""
    gravity = np.asarray(results.file.attrs.get("gravity", [0.0, 0.0, -1.0]))
    if not gravity.any():
        return 2, 1.0
    axis = int(np.abs(gravity).argmax())
    return axis, 1.0 if gravity[axis] < 0 else -1.0


def bouncing_body(results: Results) -> str | None:
    """The body, when one body only moves and all its impacts are on one thing that is below it."""
    impacts = results.impacts
    if len(results.bodies) != 1 or not len(impacts.get("time", ())):
        return None
    name, number = next(iter(results.bodies.items()))
    axis, up = vertical_axis(results)
    partners = {tuple(pair) for pair in zip(impacts["a"].tolist(), impacts["b"].tolist(), strict=True)}
    sign = np.where(impacts["a"] == number, up, -up)
    upright = (sign * impacts["normal"][:, axis] > UPRIGHT).all()
    return name if upright and len(partners) == 1 else None


def rebounds(results: Results, name: str) -> list[Rebound]:
    """All bounces that the history resolves."""
    axis, up = vertical_axis(results)
    t = results.t
    z, v = (up * results.curve(f"bodies/{name}/{q}").y[:, axis] for q in ("position", "velocity"))
    all_hits = hits(results)  # a box that lands flat bounces once, not four times
    times = np.unique(all_hits.time[all_hits.count <= 1])
    ends = np.append(all_hits.time, t[-1])
    found = []
    for start in times:
        stop = ends[ends > start].min(initial=t[-1])
        rows = np.flatnonzero((t >= start) & (t <= stop))
        if len(rows) < 2:
            continue
        floor = _back_to(start, t[rows[0]], z[rows[0]], v[rows[0] : rows[0] + 2], t[rows[0] : rows[0] + 2])
        found.append(Rebound(float(start), *_top(t[rows], z[rows], v[rows], floor)))
    return found


def _back_to(start: float, t0: float, z0: float, v: np.ndarray, t: np.ndarray) -> float:
    """Height at the impact, from the first row after it, with the acceleration of the first two rows."""
    a, past = (v[1] - v[0]) / (t[1] - t[0]), t0 - start
    return z0 - v[0] * past + a * past**2 / 2


def _top(t: np.ndarray, z: np.ndarray, v: np.ndarray, floor: float) -> tuple[float, float]:
    """Time and height above the floor of the top; nan when the body has not stopped rising."""
    turns = np.flatnonzero((v[:-1] > 0) & (v[1:] <= 0))
    if len(turns) == 0:
        return np.nan, np.nan
    k = turns[0]
    s = v[k] / (v[k] - v[k + 1])  # of the interval; the velocity is linear in it
    dt = t[k + 1] - t[k]
    return t[k] + s * dt, z[k] + v[k] * s * dt / 2 - floor
