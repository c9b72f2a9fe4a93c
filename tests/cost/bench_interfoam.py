"""The dam break of SPHERIC 2 with flowgmo and with OpenFOAM's interFoam, in turn: `make bench-interfoam`. No test.

    python tests/cost/bench_interfoam.py [end in s, 1] [FOLDER]

The case of interFoam lies in interfoam/: the tank, the number of cells and the walls of decks/dam_break/spheric2.nml;
air above, no surface tension, no turbulence; the usual schemes, steps up to a Courant number of 1/2, three pressure
corrections. Version 1912 or a later one of openfoam.com is asked for on the PATH, and mpirun.

Both run with two processes or threads, flowgmo before and after. Printed: wall time, steps, and what
decks/measure_wet.py finds of each. The height of a gauge is the sum of what its cells hold. Results stay in FOLDER if
it is given, with a picture of both; what interFoam has left there is taken as it is.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from tables import row, title

DECKS = Path(__file__).parents[2] / "decks"
sys.path.insert(0, str(DECKS))
from measure_wet import Gauges, against_spheric, means, series  # noqa: E402

CASE, DECK = Path(__file__).parent / "interfoam", DECKS / "dam_break/spheric2.nml"
SETTINGS = Path("/usr/share/openfoam")  # where distributions put them
CELL, CELLS = 0.02, 50  # [m], along a gauge
WINDOW = 0.01  # [s] of the picture's means


class Series(NamedTuple):
    """At times t (n,) [s]: pressures P1, P2 (n,) [Pa], heights (n,) [m] at both gauges."""

    t: np.ndarray
    pressures: tuple[np.ndarray, np.ndarray]
    heights: tuple[np.ndarray, np.ndarray]


def interfoam(end: float, at: Path) -> float:
    """Seconds that interFoam takes for the case up to `end`; its results lie in `at`."""
    shutil.copytree(CASE, at)
    control = at / "system/controlDict"
    text = control.read_text().replace("endTime           1;", f"endTime           {end};")
    control.write_text(text.replace("writeInterval     1;", f"writeInterval     {end};"))
    if SETTINGS.exists():
        os.environ.setdefault("WM_PROJECT_DIR", str(SETTINGS))
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    for command in ("blockMesh", "setFields", "decomposePar"):
        _call([command], at)
    began = time.perf_counter()
    _call(["mpirun", "-np", "2", "interFoam", "-parallel"], at)
    return time.perf_counter() - began


def flowgmo(end: float, at: Path) -> float:
    """Seconds that flowgmo takes for the deck up to `end`; its results lie in at / spheric2.out."""
    at.mkdir(exist_ok=True)
    (at / DECK.name).write_text(DECK.read_text().replace("twfin=3.0", f"twfin={end}"))
    began = time.perf_counter()
    _call([str(Path(sys.executable).with_name("flowgmo")), "run", DECK.name, "--overwrite", "--threads", "2"], at)
    return time.perf_counter() - began


def _call(command: list[str], at: Path) -> None:
    """Run a command, its output in a file of its name; its end is shown where it fails."""
    log = at / f"log.{Path(command[0]).name}"
    with log.open("w") as out:
        if subprocess.run(command, cwd=at, stdout=out, stderr=subprocess.STDOUT, check=False).returncode:
            sys.exit(f"{' '.join(command)} failed:\n{log.read_text()[-2000:]}")


def of_interfoam(at: Path) -> tuple[Series, int]:
    """What it gauged, and steps."""
    pressures = np.loadtxt(at / "postProcessing/pressure/0/p")
    filled = np.loadtxt(at / "postProcessing/gauges/0/alpha.water")[:, 1:]
    heights = tuple(CELL * filled[:, k * CELLS : (k + 1) * CELLS].sum(axis=1) for k in range(2))
    return Series(pressures[:, 0], tuple(pressures[:, 1:].T), heights), len(pressures)


def of_flowgmo(at: Path) -> tuple[Series, int]:
    """What it gauged, and steps."""
    gauges = Gauges(at / "spheric2.out")
    values = [(gauges.probe(a, name), gauges.probe(b, name)) for a, b, name in ((1, 2, "p"), (3, 4, "height"))]
    return Series(gauges.time, *values), json.loads((at / "spheric2.out/run.json").read_text())["steps"]


def draw(found: dict[str, Series], at: Path) -> None:
    """P1, P2 in means of 10 ms and both heights, beside what was measured."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    there = series("dam_break")
    there = there[there["t"] <= max(one.t[-1] for one in found.values())]
    figure, axes = plt.subplots(2, 2, figsize=(11, 7), layout="constrained")
    panels = [("P1", "P1 [kPa]", 1e-3), ("P2", "P2 [kPa]", 1e-3), ("h_1488", "height at x = 1.488 m [m]", 1.0),
              ("h_0992", "height at x = .992 m [m]", 1.0)]  # fmt: skip
    for n, (axis, (name, label, scale)) in enumerate(zip(axes.flat, panels, strict=True)):
        axis.plot(there["t"], scale * there[name], "k", lw=1.0, label="measured")
        for (who, one), colour in zip(found.items(), ("tab:red", "tab:blue"), strict=True):
            t, values = one.t, (one.pressures + one.heights)[n]
            if n < 2:
                values, t = means(t, values, WINDOW), t[t <= t[-1] - WINDOW] + 0.5 * WINDOW
            axis.plot(t, scale * values, colour, lw=1.2, label=who)
        axis.set(xlabel="t [s]", ylabel=label, xlim=(0.35 if n < 2 else 0.0, there["t"][-1]))
        axis.grid(alpha=0.3)
    axes[0, 0].legend()
    figure.savefig(at, dpi=90)


def main() -> None:
    end = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    with tempfile.TemporaryDirectory() as folder:
        home = Path(sys.argv[2] if len(sys.argv) > 2 else folder)
        home.mkdir(exist_ok=True)
        done = (home / "interfoam").exists()
        if not done and not shutil.which("interFoam"):
            sys.exit("interFoam is not on the PATH: install OpenFOAM, of openfoam.com, 1912 or later")
        before = flowgmo(end, home / "flowgmo")
        theirs = np.nan if done else interfoam(end, home / "interfoam")
        after = flowgmo(end, home / "flowgmo")
        (ours, steps), (others, their_steps) = of_flowgmo(home / "flowgmo"), of_interfoam(home / "interfoam")
        if len(sys.argv) > 2:
            draw({"flowgmo": ours, "interFoam": others}, home / "curves.png")
    title(f"dam break to {end:g} s, two cores")
    row("", "flowgmo", "interFoam", width=36)
    row("wall time [s]", f"{before:.1f}", f"{theirs:.1f}", width=36)
    row("  again, after it", f"{after:.1f}", "", width=36)
    row("steps", steps, their_steps, width=36)
    found = against_spheric(*others)
    for name, value in against_spheric(*ours).items():
        row(name, f"{value:.5g}", f"{found[name]:.5g}", width=36)


if __name__ == "__main__":
    main()
