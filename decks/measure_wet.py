"""What the decks with liquid measure, for measure.py: the same functions serve the READMEs and the tests."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

DECKS = Path(__file__).parent


class Gauges:
    """What a wet run recorded: time (n,), fluid {name: (n,)}, probes {k: {name: (n,)}}, last: the fields at the end."""

    def __init__(self, results: Path) -> None:
        with h5py.File(results / "history.h5") as file:
            self.time = file["time"][:]
            self.fluid = {name: table[:] for name, table in file["fluid"].items()}
            self.probes = {
                int(k): {name: table[...] for name, table in group.items()}
                for k, group in file.get("probes", {}).items()
            }
        with h5py.File(results / "restart.h5") as file:
            self.last = {name: table[...] for name, table in file["state/fluid"].items()}

    def probe(self, number: int, name: str) -> np.ndarray:
        return self.probes[number][name]


def series(case: str) -> np.ndarray:
    """decks/<case>/measured.csv, by the names of its columns."""
    with (DECKS / case / "measured.csv").open(encoding="utf-8") as file:
        return np.genfromtxt((line for line in file if not line.startswith("#")), delimiter=",", names=True)


def dam_break(results: Path, deck: str) -> dict[str, float]:
    """SPHERIC 2: pressures P1, P2 on the box, heights at two gauges, against the measured series."""
    gauges = Gauges(results)
    found = against_spheric(
        gauges.time,
        (gauges.probe(1, "p"), gauges.probe(2, "p")),
        (gauges.probe(3, "height"), gauges.probe(4, "height")),
    )
    found["volume error"] = np.abs(gauges.fluid["volume_error"]).max()
    return found


def against_spheric(t: np.ndarray, pressures: tuple, heights: tuple) -> dict[str, float]:
    """P1, P2 (n,) [Pa] and heights (n,) [m] at both gauges, at times t (n,) [s], against the measured ones."""
    there = series("dam_break")
    there = there[there["t"] <= t[-1]]
    p1, p2 = pressures
    window = np.linspace(0.39, 0.8, 1000)  # VALIDATION D: the first blow
    impulse = np.trapezoid(np.interp(window, t, p1), window)
    measured = np.trapezoid(np.interp(window, there["t"], there["P1"]), window)
    found = {
        "P1 peak": p1.max(),
        "P2 peak": p2.max(),
        "P1 peak of 5 ms means": means(t, p1, 0.005).max(),
        "P2 peak of 5 ms means": means(t, p2, 0.005).max(),
        "P1 impulse over measured": impulse / measured,
        "arrival over measured": _passes(t, p1, 1000.0) / _passes(there["t"], there["P1"], 1000.0),
    }
    for name, height in zip(("h_1488", "h_0992"), heights, strict=True):
        ours = np.interp(there["t"], t, height)
        found[f"mean error of {name} over .55 m"] = np.mean(np.abs(ours - there[name])) / 0.55
    return found


def means(t: np.ndarray, values: np.ndarray, width: float) -> np.ndarray:
    """Means over windows of this width [time], one beginning at each row."""
    sums = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))])
    begin = t[t <= t[-1] - width]
    return (np.interp(begin + width, t, sums) - np.interp(begin, t, sums)) / width


def _passes(t: np.ndarray, values: np.ndarray, level: float) -> float:
    """When values first rise above the level, linear between the rows."""
    k = max(int(np.argmax(values > level)), 1)
    return t[k - 1] + (t[k] - t[k - 1]) * (level - values[k - 1]) / (values[k] - values[k - 1])


def still_water(results: Path, deck: str) -> dict[str, float]:
    """The fastest face over sqrt(g H), H the depth."""
    gauges = Gauges(results)
    fastest = max(np.abs(gauges.last[name][2:-2, 2:-2, 2:-2]).max() for name in ("u", "v", "w"))
    return {
        "largest speed over sqrt(g H)": fastest / np.sqrt(9.81 * 0.613),
        "volume error": np.abs(gauges.fluid["volume_error"]).max(),
    }


def sloshing(results: Path, deck: str) -> dict[str, float]:
    """Depths at 1/6 and 5/6 of the tank: their difference holds no third mode and, as of any odd one, twice the first.

    The period from the first to the last passage through level; what is left from the first period to the last one.
    """
    gauges = Gauges(results)
    t, tilt = gauges.time, gauges.probe(1, "height") - gauges.probe(2, "height")
    k = np.flatnonzero(tilt[:-1] * tilt[1:] < 0.0)
    level = t[k] + (t[k + 1] - t[k]) * tilt[k] / (tilt[k] - tilt[k + 1])
    period = 2.0 * (level[-1] - level[0]) / (len(level) - 1)
    first, last = (np.ptp(tilt[part]) for part in (t <= period, t >= t[-1] - period))
    return {
        "period": period,
        "first mode left": last / first,
        "volume error": np.abs(gauges.fluid["volume_error"]).max(),
    }


def martin_moyce(results: Path, deck: str) -> dict[str, float]:
    """The front is where the depth falls below .05 a, the tip where it falls below .02 a, a the width of the column.

    delayed: the gate of the experiment takes T = t sqrt(2 g / a) = .175 to get out of the way (VALIDATION D).
    """
    a = 0.05715  # 2.25 in, in metres
    there = series("martin_moyce")
    t, depth, x = depths(results)
    T = t * np.sqrt(2.0 * 9.81 / a)

    def errors(least: float, delay: float) -> np.ndarray:
        front = np.array([farthest(x, h, least * a) for h in depth])
        return np.abs(np.interp(there["T"] - delay, T, front / a) / there["Z"] - 1.0)

    return {
        "mean error of the front, delayed": errors(0.05, 0.175).mean(),
        "largest error of the front, delayed": errors(0.05, 0.175).max(),
        "mean error of the tip, delayed": errors(0.02, 0.175).mean(),
        "mean error of the front, raw": errors(0.05, 0.0).mean(),
        "volume error": np.abs(Gauges(results).fluid["volume_error"]).max(),
    }


def depths(results: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the snapshots of a scene of one cell in y: times (m,), depths (m, nx), planes x (nx + 1,)."""
    with h5py.File(results / "fields.h5") as file:
        shots = [group for group in file.values() if "time" in group.attrs]
        shots.sort(key=lambda group: group.attrs["time"])
        t = np.array([group.attrs["time"] for group in shots])
        depth = np.array([group["F"][:, 0] @ np.diff(file["z"][:]) for group in shots])
        return t, depth, file["x"][:]


