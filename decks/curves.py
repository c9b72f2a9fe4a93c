"""One run as arrays, and what several decks measure from it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import h5py
import numpy as np


class Curves:
    """The history of one run: time (n,), per body position, velocity, spin, ... (n, 3), impacts as arrays."""

    def __init__(self, results: Path) -> None:
        with h5py.File(results / "history.h5", "r") as file:
            self.time = file["time"][:]
            self.gravity = file.attrs["gravity"]
            self.bodies = {
                name: {quantity: table[:] for quantity, table in group.items()}
                for name, group in file["bodies"].items()
            }
            self.mass = {name: float(group.attrs.get("mass", 0.0)) for name, group in file["bodies"].items()}
            self.impacts = {name: table[:] for name, table in file["collisions"].items()}
            self.regimes = [str(name) for name in file["collisions/regime"].attrs["names"]]
            self.energy = {name: table[:] for name, table in file["energy"].items()}

    def row(self, t: float) -> int:
        """The row at time t."""
        row = int(np.argmin(np.abs(self.time - t)))
        assert abs(self.time[row] - t) <= 1e-9 * self.time[-1], f"no history row at t = {t}"
        return row

    def at(self, body: str, quantity: str, t: float | None = None) -> np.ndarray:
        """A vector of a body at time t; without a time at the end."""
        return self.bodies[body][quantity][-1 if t is None else self.row(t)]


def body_axes(orientation: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) turned from space to body axes; orientation (n, 4) quaternions w x y z from body to space."""
    w, r = orientation[:, :1], -orientation[:, 1:]
    return vectors + 2.0 * np.cross(r, np.cross(r, vectors) + w * vectors)


def first_hit(curves: Curves, a: int, b: int) -> float:
    """Time of the first impact between components a and b; not a number where they never meet."""
    parties = np.sort([curves.impacts["a"], curves.impacts["b"]], axis=0)
    times = curves.impacts["time"][(parties[0] == min(a, b)) & (parties[1] == max(a, b))]
    return float(times.min()) if len(times) else np.nan


def after_hit(curves: Curves, number: int, body: str, quantity: str) -> np.ndarray:
    """A vector of a body, component `number`, in the row that follows its first impact."""
    hit = curves.impacts["time"][(curves.impacts["a"] == number) | (curves.impacts["b"] == number)].min()
    return curves.bodies[body][quantity][np.searchsorted(curves.time, hit, side="right")]


def drift(curves: Curves, bodies: Iterable[str], size: float) -> float:
    """Largest way of any of the bodies from its start, at any time, in sizes."""
    ways = (curves.bodies[body]["position"] - curves.bodies[body]["position"][0] for body in bodies)
    return max(float(np.linalg.norm(way, axis=1).max()) for way in ways) / size


def energy_added(curves: Curves, scale: float = 0.0) -> float:
    """Largest rise of kinetic + potential energy beyond what was given, part of `scale` or of the largest kinetic."""
    given = sum(curves.energy[k] for k in ("work_prescribed", "work_loads", "work_boundaries") if k in curves.energy)
    total = curves.energy["kinetic"] + curves.energy["potential"] - given
    return float((total - np.minimum.accumulate(total)).max() / (scale or curves.energy["kinetic"].max()))
