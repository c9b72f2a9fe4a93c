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
            self.momentum = {key: table[:] for key, table in file["momentum"].items()}
            probes = file.get("probes", {})
            self.heights = {int(k): group["height"][:] for k, group in probes.items()}

    def push(self, start: float, end: float) -> float:
        """Mean force up on the prescribed bodies between two times, of the book: it has every step's whole impulse."""
        given = np.interp([start, end], self.time, self.momentum["prescribed"][:, 2])
        return float(given[0] - given[1]) / (end - start)

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
    """The plate's speed after its blow over that before, at t = .006 s and .002 s; of the round bodies what `slam`
    says, of the one that is held the mean of its lift over a swing of the tank in weights of the water displaced."""
    motion = Motion(results, {"held": "cylinder"}.get(deck, deck))
    if deck == "plate":
        before, after = np.interp([0.002, 0.006], motion.time, motion.body["velocity"][:, 2])
        found = {"speed after over before": after / before}
    elif deck == "held":
        found = {"lift over buoyancy": motion.push(0.5, 1.5) / (9.81 * 1000.0 * 0.5 * np.pi * 0.1**2 * 0.02)}
    else:
        found = slam(motion, deck)
    return found | {"volume error": motion.volume_error()}


def slam(motion: Motion, deck: str) -> dict[str, float]:
    """Means of Cs = force / (.5 rho V2 area) over depths h of the lowest point, which starts 5 mm over the water, the
    buoyancy of what is below the level taken off; and what the book of momentum leaves open, over what the body gave.
    """
    R, V, rho, start = 0.1, 5.0, 1000.0, 0.005
    area, ranges = {"cylinder": (2.0 * R * 0.005, ((0.0, 0.1), (0.1, 0.5))),
                    "sphere": (0.25 * np.pi * R**2, ((0.0, 0.1), (0.1, 0.2), (0.2, 0.5)))}[deck]  # fmt: skip
    found = {}
    for low, high in ranges:
        h = np.linspace(low, high, 201) * R
        below = {
            "cylinder": R**2 * np.arccos(1.0 - h / R) - (R - h) * np.sqrt(h * (2.0 * R - h)),
            "sphere": 0.25 * np.pi * h**2 * (R - h / 3.0),
        }[deck] * (0.005 if deck == "cylinder" else 1.0)
        force = motion.push((start + low * R) / V, (start + high * R) / V)
        found[f"Cs, h/R {low} to {high}"] = (force - 9.81 * rho * below.mean()) / (0.5 * rho * V**2 * area)
    left = motion.momentum["remainder"][-1, 2] / motion.momentum["prescribed"][-1, 2]
    return found | {"momentum left over": abs(left)}
