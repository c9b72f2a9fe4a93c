"""Prints what bodies in the liquid cost: `make bench-bodies`, or python tests/cost/bench_bodies.py [PART ...]. No test.

fixed     a box 24 cells across in 520 000 cells of water that sloshes, once afloat and once held: milliseconds of each
          effect, V-cycles, and afloat / held
surface   a ball that floats, 10, 20, 40 cells across in one tank: cells that are sorted anew, milliseconds of the open
          fractions and microseconds for each of those cells, which should not grow
cycles    V-cycles a step of 1, 20, 50 spheres let go, by their density over the liquid's, under a surface and in a full
          tank: mean, most
impacts   the same of spheres that meet walls and each other in a full tank, with their added masses: of all steps, and
          of those with impacts
mass      V-cycles that the added mass of a body asks for where it is hit
"""

from __future__ import annotations

import sys

import numpy as np
from tables import row, title

from flowgmo_spheres import CLOSED, Counted, spheres  # isort: skip (tables adds its folder)
from flowgmo_wet import wet  # isort: skip

from flowgmo.flow.build import default_threads
from flowgmo.flow.immersed.added_mass import added_mass

WARM, STEPS = 6, 8  # steps before, since kernels are loaded and the first pressures found; steps that count
RATIOS = (0.001, 0.1, 0.5, 2.0, 10.0)
ACROSS = {1: 16, 20: 9, 50: 7}  # cells, of so many spheres in 48^3
BOX = (
    "nobs=1, obsid(1)='box', iob(1)=1, xl(1)=-.12, xh(1)=.12, yl(1)=-.12, yh(1)=.12, zl(1)=-.1, zh(1)=.1, rotz(1)=20.,"
    "trnx(1)=.5, trny(1)=.5, trnz(1)=.31, imo(1)={imo}, {more}"
)


def box(afloat: bool) -> str:
    return wet(
        "twfin=1., delt=.002, tdtmax(1)=.008, itb=1, ipdis=1, gz=-9.81, gx=.6, imobs=1,",
        props="rhof=1000.,", fl="flht=.3,",
        mesh="px=0.,1., py=0.,1., pz=0.,.5, nxcelt=102, nycelt=102, nzcelt=50,", bcdata=CLOSED,
        obs=BOX.format(imo=4, more="rhomvb(1)=500.,") if afloat else BOX.format(imo=0, more=""),
    )  # fmt: skip


def ball(across: int) -> str:
    """Half under water, of half its density, in 96 x 96 x 72 cells."""
    return wet(
        "twfin=1., delt=.002, tdtmax(1)=.004, itb=1, ipdis=1, gz=-9.81, imobs=1,",
        props="rhof=1000.,", fl="flht=.372,",
        mesh="px=0.,1., py=0.,1., pz=0.,.75, nxcelt=96, nycelt=96, nzcelt=72,", bcdata=CLOSED,
        obs=f"nobs=1, obsid(1)='ball', imo(1)=4, rhomvb(1)=500., iob(1)=1, rsh(1)={across / 192!r}, trnx(1)=.5, "
        "trny(1)=.5, trnz(1)=.37, utobs(1,1)=.3,",
    )  # fmt: skip


def warm(text: str) -> Counted:
    scene = Counted(text, default_threads())
    scene.steps(WARM)
    scene.world.seconds.update(dict.fromkeys(scene.world.seconds, 0.0))
    return scene


def fixed() -> None:
    title(f"A box 24 cells across, {default_threads()} threads: ms of wall time a step")
    scenes, found, walls = [warm(box(afloat)) for afloat in (True, False)], [[], []], []
    for _ in range(STEPS):  # in turns, since the machine has others to serve
        for scene, cycles in zip(scenes, found, strict=True):
            scene.step()
            cycles.append(scene.cycles)
    names = dict.fromkeys(name for scene in scenes for name in scene.world.seconds)
    row("", "afloat", "held")
    for name in names:
        row(name, *(f"{scene.world.seconds.get(name, 0.0) / STEPS * 1e3:.1f}" for scene in scenes))
    walls = [sum(scene.world.seconds.values()) / STEPS for scene in scenes]
    row("all", *(f"{wall * 1e3:.1f}" for wall in walls), f"{walls[0] / walls[1]:.2f}")
    row("V-cycles", *(f"{np.mean(cycles):.1f}" for cycles in found))
    row("steps tried again", *(scene.pace.cuts for scene in scenes))


def surface() -> None:
    title("A ball that floats: open fractions, ms of wall time a step")
    row("cells across", "cells", "ms", "us a cell", "step, ms", "V-cycles", "most")
    for across in (10, 20, 40):
        scene = warm(ball(across))
        cells, cycles = [], []
        for _ in range(STEPS):
            cycles += scene.steps(1)
            cells.append(scene.changed)
        seconds = scene.world.seconds
        each, whole = seconds["open fractions"] / STEPS, sum(seconds.values()) / STEPS
        row(
            across, f"{np.mean(cells):.0f}", f"{each * 1e3:.1f}", f"{each / np.mean(cells) * 1e6:.1f}",
            f"{whole * 1e3:.1f}", f"{np.mean(cycles):.1f}", max(cycles),
        )  # fmt: skip


def cycles() -> None:
    title("V-cycles a step, mean and most")
    row("spheres", *(f"r {ratio:g}" for ratio in RATIOS))
    for n, across in ACROSS.items():
        for full in (False, True):
            found = [Counted(spheres(n, r, full=full, across=across), default_threads()).steps(STEPS) for r in RATIOS]
            row(f"{n}, {'full tank' if full else 'surface'}", *(f"{np.mean(x):.1f} {max(x)}" for x in found))


def impacts() -> None:
    title("V-cycles a step where spheres meet walls and each other: mean, most; mean of steps with impacts")
    row("spheres", *(f"r {ratio:g}" for ratio in RATIOS))
    for n, steps in ((1, 120), (20, 60)):
        found = []
        for ratio in RATIOS:
            text = spheres(n, ratio, full=True, across=ACROSS[n], xput="iclid=1, strngmob=.5, frcmob=0.,")
            scene, each, hit = Counted(text, default_threads()), [], []
            while len(each) < steps and scene.state.t < scene.world.model.clock.end:
                before = scene.state.impacts
                scene.step()
                each.append(scene.cycles)
                hit.append(scene.state.impacts > before)
            with_impacts = np.mean(np.array(each)[hit]) if any(hit) else 0.0
            found.append(f"{np.mean(each):.1f} {max(each)}; {with_impacts:.0f}")
        row(str(n), *found)


def mass() -> None:
    title("V-cycles of one body's added mass")
    row("", "columns", "V-cycles", "a column")
    for name, text in (("box afloat", box(True)), ("sphere among 20", spheres(20, 0.5, full=False))):
        scene = warm(text)
        wet_bodies, projector = scene.world.wet_bodies, scene.world.liquid.projector
        fluxes = wet_bodies.coupling.fluxes[0]
        scene.cycles = 0
        added_mass(fluxes, projector.respond, projector.q.shape, 1000.0)
        columns = int(fluxes.J.any(axis=0).sum())
        row(name, columns, scene.cycles, f"{scene.cycles / columns:.1f}")


def main(arguments: list[str]) -> None:
    parts = {"fixed": fixed, "surface": surface, "cycles": cycles, "impacts": impacts, "mass": mass}
    for name in arguments or parts:
        parts[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