def farthest(x: np.ndarray, depth: np.ndarray, least: float) -> float:
    """The largest x where the depth is `least`; depth (nx,) holds at the middles of the cells between planes x."""
    middle = 0.5 * (x[1:] + x[:-1])
    k = int(np.flatnonzero(depth >= least)[-1])
    if k + 1 == len(depth):
        return float(x[-1])
    return float(middle[k] + (middle[k + 1] - middle[k]) * (depth[k] - least) / (depth[k] - depth[k + 1]))


def wall_impact(results: Path, deck: str) -> dict[str, float]:
    """Pressure at the sensor on the far wall over rho g H against T = t sqrt(g / H); the water arrives at p = .5."""
    height, g, rho = 0.3, 9.81, 1000.0
    there = series("wall_impact")
    gauges = Gauges(results)
    T, p = gauges.time * np.sqrt(g / height), gauges.probe(1, "p") / (rho * g * height)
    arrivals, impulses = [], []
    blow = np.linspace(2.4, 3.0, 1000)  # from just before the arrival until the pressure is half the peak
    for t, y in ((T, p), (there["t"], there["p_median"])):
        k = int(np.argmax(y >= 0.5))
        arrivals.append(t[k - 1] + (t[k] - t[k - 1]) * (0.5 - y[k - 1]) / (y[k] - y[k - 1]))
        impulses.append(np.trapezoid(np.interp(blow, t, y), blow))
    return {
        "peak over rho g H": p.max(),
        "arrival over measured": arrivals[0] / arrivals[1],
        "impulse of the blow over measured": impulses[0] / impulses[1],
        "pressure at T = 4 over rho g H": np.interp(4.0, T, p),
        "volume error": np.abs(gauges.fluid["volume_error"]).max(),
    }


def ritter(results: Path, deck: str) -> dict[str, float]:
    """Depths against h = h0 (2 - s)^2 / 9, s = x / (t sqrt(g h0)) from -1 to 2, at t = 10 and 15 sqrt(h0 / g).

    Mean over the wave of |h - exact| / h0, exact averaged over each cell; the front is where the depth falls below .05.
    """
    c = np.sqrt(9.81)
    t, depth, x = depths(results)
    found = {}
    for T in (10.0, 15.0):
        k = int(np.argmin(np.abs(t * c - T)))
        way = c * t[k]
        s = np.clip(x / way, -1.0, 2.0)
        below = np.minimum(x, -way) + way * (27.0 - (2.0 - s) ** 3) / 27.0  # integral of the exact depth up to x
        exact = np.diff(below) / np.diff(x)
        found[f"mean error at T = {T:.0f}"] = np.abs(depth[k] - exact) @ np.diff(x) / (3.0 * way)
        found[f"depth at the dam at T = {T:.0f}"] = np.interp(0.0, 0.5 * (x[1:] + x[:-1]), depth[k])
        found[f"front at T = {T:.0f} over exact"] = farthest(x, depth[k], 0.05) / (way * (2.0 - 3.0 * np.sqrt(0.05)))
    return found | {"volume error": np.abs(Gauges(results).fluid["volume_error"]).max()}
