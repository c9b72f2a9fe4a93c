"""How much water a held body displaces, and what the pressure of the cells' centres alone would say.

    python decks/buoyancy/held.py

A box or a sphere, upright or turned by 20 degrees about y, 10 or 20 cells across, is held in water at rest at twenty
places within a cell. It is coupled along x only, so that a step knows its load; along z it is prescribed not to move.
No deck can ask for twenty places: the scene is built from a deck's text for each of them, and one step made.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.state import initial_state
from flowgmo.step import prepare, start_liquid, step

RHO, G, LEVEL, CELL = 1000.0, 9.81, 1.0, 0.05
SCENE = """A body held in water
 &xput twfin=1., delt=1e-3, itb=1, ipdis=1, gz=-{g}, imobs=1, /
 &limits /
 &props rhof={rho}, /
 &bcdata ibct=2,2,2,2,2,2, /
 &mesh px=0.,{wide}, py=0.,{wide}, pz=0.,{high}, nxcelt={n}, nycelt={n}, nzcelt={m}, /
 &obs nobs=1, obsid(1)='body', imo(1)=4, rhomvb(1)=1e7, iob(1)=1, {shape}
  trnx(1)={x}, trny(1)={y}, trnz(1)={z}, ivmcal(1)=0, iwmcal(1)=0, iomxcal(1)=0, iomycal(1)=0, iomzcal(1)=0, /
 &fl flht={level}, /
"""


def box_below(half: float, turn: float, depth: float) -> float:
    """Volume [length^3] below the surface of a cube of edge 2 half, turned by `turn` [rad], its centre at -depth."""
    c, s = np.cos(turn), np.sin(turn)
    corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ np.array([[c, s], [-s, c]])
    corners[:, 1] -= depth
    below = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if a[1] <= 0.0:
            below.append(a)
        if (a[1] <= 0.0) != (b[1] <= 0.0):
            below.append(a + (b - a) * a[1] / (a[1] - b[1]))
    if not below:
        return 0.0
    x, z = np.array(below).T
    return 2.0 * half * 0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1))


def sphere_below(radius: float, depth: float) -> float:
    """Volume [length^3] below the surface of a sphere whose centre is at -depth."""
    h = np.clip(radius + depth, 0.0, 2.0 * radius)
    return np.pi * h**2 * (3.0 * radius - h) / 3.0


def lift(shape: str, turned: bool, across: int, depth: float, offset: np.ndarray) -> tuple[float, float, float]:
    """Buoyancy over rho g (volume under water): in a step, and of the pressure of the cells alone; side force likewise.

    depth of the centre in diameters; offset (3,) in cells.
    """
    half = 0.5 * CELL * across
    n, m = across + 8, 2 * across + 12
    high, level = m * CELL, (across + 4 + max(0.0, depth) * across) * CELL
    x, y, z = 0.5 * n * CELL + offset[0] * CELL, 0.5 * n * CELL + offset[1] * CELL, level - 2.0 * depth * half
    shift = offset[2] * CELL
    form = f"rsh(1)={half}," if shape == "sphere" else ", ".join(
        f"{a}l(1)={-half}, {a}h(1)={half}" for a in "xyz"
    ) + ","  # fmt: skip
    text = SCENE.format(
        g=G, rho=RHO, wide=n * CELL, high=high, n=n, m=m, shape=form + (" roty(1)=20.," if turned else ""),
        x=x, y=y, z=z + shift, level=level + shift,
    )  # fmt: skip
    model = build_model(parse_deck(text, Path("held.nml")))
    world, state = prepare(model), initial_state(model)
    start_liquid(world, state)
    step(world, state, 1e-3, np.zeros(0), landing=False)
    wet = world.wet_bodies
    cells = (RHO / 1e-3) * wet.coupling.loads(world.liquid.projector.q)[:3]
    volume = (
        sphere_below(half, 2.0 * depth * half)
        if shape == "sphere"
        else box_below(half, np.radians(20.0 * turned), 2.0 * depth * half)
    )
    weight = RHO * G * volume
    total = cells + wet.lifts[0, :3]
    return total[2] / weight, cells[2] / weight, float(np.abs(total[:2]).max()) / weight


def places(count: int = 20) -> np.ndarray:
    """(count, 3) offsets in cells."""
    return np.random.default_rng(7).uniform(0.0, 1.0, (count, 3))


def main() -> None:
    """Print the largest errors over twenty places."""
    for shape in ("box", "sphere"):
        for turned in (False, True) if shape == "box" else (False,):
            for depth in (0.0, 0.2, 1.0):
                for across in (10, 20):
                    found = np.array([lift(shape, turned, across, depth, at) for at in places()])
                    off = np.abs(found[:, :2] - 1.0).max(axis=0)
                    print(
                        f"{shape:6} {'turned' if turned else '      '} depth {depth:3} D, {across} cells across: "
                        f"error {off[0]:.1e}, of the cells alone {off[1]:.1e}, side force {found[:, 2].max():.1e}",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
