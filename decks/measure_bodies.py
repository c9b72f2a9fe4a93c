"""What the decks of bodies that move in liquid measure, for measure.py, READMEs and tests."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

Array = np.ndarray


class Motion:
    """What a run recorded of one body and the liquid: time (n,), body {name: (n, ...)}, heights {probe: (n,)}."""

    def __init__(self, results: Path, name: str) -> None:
        with h5py.File(results / "history.h5") as file:
            self.time = file["time"][:]
            self.body = {key: table[:] for key, table in file[f"bodies/{name}"].items()}
            self.fluid = {key: table[:] for key, table in file["fluid"].items()}
            probes = file.get("probes", {})
            self.heights = {int(k): group["height"][:] for k, group in probes.items()}

    def volume_error(self) -> float:
        """The largest of the run, relative to the volume that should be there."""
        return float(np.abs(self.fluid["volume_error"]).max())


def extremes(t: Array, y: Array) -> tuple[Array, Array]:
    """Times and values (k,) of the extremes between rows, of the parabola through three rows each; not the start."""
    step = np.diff(y)
    found = []
    for k in np.flatnonzero(step[:-1] * step[1:] <= 0.0) + 1:
        bend, slope, middle = np.polyfit(t[k - 1 : k + 2] - t[k], y[k - 1 : k + 2], 2)
        if bend != 0.0:
            late = -0.5 * slope / bend
            found.append((t[k] + late, middle + 0.5 * slope * late))
    return tuple(np.array(found).reshape(-1, 2).T)


def rest(values: Array) -> Array:
    """(k - 2,) levels about which a swing with extremes (k,) decays: the mean of two, and of the two next."""
    return 0.25 * (values[:-2] + 2.0 * values[1:-1] + values[2:])


def released_sphere(results: Path, deck: str) -> dict[str, float]:
    """Acceleration over g: slope of w over steps 2 to 10; and the least and largest of single steps, all over it."""
    motion = Motion(results, "ball")
    t, v = motion.time, motion.body["velocity"]
    some = slice(2, 11)
    slope = np.polyfit(t[some], v[some, 2], 1)[0]
    each = np.diff(v[:, 2]) / np.diff(t) / slope
    return {
        "acceleration over g": slope / 9.81,
        "least of a step over mean": each[:10].min(),
        "largest of a step over mean": each[:10].max(),
        "speed sideways over speed": np.abs(v[:11, :2]).max() / np.abs(v[10, 2]),
    }


def heave(results: Path, deck: str) -> dict[str, float]:
    """Height of the sphere over its rest, 1 m at the start: extremes, period of two swings, level of the swings."""
    motion = Motion(results, "buoy")
    when, z = extremes(motion.time, motion.body["position"][:, 2] - 20.0)
    found = {f"extreme {k + 1}": z[k] for k in range(4)}
    return found | {
        "period": (when[4] - when[0]) / 2.0,
        "rest level": rest(z[:5]).mean(),
        "volume error": motion.volume_error(),
    }


def floating_prism(results: Path, deck: str) -> dict[str, float]:
    """Angle [degrees] about which the prism swings in the end, from the last three extremes; upright is 0."""
    motion = Motion(results, "prism")
    q = motion.body["orientation"]
    start = {"quarter": 20.0, "half": 38.0}[deck]
    _, angle = extremes(motion.time, start + np.degrees(2.0 * np.arctan2(q[:, 2], q[:, 0])))
    return {"angle": rest(angle)[-1], "volume error": motion.volume_error()}


def gate(results: Path, deck: str) -> dict[str, float]:
    """Depths beyond where the gate stood at t = 1 s, and the books."""
    motion = Motion(results, "gate")
    return {
        "depth at x = 1.5 m": motion.heights[1][-1],
        "depth at x = 2 m": motion.heights[2][-1],
        "volume error": motion.volume_error(),
    }


def wavemaker(results: Path, deck: str) -> dict[str, float]:
    """Height of the waves over the stroke: the first harmonic over two periods from t = 9.5 s, mean of three gauges."""
    motion = Motion(results, deck)
    omega, stroke = 2.0 * np.pi * 0.615229, {"piston": 0.04, "flap": 0.06}[deck]
    some = (motion.time >= 9.5) & (motion.time < 9.5 + 4.0 * np.pi / omega)
    waves = [np.ones(some.sum())] + [f(n * omega * motion.time[some]) for n in (1, 2) for f in (np.cos, np.sin)]
    heights = []
    for height in motion.heights.values():
        parts = np.linalg.lstsq(np.stack(waves, axis=1), height[some], rcond=None)[0]
        heights.append(2.0 * np.hypot(*parts[1:3]))
    return {"wave height over stroke": np.mean(heights) / stroke, "volume error": motion.volume_error()}


def swept(results: Path, deck: str) -> dict[str, float]:
    """The books; how full the cells are is looked at after every step by every_step.py."""
    return {"volume error": Motion(results, "ball").volume_error()}


def stream(results: Path, deck: str) -> dict[str, float]:
    """What the body's velocity differs from the stream's, 1."""
    velocity = Motion(results, "ball").body["velocity"]
    return {"change of velocity": np.abs(velocity - np.array([1.0, 0.0, 0.0])).max()}


def water_entry(results: Path, deck: str) -> dict[str, float]:
    """Speed of the plate after its blow over that before: at t = .006 s over t = .002 s."""
    motion = Motion(results, "plate")
    before, after = np.interp([0.002, 0.006], motion.time, motion.body["velocity"][:, 2])
    return {"speed after over before": after / before, "volume error": motion.volume_error()}
