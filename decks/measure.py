"""Measure what a deck of this folder is about, and print it beside its reference.

    python decks/measure.py decks/anvil/anvil.out [more results ...]

Reads history.h5 of the results and reference.csv beside the deck. The folder of the deck names the case, so the
results must lie where `flowgmo run` puts them without -o. The same functions serve tests/decks, so that tests and
the tables in the READMEs say the same thing.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np

DECKS = Path(__file__).parent
sys.path.insert(0, str(DECKS))  # the tests load this file by its path

from curves import Curves, body_axes, drift, energy_added, first_hit  # noqa: E402
from measure_bodies import (  # noqa: E402
    floating_prism,
    gate,
    heave,
    released_sphere,
    stream,
    swept,
    water_entry,
    wavemaker,
)
from measure_coupled import hulme, log, valve  # noqa: E402
from measure_hard import hard  # noqa: E402
from measure_scenes import logs, stones  # noqa: E402
from measure_settling import bounce_in_oil, settling  # noqa: E402
from measure_viscous import cavity, cylinder, poiseuille  # noqa: E402
from measure_wet import dam_break, martin_moyce, ritter, sloshing, still_water, wall_impact  # noqa: E402


def central(curves: Curves, deck: str) -> dict[str, float]:
    return {f"velocity of {body}": curves.at(body, "velocity")[0] for body in ("left", "right")}


def anvil(curves: Curves, deck: str) -> dict[str, float]:
    """Top i from the rows of flight i: t + w/g and z - R + w²/2g are the same for all of them."""
    radius, g = 0.1, -curves.gravity[2]
    z, w = curves.bodies["ball"]["position"][:, 2], curves.bodies["ball"]["velocity"][:, 2]
    hits = curves.impacts["time"]
    found = {}
    for i in range(1, 10):
        row = np.searchsorted(curves.time, hits[i - 1], side="right")
        assert curves.time[row] < hits[i]
        found[f"t{i}"] = curves.time[row] + w[row] / g
        found[f"h{i}"] = z[row] - radius + w[row] ** 2 / (2 * g)
    found["rest"] = hits[curves.impacts["regime"] == curves.regimes.index("rest")][-1]
    found["height at the end"] = z[-1] - radius
    return found


def top(curves: Curves, deck: str) -> dict[str, float]:
    """The period from the return of w1 after one, at the rate it has there: dw1/dt = (I2 - I3) / I1 w2 w3."""
    plate, moments = curves.bodies["plate"], np.array([1.0, 2.0, 3.0])
    w = body_axes(plate["orientation"], plate["angular_velocity"])
    momentum = np.linalg.norm(w * moments, axis=1)
    energy = plate["kinetic_energy"]
    period = 39.105734197288
    row = curves.row(period)
    late = (w[row, 0] - w[0, 0]) / ((moments[1] - moments[2]) / moments[0] * w[0, 1] * w[0, 2])
    return {
        "period": period - late,
        "change of energy": np.abs(energy / energy[0] - 1.0).max(),
        "change of angular momentum": np.abs(momentum / momentum[0] - 1.0).max(),
        "w2 at a quarter": w[curves.row(0.25 * period), 1],
        "w2 at a half": w[curves.row(0.5 * period), 1],
    }


def pendulum(curves: Curves, deck: str) -> dict[str, float]:
    """The mass centre is highest twice a period, where its climb passes zero; the start is not counted."""
    body = curves.bodies["gate" if deck == "gate" else "rod"]
    if deck == "stop":
        return {
            "time of the stop": curves.impacts["time"][0],
            "stops met": len(curves.impacts["time"]),
            "energy lost": curves.impacts["energy_loss"][0],
            "angle at the end": np.degrees(2.0 * np.arccos(body["orientation"][-1, 0])),
        }
    height, climb = body["position"][:, 2], body["velocity"][:, 2]
    rows = np.flatnonzero((climb[:-1] > 0.0) & (climb[1:] <= 0.0))
    first, third = (_zero(curves.time, climb, k) for k in rows[[0, 2]])
    return {"period": third - first, "drop": height[0] - height.min()}


def _zero(t: np.ndarray, y: np.ndarray, k: int) -> float:
    """Where y passes zero between rows k and k + 1: of the cubic through the four rows around."""
    near, scale = slice(k - 1, k + 3), t[1] - t[0]
    roots = np.roots(np.polyfit((t[near] - t[k]) / scale, y[near], 3))
    roots = roots[np.abs(roots.imag) < 1e-9].real
    return float(t[k] + scale * roots[np.argmin(np.abs(roots - 0.5))])


def piston(curves: Curves, deck: str) -> dict[str, float]:
    times = {"piston": (0.5, 1.3, 4.0), "stops": (0.1, 0.3, 0.9, 1.3, 2.0), "table": (0.4, 1.0, 2.5, 4.0)}[deck]
    found = {}
    for t in times:
        found[f"x at {t} s"] = curves.at("piston", "position", t)[0]
        found[f"force x at {t} s"] = curves.at("piston", "residual_force", t)[0]
    found["force z"] = curves.at("piston", "residual_force")[2]
    return found


def billiards(curves: Curves, deck: str) -> dict[str, float]:
    cue, target = (curves.at(body, "velocity", 1.0) for body in ("cue", "object"))
    cross, dot = np.linalg.norm(np.cross(cue, target)), cue @ target
    return {
        "angle between": np.degrees(np.arctan2(cross, dot)),
        "speed of cue": np.linalg.norm(cue),
        "speed of object": np.linalg.norm(target),
    }


def chain(curves: Curves, deck: str) -> dict[str, float]:
    return {f"velocity of ball{k}": curves.at(f"ball{k}", "velocity")[0] for k in range(1, 6)}


def plane(curves: Curves, deck: str) -> dict[str, float]:
    """Slip: velocity of the ball's lowest point along x, u - R omega_y."""
    radius = 0.05 if deck == "impact" else 0.1
    found = {}
    for body in curves.bodies:
        u, _, w = curves.at(body, "velocity")
        slip = u - radius * curves.at(body, "angular_velocity")[1]
        if deck == "impact":
            found |= {f"slip of {body}": slip, f"rebound of {body}": w}
        else:
            found |= {f"way of {body}": curves.at(body, "position")[0], f"slip of {body}": slip}
    return found


