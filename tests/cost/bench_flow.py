"""Prints what the liquid costs: `make bench-flow`, or python tests/cost/bench_flow.py [mesh | wet]. No test.

mesh  a dam break with a box in the way on finer and finer meshes: time a step, per effect, cell-steps a second,
      pressure iterations, bytes per cell
wet   a tank of one mesh, filled from 5 % to 100 %: time a step goes with what is wet
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from flowgmo.building import build_model
from flowgmo.deck import read_deck
from flowgmo.errors import StepTooLong
from flowgmo.state import initial_state
from flowgmo.step import prepare, start_liquid, step

SECONDS = 20.0  # for each line
DECK = """a tank
&xput
 twfin=100., delt=.002, itb=1, gz=-9.81, ipdis=1,
/
&props
 rhof=1000.,
/
&bcdata
 ibct=2, 2, 2, 2, 2, 2,
/
&mesh
 px=0., 3.22, nxcelt={n[0]}, py=0., 1., nycelt={n[1]}, pz=0., 1., nzcelt={n[2]},
/
&obs
 {bodies}
/
&fl
 {liquid}
/
"""


BOX = "nobs=1, iob(1)=1, xl(1)=.6635, xh(1)=.8245, yl(1)=.295, yh(1)=.698, zl(1)=0., zh(1)=.161,"


class Tank:
    """One scene, stepped for a while."""

    def __init__(self, n: tuple[int, int, int], liquid: str, bodies: str = BOX) -> None:
        path = Path(tempfile.mkdtemp()) / "tank.nml"
        path.write_text(DECK.format(n=n, liquid=liquid, bodies=bodies))
        self.model = build_model(read_deck(path), path.with_suffix(".out"))
        self.world, self.state = prepare(self.model), initial_state(self.model)
        start_liquid(self.world, self.state)
        self.advance()  # compiles, or loads
        self.world.seconds.clear()

    def advance(self) -> None:
        """One step as long as it may be."""
        dt = self.world.liquid.longest_step(self.state.fluid, self.model.clock.dt)
        while True:
            try:
                step(self.world, self.state, self.state.t + dt, np.zeros(0), landing=False)
                return
            except StepTooLong:
                dt *= 0.5

    def run(self, seconds: float) -> tuple[int, float]:
        """Steps made and their wall time."""
        began, steps = time.perf_counter(), 0
        while time.perf_counter() - began < seconds:
            self.advance()
            steps += 1
        return steps, time.perf_counter() - began

    def bytes_per_cell(self) -> float:
        """Of all arrays of mesh size that the state and the solver hold."""
        seen, total = set(), 0
        stack = [self.state.fluid, self.world.liquid]
        while stack:
            thing = stack.pop()
            if id(thing) in seen:
                continue
            seen.add(id(thing))
            if isinstance(thing, np.ndarray):
                total += thing.nbytes if thing.base is None else 0
            elif isinstance(thing, list | tuple | dict):
                stack.extend(thing.values() if isinstance(thing, dict) else thing)
            elif hasattr(thing, "__dict__") and type(thing).__module__.startswith("flowgmo"):
                stack.extend(vars(thing).values())
        return total / self.model.mesh.cells


def line(name: str, tank: Tank) -> None:
    steps, wall = tank.run(SECONDS)
    cells, tally = tank.model.mesh.cells, tank.world.liquid.tally
    wet = tank.world.liquid.projector.wet.sum() / cells
    parts = " ".join(f"{part} {seconds / steps * 1e3:.1f}" for part, seconds in tank.world.seconds.items())
    mean = tally.all_iterations / max(tally.solutions, 1)
    print(
        f"{name:22} {cells:9d} {wet:5.0%} {steps:6d} {wall / steps * 1e3:9.1f} {cells * steps / wall / 1e6:8.2f} "
        f"{mean:6.1f} {tank.bytes_per_cell():6.0f}   {parts}",
        flush=True,
    )


def main(arguments: list[str]) -> None:
    heads = ("cells", 9), ("wet", 5), ("steps", 6), ("ms a step", 9), ("Mcell/s", 8), ("its", 6), ("bytes", 6)
    print(f"{'':22} " + " ".join(f"{head:>{width}}" for head, width in heads) + "   ms of each")
    if not arguments or "mesh" in arguments:
        for n in ((40, 12, 12), (81, 25, 25), (161, 50, 50), (322, 100, 100)):
            line("dam break", Tank(n, "nfls=1, fxl(1)=1.992, fzh(1)=.55,"))
    if not arguments or "wet" in arguments:
        for share in (0.05, 0.25, 0.5, 0.75, 0.98):
            line(f"tank filled to {share:.0%}", Tank((161, 50, 50), f"nfls=1, fxh(1)=1.6, fzh(1)={share},", bodies=""))


if __name__ == "__main__":
    main(sys.argv[1:])
