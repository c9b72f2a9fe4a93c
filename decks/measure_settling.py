"""What the decks of bodies that settle, and rebound, measure, for measure.py, READMEs and tests."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

RADIUS = 0.0075  # m, of the sphere of decks/settling
STEEL = 0.0015  # m, of the sphere of decks/bounce_in_oil
FIRST = 0.0024  # s after contact, of the first measured point there


def settling(results: Path, deck: str) -> dict[str, float]:
    """Largest speed downwards, and when the gap below the sphere is half its diameter (nan where it is not yet)."""
    with h5py.File(results / "history.h5") as file:
        t, body = file["time"][:], file["bodies/sphere"]
        w, gap = body["velocity"][:, 2], body["position"][:, 2] - RADIUS
    there = np.flatnonzero(gap <= RADIUS)
    return {
        "peak speed": float(-w.min()),
        "arrival": float(np.interp(-RADIUS, -gap, t)) if len(there) else np.nan,
    }


def bounce_in_oil(results: Path, deck: str) -> dict[str, float]:
    """Speed half a diameter above the floor; height and time of the first rebound, its mean speed at the start."""
    with h5py.File(results / "history.h5") as file:
        t, body, hits = file["time"][:], file["bodies/sphere"], file["collisions/time"][:]
        gap, w = body["position"][:, 2] - STEEL, body["velocity"][:, 2]
    hit = float(hits[0])
    end = float(hits[1]) if len(hits) > 1 else np.inf
    fall = t < hit
    arrival = -float(np.interp(-STEEL, -gap[fall], w[fall]))
    flight = (t > hit) & (t < end)
    top = int(np.argmax(gap[flight]))
    return {
        "speed at arrival": arrival,
        "first peak": float(gap[flight][top]),
        "time of the peak": float(t[flight][top]) - hit,
        "mean speed of 2.4 ms over arrival": float(np.interp(hit + FIRST, t, gap)) / FIRST / arrival,
    }
