"""Moments of what bodies displace in water at rest: of where the displaced water is, not of the cells' centres."""

import numpy as np
import pytest
from flow_solids import box, cylinder
from still_water import BLOCK, CENTRES, RHO, G, openings, water

from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import grid_of
from flowgmo.flow.immersed.body_fluxes import weight_of_displaced
from flowgmo.flow.immersed.displaced_places import displaced_places
from flowgmo.flow.immersed.waterline import Surface
from flowgmo.flow.observe.body_loads import resting_fluxes

POINT = np.array([0.5, 0.5, 0.5])


def load(shape, level):
    """(6,) force and moment about POINT over rho g, on a body in water at rest with its surface at `level`."""
    moving, gravity = openings(shape), np.array([0.0, 0.0, -G])
    F = water(moving, level)
    fluxes = resting_fluxes(moving.covers[0], grid_of(BLOCK), CENTRES, POINT, Surface(F, gravity, moving.open))
    depth = level - CENTRES[2][np.unravel_index(fluxes.cells, F.shape)[2]]
    wet = depth > 0.0
    p = RHO * G * depth * wet
    return (fluxes.J.T @ p + weight_of_displaced(fluxes, wet, RHO, gravity)) / (RHO * G)


def of_polygon(corners, level, width, middle):
    """(6,) of a prism along y of this width: corners (n, 2) of its section in x and z, what is below the level."""
    kept = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if a[1] <= level:
            kept.append(a)
        if (a[1] - level) * (b[1] - level) < 0.0:
            kept.append(a + (level - a[1]) / (b[1] - a[1]) * (b - a))
    x, z = np.array(kept).T
    cross = x * np.roll(z, -1) - np.roll(x, -1) * z
    area = 0.5 * cross.sum()
    at = ((x + np.roll(x, -1)) * cross).sum() / (6.0 * area)
    volume = abs(area) * width
    arm = np.array([at, middle]) - POINT[:2]
    return np.array([0.0, 0.0, volume, arm[1] * volume, -arm[0] * volume, 0.0])


@pytest.mark.parametrize("level", [0.47, 0.51, 0.9])
def test_upright_boxes(level):
    """Edges anywhere between planes of the mesh, afloat and under water. Measured: 2e-17 (volumes of .1); with arms to
    the centres of cells 1e-3 of the volume."""
    rng = np.random.default_rng(5)
    for _ in range(6):
        half, middle = rng.uniform(0.15, 0.25, 3), rng.uniform(0.45, 0.55, 3)
        found = load(box(tuple(half), tuple(middle)), level)
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half[[0, 2]] + middle[[0, 2]]
        np.testing.assert_allclose(found, of_polygon(corners, level, 2.0 * half[1], middle[1]), atol=1e-13)


def test_turned_boxes():
    """Edges are no planes: the better one of plane and corner along the mesh. Measured, of volume times width: under
    water 4e-5 in the middle, 3e-4 at most; afloat 1.6e-4 and 2e-3. With arms to the centres 1.0e-3 in the middle under
    water, 1.2e-3 afloat."""
    rng, misses = np.random.default_rng(3), []
    for angle in rng.uniform(-45.0, 45.0, 20):
        half, middle = rng.uniform(0.13, 0.25, 3), rng.uniform(0.46, 0.54, 3)
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half[[0, 2]]
        corners = square @ np.array([[c, -s], [s, c]]) + middle[[0, 2]]
        for level in (middle[2] + 0.03, 0.98):
            found = load(box(tuple(half), tuple(middle), (0.0, angle, 0.0)), level)
            exact = of_polygon(corners, level, 2.0 * half[1], middle[1])
            misses.append(np.abs(found - exact)[3:].max() / (exact[2] * 2.0 * half[0]))
    assert np.median(misses[::2]) <= 4e-4
    assert np.median(misses[1::2]) <= 1e-4


def test_cylinders_under_water():
    """Round walls count as planes. Measured, of volume times width: 3e-5 in the middle, 9e-5 at most; with arms to the
    centres 4.4e-4 at most."""
    rng = np.random.default_rng(4)
    for _ in range(12):
        middle, volume = rng.uniform(0.46, 0.54, 3), np.pi * 0.2**2 * 0.44
        found = load(cylinder(0.2, 0.22, tuple(middle), tuple(rng.uniform(-50.0, 50.0, 3))), 0.98)
        arm = middle - POINT
        exact = volume * np.array([0.0, 0.0, 1.0, arm[1], -arm[0], 0.0])
        assert np.abs(found - exact)[3:].max() <= 2e-4 * volume * 0.4


def test_shares_beyond_the_face():
    """A brick of decks/stones that crosses a face in the step: of one face it covers less than nothing. It was not a
    number, and the run ended. The face above is covered, the one below is not: a slab at the upper end, thinner than
    the cell by what is open."""
    shares, covered = np.array([[0.0, 1.0, 0.015783, 0.015755, 0.015525, -0.0072778]]), np.array([0.015769])
    cells = np.array([[4, 4, 4]], np.int32)
    grid = grid_of(BLOCK)
    found = displaced_places(Shares(cells, shares), covered, None, grid)
    size = grid.dx[4] * grid.dx[4] * grid.dy[4] * grid.dz[4]
    assert np.isfinite(found).all()
    assert abs(found[0, 0] / size - 0.5 * covered[0] * (1.0 - covered[0])) <= 2e-5  # measured: 1.0e-5
