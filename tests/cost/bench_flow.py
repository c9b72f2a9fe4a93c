"""Prints what the liquid costs: `make bench-flow`, or python tests/cost/bench_flow.py [mesh | wet | large | effects].
No test.

mesh   a dam break with a box in the way on finer and finer meshes: time a step, cell-steps a second, pressure
       iterations, bytes per cell, time of each effect, and the share of the memory's bandwidth that it reaches
wet    a tank of one mesh, filled from 5 % to 100 %: time a step goes with what is wet, and with its surface: the same 5
       and 25 % as a thin slope over all of the floor and as a block at one end
large  the dam break on 3.2 million cells
effects  the dam break on 50 000 cells, each effect added to the same scene alone, the same steps of each

Bandwidth. A triad a = b + s c by as many threads, on arrays that no cache holds, gives the bytes a second that can be
moved. What a stage must move at least is estimated as PASSES: arrays of float64 that its kernels read or write, each
once a kernel, for a cell with liquid. 100 % would be a program that waits for nothing but memory.
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
from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import G
from flowgmo.kernel import flow_kernel
from flowgmo.state import initial_state
from flowgmo.step import prepare, start_liquid, step

SECONDS = 12.0  # for each line
#: float64 values moved for a cell with liquid and step, counted in the kernels; those of each pressure iteration
PASSES = {
    # twice (Heun): clear a 3, gravity 2, advection 3 (u v w, a twice), u + dt a 9; last pressure 15; beside 12
    "momentum": (2 * (3 + 2 + 15 + 9) + 15 + 12, 0),
    # marks and b 12, diagonal 4, right side 5, coarse matrices (float32) 7, first guess 3, u - grad q 15, beside 12;
    # an iteration: product 6, updates 9, one cycle of multigrid in float32: some 25 passes on levels that sum up to 8/7
    "pressure": (12 + 4 + 5 + 7 + 3 + 15 + 12, 6 + 9 + 14),
    # copy F 2; three sweeps: F read, normals of F, u, flux written and read, F read and written, dilatation
    "liquid": (2 + 3 * 8, 0),
}
DECK = """a tank
&xput
 twfin=100., delt=.002, itb=1, gz=-9.81, ipdis=1, {xput}
/
&props
 rhof=1000., {props}
/
{output}
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


STEPS = 40, 120  # of each effect: before, and that count
OILY = {"props": "mu1=.1,"}
EFFECTS = {  # added to the dam break, one at a time
    "plain": {},
    "no box": {"bodies": ""},
    "ifvof=4": {"xput": "ifvof=4,"},
    "iorder=1": {"xput": "iorder=1,"},
    "viscosity": OILY | {"xput": "ifvisc=1,"},
    "and walls": OILY | {"xput": "ifvisc=1, iwsh=1,"},
    "implicit": OILY | {"xput": "ifvisc=1, iwsh=1, impvis=1,"},
    "load on the box": {"bodies": BOX + "ifrco(1)=1,"},
    "9 probes, 3 planes": {
        "output": "&grafic\n"
        + "".join(f"xloc({n})={0.3 * n}, yloc({n})=.4, zloc({n})=.1,\n" for n in range(1, 10))
        + "/\n&flowgmo\n planex=.5, 1., 1.5,\n/\n"
    },
    "rcsql": {"xput": "", "props": "rcsql=4e-10,"},
    "igmres=0": {"xput": "igmres=0,"},
}


@flow_kernel
def triad(columns, first, last, a, b, c):
    """a = b + 3 c."""
    for n in range(first, last):
        i, j = columns[n, 0], columns[n, 1]
        for k in range(np.uint64(columns[n, 2]), np.uint64(columns[n, 3])):
            a[i, j, k] = b[i, j, k] + 3.0 * c[i, j, k]


def bandwidth(team: object) -> float:
    """Bytes a second that the team's threads move: the best of ten triads of 3 x 64 MB."""
    arrays = [np.full((200, 200, 200), x) for x in (0.0, 1.0, 2.0)]
    columns, best = all_columns(arrays[0].shape), np.inf
    team.run(triad, columns, *arrays)
    for _ in range(10):
        began = time.perf_counter()
        team.run(triad, columns, *arrays)
        best = min(best, time.perf_counter() - began)
    return 3 * 8 * (200 - 2 * G) ** 3 / best