def speeds(curves: Curves, t: float | None = None) -> dict[str, float]:
    return {f"speed of {ball}": np.linalg.norm(curves.at(ball, "velocity", t)) for ball in curves.bodies}


def rack(curves: Curves, deck: str) -> dict[str, float]:
    return speeds(curves) | {"velocity x of cue": curves.at("cue", "velocity")[0]}


def pool(curves: Curves, deck: str) -> dict[str, float]:
    """Smooth: speeds right after the break too, which comes at 0.1516 s; nothing lifts a ball there."""
    radius, half = 0.028575, np.array([1.27, 0.635])
    height = np.array([body["position"][:, 2] for body in curves.bodies.values()])
    ends = np.array([body["position"][-1, :2] for body in curves.bodies.values()])
    found = {
        "balls on the table": np.sum(np.all(np.abs(ends) < half, axis=1)),
        "depth in the slate": max(radius - height.min(), 0.0),
        "energy added": energy_added(curves),
    }
    if deck == "smooth":
        found |= speeds(curves, 0.16) | {"lift": max(height.max() - radius, 0.0)}
    return found


def domino(curves: Curves, deck: str) -> dict[str, float]:
    """Front speed: pitch over the time from hit to hit, over the way from block 10 to block 25."""
    found = {"front speed": 15 * 2.949 / (first_hit(curves, 25, 26) - first_hit(curves, 10, 11))}
    if deck == "plastic":
        found |= {f"hit of block {k}": first_hit(curves, k, k + 1) for k in range(1, 5)}
    return found


