"""What the decks of bodies that settle measure, for measure.py, READMEs and tests."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

RADIUS = 0.0075  # m, of the sphere of decks/settling


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
