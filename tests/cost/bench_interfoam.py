"""The dam break of SPHERIC 2 with flowgmo and with OpenFOAM's interFoam, in turn: `make bench-interfoam`. No test.

    python tests/cost/bench_interfoam.py [end in s, 1] [FOLDER]

The case of interFoam lies in interfoam/: the tank, the number of cells and the walls of decks/dam_break/spheric2.nml;
air above, no surface tension, no turbulence; the usual schemes, steps up to a Courant number of 1/2, three pressure
corrections. Version 1912 or a later one of openfoam.com is asked for on the PATH, and mpirun.

Both run with two processes or threads, flowgmo before and after. Printed: wall time, steps, and what
decks/measure_wet.py finds of each. The height of a gauge is the sum of what its cells hold. Results stay in FOLDER if
it is given; what interFoam has left there is taken as it is.
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

import numpy as np
from tables import row, title

DECKS = Path(__file__).parents[2] / "decks"
sys.path.insert(0, str(DECKS))
from measure_wet import Gauges, against_spheric  # noqa: E402

CASE, DECK = Path(__file__).parent / "interfoam", DECKS / "dam_break/spheric2.nml"
SETTINGS = Path("/usr/share/openfoam")  # where distributions put them
CELL, CELLS = 0.02, 50  # [m], along a gauge


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


def of_interfoam(at: Path) -> tuple[dict[str, float], int]:
    """What is measured, and steps."""
    pressures = np.loadtxt(at / "postProcessing/pressure/0/p")
    filled = np.loadtxt(at / "postProcessing/gauges/0/alpha.water")[:, 1:]
    heights = tuple(CELL * filled[:, k * CELLS : (k + 1) * CELLS].sum(axis=1) for k in range(2))
    return against_spheric(pressures[:, 0], tuple(pressures[:, 1:].T), heights), len(pressures)


def of_flowgmo(at: Path) -> tuple[dict[str, float], int]:
    """What is measured, and steps."""
    gauges = Gauges(at / "spheric2.out")
    values = [(gauges.probe(a, name), gauges.probe(b, name)) for a, b, name in ((1, 2, "p"), (3, 4, "height"))]
    return against_spheric(gauges.time, *values), json.loads((at / "spheric2.out/run.json").read_text())["steps"]


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
    title(f"dam break to {end:g} s, two cores")
    row("", "flowgmo", "interFoam", width=36)
    row("wall time [s]", f"{before:.1f}", f"{theirs:.1f}", width=36)
    row("  again, after it", f"{after:.1f}", "", width=36)
    row("steps", steps, their_steps, width=36)
    for name, value in ours.items():
        row(name, f"{value:.5g}", f"{others[name]:.5g}", width=36)


if __name__ == "__main__":
    main()
