"""What the waterline adds to the load of bodies: in water at rest they displace what is below its surface."""

import numpy as np
import pytest
from flow_solids import ball, box
from still_water import BLOCK, CENTRES, RHO, G, openings, water

from flowgmo.flow.fields import grid_of
from flowgmo.flow.immersed.body_fluxes import weight_of_displaced
from flowgmo.flow.immersed.waterline import Surface
from flowgmo.flow.observe.body_loads import resting_fluxes


def load(shape, F, level, down=2, sign=-1.0):
    """(3,) force over rho g on a body in water at rest, its surface at `level` along axis `down`, above (sign 1) which
    it lies or below (-1)."""
    moving, gravity = openings(shape), np.zeros(3)
    gravity[down] = sign * G
    surface, middle = Surface(F, gravity, moving.open), np.full(3, 0.5)
    fluxes = resting_fluxes(moving.covers[0], grid_of(BLOCK), CENTRES, middle, surface, middle)
    depth = sign * (CENTRES[down][np.unravel_index(fluxes.cells, F.shape)[down]] - level)
    wet = depth > 0.0
    p = RHO * G * depth * wet
    return (fluxes.J[:, :3].T @ p + weight_of_displaced(fluxes, wet, RHO, gravity)[:3]) / (RHO * G)


def cap(radius, middle, level):
    """Volume of a ball below a level."""
    h = level - middle + radius
    return np.pi * h**2 * (3.0 * radius - h) / 3.0


def test_a_ball_displaces_what_is_below_the_level():
    """Balls of 5 to 10 cells across at any place, the level anywhere in them: to rounding, but for scenes in which the
    solver sees no level in some cell, since a plane leaves nothing open there."""
    rng, errors = np.random.default_rng(11), []
    for _ in range(40):
        radius, middle = rng.uniform(0.16, 0.32), rng.uniform(0.45, 0.55, 3)
        level = middle[2] + rng.uniform(-0.8, 0.8) * radius
        shape = ball(radius, tuple(middle))
        force = load(shape, water(openings(shape), level), level)
        errors.append(abs(force[2] - cap(radius, middle[2], level)) / (4.0 / 3.0 * np.pi * radius**3))
    assert np.sort(errors)[30] <= 1e-13  # of its volume. Measured: 7e-15; 3e-4 by planes
    assert max(errors) <= 1e-5  # 3.6e-6 measured; 1.4e-3 by planes, .011 where cells count whole or not at all


@pytest.mark.parametrize("down", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("kind", ["ball", "box"])
def test_gravity_along_each_axis_and_either_way(kind, down, sign):
    """The same scene told with other axes has the same force, to rounding."""
    middle, level = np.array([0.47, 0.52, 0.51]), 0.4321
    turn = np.array([0.0, 0.0, 35.0])  # about the axis of gravity: a turn that other axes tell alike

    def body(at, axis, way):
        if kind == "ball":
            return ball(0.3, tuple(at))
        return box((0.2, 0.2, 0.2), tuple(at), tuple(np.roll(way * turn, axis - 2)))

    F = water(openings(body(middle, 2, 1.0)), level)
    upright = load(body(middle, 2, 1.0), F, level)
    at, height = middle.copy(), level
    if sign > 0.0:
        at[2], height, F = 1.0 - at[2], 1.0 - height, F[:, :, ::-1]
    order = np.roll(np.arange(3), down - 2)
    force = load(body(at[order], down, 1.0), np.ascontiguousarray(F.transpose(order)), height, down, sign)
    upright[2] *= -sign
    np.testing.assert_allclose(force, upright[order], atol=1e-12)


def test_boxes_displace_what_is_below_the_level():
    """Measured 6e-16 of its volume upright and 3e-16 turned by 20 degrees; upright 2e-5 where walls of planes stand for
    the faces, turned 7e-6 where edges were told by a plane."""
    for angle, most in ((0.0, 1e-12), (20.0, 1e-12)):
        middle, level, half = np.array([0.48, 0.51, 0.497]), 0.5113, 0.27
        shape = box((half,) * 3, tuple(middle), (0.0, angle, 0.0))
        force = load(shape, water(openings(shape), level), level)
        d, c = level - middle[2], np.cos(np.radians(angle))
        below = 4.0 * half**2 * (half + d / c)  # as long as the level meets two opposite sides
        assert force[2] == pytest.approx(below, rel=most)


def test_a_thin_upright_plate_adds_nothing():
    """Its faces say nothing of where it stands in the cell: rounding must not lay it down. .3 of its volume if so."""
    shape = box((0.3, 0.006, 0.3), (0.5, 0.51, 0.5))
    level = 0.4413
    force = load(shape, water(openings(shape), level), level)
    assert force[2] == pytest.approx(0.6 * 0.012 * (level - 0.2), rel=1e-12)
