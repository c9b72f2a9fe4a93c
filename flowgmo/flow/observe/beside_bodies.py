"""Liquid beside bodies that move: what their walls give to the kinetic energy and momentum of cells that they cut.

    kinetic    rho / 2 sum of F V volume 1/2 S_b s u_d^2         over the closed faces of cells, for each direction d
    momentum   rho     sum of F V volume 1/2 S_b s u_d           s = u of the opposite face / u_d, within 0 .. 1

u_d is the component of n (n . (v + w x r)), what the wall of body b pushes in the cell as it is now, S_b its share of
the face: along its walls the liquid slips, and the spin of a ball moves nothing (body_fluxes.py). In measures.py the
velocity of a cell is the mean of its two faces, and a closed one is at rest. But liquid between a piston and the next
face moves with the piston: else half of that cell's energy would go, and come back when the piston passes a plane of
faces (.03 of all there is, each time). It does as far as s says: a plate that has come down on water, or one that was
hit, has a velocity which the liquid under it does not yet have. What the faces themselves hold of the body's velocity
is that of the step before.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.fields import Flow, Grid, Open
from flowgmo.flow.observe.body_loads import resting_fluxes


def beside_body(
    cover: BodyCover,
    flow: Flow,
    opened: Open,
    grid: Grid,
    centres: list[np.ndarray],
    place: np.ndarray,
    U: np.ndarray,
    middle: np.ndarray | None = None,
) -> tuple[float, np.ndarray]:
    """Kinetic energy / rho [length5/time2] and momentum / rho (3,) [length4/time] beside one body.

    opened: what all bodies leave open now; centres: of cells, (n + 4,) for each direction; place (3,): B; U (6,):
    velocity of B and spin; middle: of balls and bodies of revolution, as in body_fluxes.
    """
    at = np.unravel_index(cover.numbers, flow.p.shape)
    part = np.prod([d[k] for d, k in zip(grid[:3], at, strict=True)], axis=0) * opened.V[at]
    if flow.F is not None:
        part = part * flow.F[at].clip(0.0)
    own = resting_fluxes(cover, grid, centres, place, None, middle)
    a = own.J[:, :3]
    size = (a * a).sum(axis=1)
    pushed = a * np.divide(own.J @ U, size, out=np.zeros(len(a)), where=size > 0.0)[:, None]
    kinetic, momentum = 0.0, np.zeros(3)
    for d, u in enumerate(flow.velocity):
        if u is None:
            continue
        speed = pushed[:, d]
        for upper in (0, 1):
            face = tuple(k - (1 - upper if axis == d else 0) for axis, k in enumerate(at))
            share = np.where(opened[1 + d][face] > 0.0, 0.0, cover.shares[:, 2 * d + upper].clip(0.0, 1.0))
            other = tuple(k - (upper if axis == d else 0) for axis, k in enumerate(at))
            through = np.where(opened[1 + d][other] > 0.0, u[other], 0.0)
            along = np.where(through * speed > 0.0, np.minimum(np.abs(through), np.abs(speed)), 0.0)
            kinetic += 0.25 * float((part * share * along * np.abs(speed)).sum())
            momentum[d] += 0.5 * float((part * share * along * np.sign(speed)).sum())
    return kinetic, momentum


def beside_bodies(
    covers: list[BodyCover],
    flow: Flow,
    opened: Open,
    grid: Grid,
    centres: list[np.ndarray],
    places: np.ndarray,
    velocities: np.ndarray,
    middles: list[np.ndarray | None],
) -> tuple[float, np.ndarray]:
    """The same of all of them: places (b, 3), velocities (b, 6), middles of each."""
    kinetic, momentum = 0.0, np.zeros(3)
    for cover, place, U, middle in zip(covers, places, velocities, middles, strict=True):
        own, gained = beside_body(cover, flow, opened, grid, centres, place, U, middle)
        kinetic, momentum = kinetic + own, momentum + gained
    return kinetic, momentum
