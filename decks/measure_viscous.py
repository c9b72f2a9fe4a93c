"""What the decks of viscous flow without a surface measure, for measure.py, READMEs and tests."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from measure_wet import Gauges

Array = np.ndarray


def _planes(results: Path) -> list[Array]:
    """Planes of the mesh along x, y, z, each (n + 1,)."""
    with h5py.File(results / "fields.h5") as file:
        return [file[name][:] for name in "xyz"]


def cavity(results: Path, deck: str) -> dict[str, float]:
    """The least u on the vertical centre line, of the quartic through the five faces around it."""
    u, (x, _, z) = Gauges(results).last["u"], _planes(results)
    middle = int(np.argmin(np.abs(x - 0.5)))  # a plane of the mesh: u lies on it
    line, at = u[middle + 1, 2, 2:-2], 0.5 * (z[1:] + z[:-1])
    k = int(np.argmin(line))
    near = slice(k - 2, k + 3)
    fit = np.polyfit(at[near] - at[k], line[near], 4)
    return {"least u on the centre line": np.polyval(fit, np.linspace(at[k - 1], at[k + 1], 401) - at[k]).min()}


def poiseuille(results: Path, deck: str) -> dict[str, float]:
    """Against u = g (H^2 / 4 - s^2) / (2 nu), s the distance from the middle of the channel, g / nu = 8.

    Mean over the open faces in shares of the largest velocity; the flow; and what the walls hold of the weight.
    """
    if deck == "oblique":
        return _oblique(results)
    u, z = Gauges(results).last["u"], _planes(results)[2]
    at = 0.5 * (z[1:] + z[:-1])
    line = u[3, 2, 2:-2]  # a plane inside the channel: on the sides u is as beside them
    return {
        "mean error of u": np.abs(line - 4.0 * at * (1.0 - at)).mean(),
        "flow over exact": line @ np.diff(z) / (2.0 / 3.0),
    }


def _oblique(results: Path) -> dict[str, float]:
    """The channel lies along (2, 1): s = (z - x / 2) 2 / sqrt 5, modulo 1 along z; H = .54 x 2 / sqrt 5."""
    x, y, z = _planes(results)
    last, along = Gauges(results).last, np.array([2.0, 1.0]) / np.sqrt(5.0)
    wide = 0.54 * along[0]
    largest = wide**2  # g / (8 nu) = 1
    centres = [0.5 * (a[1:] + a[:-1]) for a in (x, z)]
    off = amount = 0.0
    for q, at, part in ((last["u"], (x[1:], centres[1]), along[0]), (last["w"], (centres[0], z[1:]), along[1])):
        s = np.subtract.outer(0.5 * at[0], at[1])
        s = (s - np.round(s)) * along[0]
        q, exact = q[2:-2, 2, 2:-2], part * (wide**2 - 4.0 * s**2)
        inside = (exact > 0.0) & (q != 0.0)
        off += np.abs(q - exact)[inside].sum() / largest
        amount += inside.sum()
    with h5py.File(results / "history.h5") as file:
        force = sum(file[f"bodies/{name}/force"][-1] for name in ("above", "below"))
        flow = file["planes/1/flow"][-1]
    weight = 0.8 * 0.54 * np.ptp(x) * np.ptp(y)  # g rho times the liquid's volume
    return {
        "mean error of u": off / amount,
        "flow over exact": flow / (2.0 / 3.0 * largest * wide * np.ptp(y)),
        "held by the walls over weight": force[[0, 2]] @ along / weight,
    }


def cylinder(results: Path, deck: str) -> dict[str, float]:
    """Drag and lift of a cylinder of diameter 1 and length 1 in a stream of speed 1 and density 1: twice the forces.

    Over whole periods after t = 30, from one rise of the lift through its mean to the last.
    """
    with h5py.File(results / "history.h5") as file:
        t, force = file["time"][:], file["bodies/cylinder/force"][:]
        shear = file["bodies/cylinder/force_shear"][:]
    late = t >= 30.0
    t, drag, lift, shear = t[late], 2.0 * force[late, 0], 2.0 * force[late, 2], 2.0 * shear[late, 0]
    swing = lift - lift.mean()
    k = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    rises = t[k] - swing[k] * (t[k + 1] - t[k]) / (swing[k + 1] - swing[k])
    whole = (t >= rises[0]) & (t <= rises[-1])
    return {
        "drag": drag[whole].mean(),
        "drag by shear": shear[whole].mean(),
        "Strouhal number": (len(rises) - 1) / (rises[-1] - rises[0]),
        "largest lift": np.abs(lift[whole]).max(),
    }
