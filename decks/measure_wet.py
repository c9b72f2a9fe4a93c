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


def dam_break(results: Path, deck: str) -> dict[str, float]:
    """SPHERIC 2: pressures P1, P2 on the box, heights at two gauges, against the measured series."""
    gauges = Gauges(results)
    t = gauges.time
    with (DECKS / "dam_break" / "measured.csv").open(encoding="utf-8") as file:
        there = np.genfromtxt((line for line in file if not line.startswith("#")), delimiter=",", names=True)
    there = there[there["t"] <= t[-1]]
    p1, p2 = gauges.probe(1, "p"), gauges.probe(2, "p")
    window = np.linspace(0.39, 0.8, 1000)  # VALIDATION D: the first blow
    impulse = np.trapezoid(np.interp(window, t, p1), window)
    measured = np.trapezoid(np.interp(window, there["t"], there["P1"]), window)
    found = {
        "P1 peak": p1.max(),
        "P2 peak": p2.max(),
        "P1 impulse over measured": impulse / measured,
        "arrival over measured": t[np.argmax(p1 > 1000.0)] / there["t"][np.argmax(there["P1"] > 1000.0)],
        "volume error": np.abs(gauges.fluid["volume_error"]).max(),
    }
    for k, name in ((3, "h_1488"), (4, "h_0992")):
        ours = np.interp(there["t"], t, gauges.probe(k, "height"))
        found[f"mean error of {name} over .55 m"] = np.mean(np.abs(ours - there[name])) / 0.55
    return found


def still_water(results: Path, deck: str) -> dict[str, float]:
    """The fastest face over sqrt(g H), H the depth."""
    gauges = Gauges(results)
    fastest = max(np.abs(gauges.last[name][2:-2, 2:-2, 2:-2]).max() for name in ("u", "v", "w"))
    return {
        "largest speed over sqrt(g H)": fastest / np.sqrt(9.81 * 0.613),
        "volume error": np.abs(gauges.fluid["volume_error"]).max(),
    }


def cavity(results: Path, deck: str) -> dict[str, float]:
    """The least u on the vertical centre line, of the quartic through the five faces around it."""
    u = Gauges(results).last["u"]
    n = u.shape[0] - 4
    line, z = u[n // 2 + 1, 2, 2:-2], (np.arange(n) + 0.5) / n
    k = int(np.argmin(line))
    near = slice(k - 2, k + 3)
    fit = np.polyfit(z[near] - z[k], line[near], 4)
    return {"least u on the centre line": np.polyval(fit, np.linspace(-2 / n, 2 / n, 401)).min()}