def stack(curves: Curves, deck: str) -> dict[str, float]:
    """Energy in weights of the lightest piece times its height."""
    size = {"tower": 0.1, "pyramid": 0.1, "wall": 0.06, "cards": 0.1}[deck]
    scale = min(curves.mass.values()) * np.linalg.norm(curves.gravity) * size
    return {"drift": drift(curves, curves.bodies, size), "energy added": energy_added(curves, scale)}


def incline(curves: Curves, deck: str) -> dict[str, float]:
    if deck == "rocking":
        return rocking(curves)
    ways = {
        f"way of {b}": np.ptp(curves.bodies[b]["position"][[0, -1], 0]) for b in ("holds", "just", "slides", "squat")
    }
    turn = curves.at("tips", "orientation", 0.2)
    return ways | {"turn of tips": np.degrees(2.0 * np.arctan2(abs(turn[2]), turn[0]))}


def rocking(curves: Curves) -> dict[str, float]:
    """Speeds of turn at a landing from the books: flat, all energy but that of the flat block is kinetic."""
    start, level = curves.bodies["block"]["position"][0, 2], 0.5 * 4.178
    total = curves.energy["kinetic"] + curves.energy["potential"]
    total = total - total[0] + curves.mass["block"] * 981.0 * (start - level)
    losses = curves.impacts["energy_loss"] > 1e-6 * total[0]  # 1e-6: a landing takes 9 % of it, rests take nothing
    landings = np.unique(np.round(curves.impacts["time"][losses], 9))  # contacts of one landing share its time
    row = int(np.searchsorted(curves.time, landings[0], side="right"))
    assert curves.time[row] < landings[1]
    return {
        "first landing": landings[0],
        "fifth landing": landings[4],
        "speed after over before": np.sqrt(total[row] / total[0]),
    }


_ALL = (central, anvil, top, pendulum, piston, billiards, chain, plane, rack, pool, domino, stack, incline, hard)
_FREE = (dam_break, still_water, sloshing, martin_moyce, wall_impact, ritter)
_WITH_BODIES = (released_sphere, heave, floating_prism, gate, wavemaker, swept, stream, water_entry)
_COUPLED = (log, valve, hulme, stones, logs)
_OTHERS = (cavity, poiseuille, cylinder, settling, bounce_in_oil)
WET = {case.__name__: case for case in (*_FREE, *_OTHERS, *_WITH_BODIES, *_COUPLED)}
CASES = {case.__name__: case for case in _ALL}


def measure(results: Path, case: str, deck: str) -> dict[str, float]:
    """What the run in `results` of the deck decks/<case>/<deck>.nml gives, by the names in its reference.csv."""
    found = WET[case](results, deck) if case in WET else CASES[case](Curves(results), deck)
    return {name: float(value) for name, value in found.items()}


def reference(case: str, deck: str) -> dict[str, tuple[float, str]]:
    """Value and unit of each quantity of a deck, from decks/<case>/reference.csv (deck, quantity, unit, value)."""
    with (DECKS / case / "reference.csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {row["quantity"]: (float(row["value"]), row["unit"]) for row in rows if row["deck"] == deck}


def main() -> None:
    """Print measured, reference and difference for each results folder on the command line."""
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[1:]:
        results = Path(name)
        case, deck = results.resolve().parent.name, results.stem
        if case not in WET and case not in CASES:
            sys.exit(f"{results}: a case is known by its folder, decks/CASE/DECK.out. Run its deck without -o")
        print(f"{case}/{deck}")
        expected = reference(case, deck)
        for quantity, value in measure(results, case, deck).items():
            if quantity not in expected:
                print(f"  {quantity:28} {value:18.12g} {'no reference':>18}")
                continue
            target, unit = expected[quantity]
            print(f"  {quantity:28} {value:18.12g} {target:18.12g} {unit:6} {value - target:10.1e}")


if __name__ == "__main__":
    main()
