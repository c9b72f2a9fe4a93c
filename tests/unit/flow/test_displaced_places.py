"""Moments of what bodies displace in water at rest: of where the displaced water is, not of the cells' centres."""

import numpy as np
import pytest
from flow_solids import box, cylinder
from still_water import BLOCK, CENTRES, RHO, G, openings, water

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import grid_of
from flowgmo.flow.immersed.body_fluxes import body_fluxes, weight_of_displaced
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


def test_turned_boxes_afloat():
    """What the level leaves of edges is cut too. Measured, of volume times width: 2e-16 in the middle, 2e-3 at most
    (cells in which a plane leaves nothing open on one side of the level); arms to the centres 1.2e-3 in the middle."""
    rng, misses = np.random.default_rng(3), []
    for angle in rng.uniform(-45.0, 45.0, 20):
        half, middle = rng.uniform(0.13, 0.25, 3), rng.uniform(0.46, 0.54, 3)
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half[[0, 2]]
        corners = square @ np.array([[c, -s], [s, c]]) + middle[[0, 2]]
        level = middle[2] + 0.03
        found = load(box(tuple(half), tuple(middle), (0.0, angle, 0.0)), level)
        exact = of_polygon(corners, level, 2.0 * half[1], middle[1])
        misses.append(np.abs(found - exact)[3:].max() / (exact[2] * 2.0 * half[0]))
    assert np.median(misses) <= 1e-12


@pytest.mark.parametrize("least", [0.02, 0.13])
def test_turned_boxes_under_water(least):
    """In any pose, thinner than a cell too: exact where at most five planes cut a cell. Measured, of volume: 2e-15;
    of volume times width 3e-5 in the middle by the shares of faces, 1e-3 with arms to the centres."""
    rng = np.random.default_rng(8)
    for _ in range(20):
        half, middle = rng.uniform(least, 0.25, 3), rng.uniform(0.46, 0.54, 3)
        volume, arm = 8.0 * half.prod(), middle - POINT
        found = load(box(tuple(half), tuple(middle), tuple(rng.uniform(-180.0, 180.0, 3))), 0.98)
        exact = volume * np.array([0.0, 0.0, 1.0, arm[1], -arm[0], 0.0])
        assert np.abs(found - exact)[3:].max() <= 1e-12 * volume


def test_places_in_cells():
    """Cell by cell against 27 000 points of each: those count 3e-4 of its size wrong at most (measured: .8 of it)."""
    rng, points = np.random.default_rng(21), (np.indices((30, 30, 30)).reshape(3, -1).T + 0.5) / 30.0
    for _ in range(3):
        shape = box(
            tuple(rng.uniform(0.1, 0.25, 3)), tuple(rng.uniform(0.46, 0.54, 3)), tuple(rng.uniform(-180, 180, 3))
        )
        cover = openings(shape).covers[0]
        fluxes = resting_fluxes(cover, grid_of(BLOCK), CENTRES, POINT)
        for n in rng.choice(np.flatnonzero((cover.shares[:, 6] > 0.01) & (cover.shares[:, 6] < 0.99)), 40):
            low = np.array([x[k] for x, k in zip(CENTRES, np.unravel_index(fluxes.cells[n], (20,) * 3), strict=True)])
            inside = shape.distance(low + (points - 0.5) / 16.0) < 0.0
            found = fluxes.places[n] * 16.0**4
            assert np.abs(found - ((points - 0.5) * inside[:, None]).mean(axis=0)).max() <= 3e-4


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


def test_a_slab_in_one_cell():
    """By the shares of faces alone, of a body that is no convex one: the place of a slab is half of what is open from
    the middle. A cell that it shares with another body counts by its part; one that it does not touch now does not."""
    shares, covered = np.array([[0.0, 1.0, 0.4, 0.4, 0.4, 0.4, 0.4]]), np.array([0.2, 0.3])
    cells = np.array([[4, 4, 4], [4, 4, 5]], np.int32)
    numbers = np.ravel_multi_index(tuple(cells.T), (20,) * 3)
    cover = BodyCover(numbers[:1], shares, np.zeros((0, 2), np.int64), 0.0)
    found = displaced_places(cells, numbers, covered, cover, None, grid_of(BLOCK), CENTRES) * 16.0**4
    np.testing.assert_allclose(found, [[0.2 * 0.5 * 0.6, 0.0, 0.0], [0.0, 0.0, 0.0]], atol=1e-15)


def test_a_face_in_a_plane_of_the_mesh():
    """Rounding says how long in a step it covers the faces there: 0, 1/6, 5/6 or all of it. The place of what is
    displaced is what it is. With the step's mean shares an edge of the box was 2e-2 of a cell elsewhere."""
    cover = openings(box((0.125, 0.11, 0.17), (0.5, 0.51, 0.53))).covers[0]
    cells = np.column_stack(np.unravel_index(cover.numbers, (20,) * 3)).astype(np.int32)
    of = cover.shares[:, 6], grid_of(BLOCK), CENTRES, POINT, None, None, cover
    exact = body_fluxes(Shares(cells, cover.shares[:, :6]), *of).places
    for part in (0.0, 1.0 / 6.0, 5.0 / 6.0):
        mean = cover.shares[:, :6].copy()
        mean[cells[:, 0] == 8, 0] *= part  # cells 6 .. 9 are covered, behind the two of the ghosts
        mean[cells[:, 0] == 7, 1] *= part
        np.testing.assert_array_equal(body_fluxes(Shares(cells, mean), *of).places, exact)
