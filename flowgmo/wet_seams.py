"""Faces of bodies that lie on something, and the liquid under them.

A contact rests with a gap of 1e-9 of a body's size, or none, by rounding. With none the cells under a brick are closed,
and nothing presses it from below: -70 N where 23.5 hold up a brick of 37.7 N, by its depth. Beds are rough, and water
reaches under what lies on them. So these faces stand back by SEAM of a cell, for the liquid alone (Pose of
favor/near_surface.py): the cells between stay open, and the pressure around reaches them (immersed/narrow_faces.py).

Not in a full domain (itb=0): what rattling bricks shut in there is a space of its own for a step, which has no room to
give, and the run ended with "pulls liquid apart" in one of four starts a hair apart.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flowgmo.bodies.energy import rotation_matrices

if TYPE_CHECKING:
    from flowgmo.wet_bodies import WetBodies

SEAM = 1e-6  # of a cell: far above rounding, and what it takes of a body's volume far below what buoyancy may miss
DOWN = 0.5  # cosine to gravity: faces that lie on something


def faces_set_back(
    bodies: WetBodies, motion: np.ndarray, parts: np.ndarray, values: np.ndarray
) -> list[tuple[bool, ...]]:
    """Of each moving body which faces stand back (Body.faces_towards): of coupled ones those between each other, those
    that lie on something, or are pressed there, by the contacts parts (m, 4) and values (m, 9) of the state. Not those
    that are wedged between two walls: they may be a plug.

    motion (n,) POSE.
    """
    out: list[tuple[bool, ...]] = [()] * len(bodies.movers)
    if not bodies.model.fluid.free_surface:
        return out
    gravity = np.asarray(bodies.model.gravity, dtype=float)
    normal, down = values[:, 3:6], gravity / max(np.linalg.norm(gravity), 1e-300)
    pressed = (values[:, 6:9] * normal).sum(axis=1) > 0.0
    both = np.isin(parts[:, :2], bodies.coupled).all(axis=1)
    for b in bodies.coupled[np.isin(bodies.coupled, parts[:, :2])]:
        k = bodies.place[int(b)]
        if bodies.balls[k] is not None:
            continue
        side = np.where(parts[:, 0] == b, -1.0, np.where(parts[:, 1] == b, 1.0, 0.0))
        outward = side[:, None] * normal
        walls = outward[pressed & ~both]
        wedged = (outward @ walls.T < -DOWN).any(axis=1)
        some = both | (outward @ down > DOWN) | (pressed & ~wedged)
        R = rotation_matrices(motion["q"][b : b + 1])[0]
        out[k] = bodies.liquid.immersed.covers.faces_towards(k, R, outward[some & (side != 0.0)])
    return out