class Tank:
    """One scene, stepped for a while."""

    def __init__(
        self, n: tuple[int, int, int], liquid: str, bodies: str = BOX, xput: str = "", props: str = "", output: str = ""
    ) -> None:
        path = Path(tempfile.mkdtemp()) / "tank.nml"
        path.write_text(DECK.format(n=n, liquid=liquid, bodies=bodies, xput=xput, props=props, output=output))
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

    def run(self, seconds: float, most: float, wet: list) -> tuple[int, float]:
        """Steps made, `most` at most, and their wall time; wet gains the number of liquid cells of each."""
        began, steps = time.perf_counter(), 0
        while time.perf_counter() - began < seconds and steps < most:
            self.advance()
            wet.append(np.count_nonzero(self.world.liquid.projector.wet))
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


def line(name: str, tank: Tank, speed: float, first: int = 0, most: float = np.inf) -> None:
    """One line: what it says in the module's docstring. speed: bytes a second of the triad; first: steps that do not
    count, of `most` that do."""
    tank.run(np.inf, first, [])
    tank.world.seconds.clear()
    tally, projector, wet = tank.world.liquid.tally, tank.world.liquid.projector, []
    before = tally.all_iterations, projector.solves
    steps, wall = tank.run(SECONDS, most, wet)
    cells, held = tank.model.mesh.cells, float(np.mean(wet))
    iterations = (tally.all_iterations - before[0]) / steps  # of all solutions of a step: voids ask for several
    solves = (projector.solves - before[1]) / steps
    moved, parts = 0.0, []
    for part, seconds in tank.world.seconds.items():
        once, each = PASSES.get(part, (0, 0))
        here = 8.0 * held * (once + each * iterations)
        moved += here
        share = f" ({here * steps / seconds / speed:.0%})" if here else ""
        parts.append(f"{part} {seconds / steps * 1e3:.1f}{share}")
    print(
        f"{name:18} {cells:8d} {held / cells:5.0%} {steps:5d} {wall / steps * 1e3:8.1f} "
        f"{cells * steps / wall / 1e6:7.2f} {wall / steps / held * 1e9:7.0f} {iterations:5.1f} {solves:5.2f} "
        f"{tank.bytes_per_cell():5.0f} {moved / held:6.0f} {moved * steps / wall / speed:5.0%}   {', '.join(parts)}",
        flush=True,
    )


def main(arguments: list[str]) -> None:
    dam, asked = "nfls=1, fxl(1)=1.992, fzh(1)=.55,", set(arguments or ("mesh", "wet", "large", "effects"))
    first = Tank((40, 12, 12), dam)
    speed = bandwidth(first.world.liquid.team)
    print(f"{first.world.liquid.team.threads} threads; a triad moves {speed / 1e9:.1f} GB/s")
    heads = ("cells", 8), ("wet", 5), ("steps", 5), ("ms/step", 8), ("Mcell/s", 7), ("ns/wet", 7), ("its", 5)
    heads += ("solve", 5), ("B/cell", 5), ("B/step", 6), ("of bw", 5)
    print(f"{'':18} " + " ".join(f"{head:>{width}}" for head, width in heads) + "   ms of each (of the bandwidth)")
    if "mesh" in asked:
        for n in ((40, 12, 12), (81, 25, 25), (161, 50, 50)):
            line("dam break", Tank(n, dam), speed)
    if "wet" in asked:
        for share in (0.05, 0.25, 0.5, 0.75, 1.0):
            line(f"tank {share:.0%} wet", Tank((161, 50, 50), _filled(share), bodies=""), speed)
        for share in (0.05, 0.25):
            block = f"nfls=1, fxl(1)={3.22 * (1.0 - share / 0.8)}, fzh(1)=.8,"
            line(f"{share:.0%}, a block", Tank((161, 50, 50), block, bodies=""), speed)
    if "large" in asked:
        line("dam break", Tank((322, 100, 100), dam), speed)
    if "effects" in asked:
        for name, more in EFFECTS.items():
            line(name, Tank((81, 25, 25), dam, **more), speed, *STEPS)


def _filled(share: float) -> str:
    """A slope of liquid, so that it moves, of this share of the tank's cells; all of it: but a corner of .1."""
    if share == 1.0:
        return "nfls=2, fioh(2)=0, fxl(2)=3.12, fzl(2)=.9,"
    low, high = (0.0, 2.0 * share) if share <= 0.5 else (2.0 * share - 1.0, 1.0)
    slope = (high - low) / 3.22
    return f"nfls=1, fcc(1)={-high}, fcx(1)={slope}, fcz(1)=1.,"


if __name__ == "__main__":
    main(sys.argv[1:])
