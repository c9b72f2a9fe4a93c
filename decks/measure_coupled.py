"""What the decks of impacts, valves and forced motion in liquid measure, for measure.py, READMEs and tests."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from measure_bodies import Motion

Array = np.ndarray


def impacts_of(results: Path) -> dict[str, Array]:
    """Columns of the table of impacts, those of one cluster summed: time, impulse, fluid_impulse, energy_loss."""
    with h5py.File(results / "history.h5") as file:
        table = {name: file[f"collisions/{name}"][:] for name in file["collisions"]}
    _, first, row = np.unique(table["cluster"], return_index=True, return_inverse=True)
    found = {"time": table["time"][first]}
    for name in ("impulse", "fluid_impulse", "energy_loss"):
        found[name] = np.zeros((len(first), *table[name].shape[1:]))
        np.add.at(found[name], row.ravel(), table[name])
    return found


def log(results: Path, deck: str) -> dict[str, float]:
    """Speed after the first impact over that before, positive where the log goes on towards the post.

    Before: of the rows, continued to the impact. After: of the rows that it is not in (wet); or, where the next impact
    follows at once (dry), its impulse over that of the first, both m (1 + e) times a speed.
    """
    motion, hits = Motion(results, "log"), impacts_of(results)
    t, v, e = motion.time, motion.body["velocity"][:, 0], 0.632
    hit, push = hits["time"][0], hits["impulse"][:, 0]  # on the post
    near = (t > hit - 0.02) & (t < hit - 0.003)
    before = np.polyval(np.polyfit(t[near] - hit, v[near], 1), 0.0)
    return {
        "speed after over before": push[1] / push[0] if deck == "dry" else np.interp(hit + 0.003, t, v) / before,
        "liquid's share of the impulse": -hits["fluid_impulse"][0, 0] / push[0],
        "energy lost over the law's": hits["energy_loss"][0] / (0.5 * (1.0 - e) * before * push[0]),
    }


def valve(results: Path, deck: str) -> dict[str, float]:
    """When the ball meets its seat first, and for good; then, from .05 s later on, what leaks through, and the load.

    leak: of the largest flow. void: what the liquid's volume lacks of that at the start, when there was none, of the
    ball's volume.
    """
    motion, hits = Motion(results, "ball"), impacts_of(results)
    with h5py.File(results / "history.h5") as file:
        flow = file["planes/1/flow"][:]
    shut, ball = motion.time > hits["time"][-1] + 0.05, 4.0 / 3.0 * np.pi * 0.04**3
    volume = motion.fluid["volume"]
    return {
        "time of closing": hits["time"][0],
        "time of rest": hits["time"][-1],
        "leak over largest flow": np.abs(flow[shut]).mean() / np.abs(flow).max(),
        "load on the closed ball": motion.body["force"][shut, 2].mean(),
        "most void": (volume[0] - volume.min()) / ball,
        "void of the closed valve": (volume[0] - volume[shut]).max() / ball,
        "volume error": motion.volume_error(),
    }


def hulme(results: Path, deck: str) -> dict[str, float]:
    """Added mass a and damping b of a sphere half in the water, over its displaced mass m and omega m.

    Four times the load on the quarter is, as the first harmonic, (a omega2 - C - i b omega) z, with C = rho g pi R2 of
    still water; load and height z are fitted over three periods after two.
    """
    motion, R, rho, g = Motion(results, "buoy"), 1.0, 1000.0, 9.81
    omega, mass = np.sqrt(g / R), 2.0 / 3.0 * np.pi * rho * R**3
    period = 2.0 * np.pi / omega
    some = (motion.time >= 2.0 * period) & (motion.time < 5.0 * period)
    t = motion.time[some]
    waves = np.stack([np.ones(len(t))] + [f(n * omega * t) for n in (1, 2, 3) for f in (np.cos, np.sin)], axis=1)
    both = np.stack([4.0 * motion.body["force"][some, 2], motion.body["position"][some, 2]], axis=1)
    load, height = (row[1] - 1j * row[2] for row in np.linalg.lstsq(waves, both, rcond=None)[0].T)
    answer = load / height / (omega**2 * mass)
    return {
        "added mass": answer.real + rho * np.pi * R**2 * R / mass,
        "damping": -answer.imag,
        "volume error": motion.volume_error(),
    }
