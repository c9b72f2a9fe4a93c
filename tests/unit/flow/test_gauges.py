"""Probes: interpolation, walls, solids, depth."""

import numpy as np
import pytest
from flowgmo_flows import DOWN, GRAVITY, RHO, at_centres, at_faces, below, block_of, flow_of, openings_of, still

from flowgmo.flow.fields import Open, grid_of
from flowgmo.flow.observe.gauges import find_probe, read_probe

NONE = Open(None, None, None, None)
ROCK = np.array([[0.3, 0.25, 0.0], [0.55, 0.7, 0.4]])


def read(block, flow, point, openings=NONE, gravity=DOWN):
    probe = find_probe(1, np.array(point, dtype=float), block, openings)
    return read_probe(probe, flow, openings, grid_of(block).dz, RHO, gravity)


def linear(x, y, z):
    return 1.0 + 2.0 * x - 3.0 * y + 0.7 * z


def test_linear_fields_are_read_exactly():
    """Each kind on its own lattice, graded, anywhere between the outermost places."""
    block = block_of((7, 6, 8))
    u, v, w = (at_faces(block, d, lambda x, y, z, d=d: (d + 1) * linear(x, y, z)) for d in range(3))
    flow = flow_of(
        block, at_centres(block, lambda x, y, z: 0.2 * x + 0.1 * z + 0.5), at_centres(block, linear), u, v, w
    )
    low, high = (np.array([0.5 * (p[k] + p[k + s]) for p in block.planes]) for k, s in ((0, 1), (-1, -2 + 0)))
    low, high = np.maximum(low, 0.06), np.minimum(high, 0.89)
    for point in np.random.default_rng(1).uniform(low, high, (40, 3)):
        found = read(block, flow, point)
        assert found["p"] == pytest.approx(linear(*point), rel=1e-13)
        assert found["F"] == pytest.approx(0.2 * point[0] + 0.1 * point[2] + 0.5, rel=1e-13)
        assert [found[k] for k in "uvw"] == pytest.approx([(d + 1) * linear(*point) for d in range(3)], rel=1e-13)


@pytest.mark.parametrize("rock", [ROCK, ROCK + [[0.013, 0.02, 0.0], [0.017, -0.011, 0.021]]])
def test_still_water_reads_its_depth_on_and_in_a_solid(rock):
    """On every side of the rock, on its edges, inside it, on the bottom: rho g (surface - z), on and off the mesh."""
    block = block_of((10, 9, 12))
    openings = openings_of(block, [rock])[0]
    flow = still(block, 0.9)
    middle, half = rock.mean(axis=0), np.ptp(rock, axis=0) / 2
    points = [
        middle + half * np.array([a, b, c]) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, -0.5, 0, 0.5, 1)
    ]
    points += [[0.1, 0.1, 0.0], [0.0, 0.5, 0.2], [1.0, 1.0, 0.3]]
    for point in points:
        assert read(block, flow, point, openings)["p"] == pytest.approx(RHO * GRAVITY * (0.9 - point[2]), rel=1e-12)


def test_pressure_is_taken_along_gravity_whatever_its_direction():
    block = block_of((10, 9, 12))
    gravity = np.array([1.0, -2.0, 0.5])
    p = at_centres(block, lambda x, y, z: RHO * (x - 2 * y + 0.5 * z) + 9e3)
    openings = openings_of(block, [ROCK])[0]
    for point in ([0.42, 0.5, 0.2], [0.3, 0.25, 0.1], [0.0, 1.0, 0.0]):
        found = read(block, flow_of(block, p=p), point, openings, gravity)
        assert found["p"] == pytest.approx(RHO * np.dot(gravity, point) + 9e3, rel=1e-12)


def test_air_in_front_of_a_wall_has_no_weight():
    block = block_of((10, 9, 12))
    openings = openings_of(block, [ROCK])[0]
    for point in ([0.42, 0.5, 0.4], [0.42, 0.5, 0.31], [0.3, 0.5, 0.31], [0.0, 0.0, 0.7]):
        found = read(block, still(block, 0.05), point, openings)
        assert found["p"] == 0.0 and found["F"] == 0.0


def test_the_other_side_of_a_thin_wall_is_not_read():
    """A wall of one cell and one thinner than a cell, deep water on one side, none on the other."""
    block = block_of((10, 4, 10), ratio=1.0)
    for lo, hi in ((0.5, 0.6), (0.52, 0.58)):
        wall = np.array([[lo, -1.0, -1.0], [hi, 2.0, 2.0]])
        openings = openings_of(block, [wall])[0]
        if hi - lo < 0.1:  # as the fractions must have it: no way through
            for a in openings[1:2]:
                a[2 + 5] = 0.0
        flow = still(block, 0.8)
        dry = np.arange(14)[:, None, None] > 7
        flow.F[np.broadcast_to(dry, flow.F.shape)] = 0.0
        flow.p[flow.F == 0.0] = 0.0
        assert read(block, flow, [lo, 0.5, 0.3], openings)["p"] == pytest.approx(RHO * GRAVITY * 0.5, rel=1e-12)
        if hi - lo > 0.09:
            assert read(block, flow, [hi, 0.5, 0.3], openings)["p"] == 0.0


def test_velocity_across_a_wall_is_zero_on_it_and_along_it_is_that_beside_it():
    block = block_of((8, 8, 8), ratio=1.0)
    openings = openings_of(block, [np.array([[0.5, -1.0, -1.0], [2.0, 2.0, 2.0]])])[0]
    ones = np.ones((12, 12, 12))
    flow = flow_of(block, u=3 * ones, v=2 * ones, w=ones)
    found = read(block, flow, [0.5, 0.4, 0.4], openings)
    assert (found["u"], found["v"], found["w"]) == (0.0, 2.0, 1.0)
    assert read(block, flow, [0.5 - 0.0625, 0.4, 0.4], openings)["u"] == pytest.approx(1.5)
    assert read(block, flow, [0.7, 0.4, 0.4], openings)["v"] == 2.0, "in the solid: the nearest open cell"


def test_dry_places_have_no_velocity():
    block = block_of((6, 5, 8))
    ones = np.ones((10, 9, 12))
    flow = flow_of(block, below(block, 0.3), None, ones, ones, ones)
    assert read(block, flow, [0.5, 0.5, 0.9])["w"] == 0.0 and read(block, flow, [0.5, 0.5, 0.2])["w"] == 1.0


def test_absent_directions_and_no_surface():
    block = block_of((6, 1, 8))
    found = read(block, flow_of(block), [0.5, 0.5, 0.9])
    assert set(found) == {"p", "u", "w", "F", "height"} and found["F"] == 1.0 and found["height"] == pytest.approx(1.0)


def test_the_mirror_image_reads_the_same():
    """A probe on a plane of symmetry in a solid is as near to either side: it reads their mean."""
    block = block_of((10, 8, 10), ratio=1.0)
    openings = openings_of(block, [np.array([[0.3, 0.2, 0.0], [0.7, 0.8, 0.4]])])[0]
    random = np.random.default_rng(7)
    p, F = random.random((14, 12, 14)), random.random((14, 12, 14))
    u = random.random((14, 12, 14))
    image = np.roll(np.flip(u, 0), -1, 0)
    here = flow_of(block, F, p, u)
    there = flow_of(block, np.flip(F, 0), np.flip(p, 0), -image)
    for point in ([0.5, 0.5, 0.1], [0.3, 0.3, 0.2], [0.5, 0.5, 0.4], [0.41, 0.13, 0.77], [0.5, 0.5, 0.9]):
        a = read(block, here, point, openings)
        b = read(block, there, [1 - point[0], *point[1:]], openings)
        for name in a:
            assert b[name] == pytest.approx(-a[name] if name == "u" else a[name], rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("surface", [0.0, 0.02, 0.4, 0.55, 0.93])
def test_height_of_still_water(surface):
    """In the open, over a rock (its top where dry), beside an upright wall that cuts the cell."""
    block = block_of((10, 9, 12))
    openings = openings_of(block, [ROCK + [[0.0, 0.0, 0.0], [0.012, 0.0, 0.017]]])[0]
    flow = still(block, surface)
    assert read(block, flow, [0.1, 0.1, 0.5])["height"] == pytest.approx(surface, abs=1e-15)
    top = 0.417
    V = openings.V[2:-2, 2:-2, 2:-2]
    for point in ([0.42, 0.5, 0.5], [0.42, 0.5, 0.1], [0.42, 0.5, top]):
        assert V[int(np.searchsorted(block.x, point[0])) - 1, 4, 0] == 0.0
        i, j = (int(np.searchsorted(p, x)) - 1 for p, x in zip(block.planes, point[:2], strict=False))
        cells = np.diff(block.z) * V[i, j]
        full = np.clip((surface - (block.z[1:] - cells)) / np.where(cells > 0, cells, 1), 0, 1)
        flow.F[i + 2, j + 2, 2:-2] = np.where(cells > 0, full, 0.0)
        assert read(block, flow, point, openings)["height"] == pytest.approx(max(surface, top), abs=1e-14)
    wall = openings_of(block, [np.array([[0.97, -1.0, -1.0], [2.0, 2.0, 2.0]])])[0]
    assert 0 < wall.V[-3, 4, 4] < 1
    assert read(block, still(block, surface), [0.96, 0.5, 0.5], wall)["height"] == pytest.approx(surface, abs=1e-14)


def test_height_is_that_of_the_level_of_the_probe():
    """A bridge: water under it is not water on it."""
    block = block_of((5, 5, 10), ratio=1.0)
    openings = openings_of(block, [np.array([[-1, -1, 0.5], [2, 2, 0.6]])])[0]
    flow = still(block, 0.3)
    assert read(block, flow, [0.5, 0.5, 0.1], openings)["height"] == pytest.approx(0.3)
    assert read(block, flow, [0.5, 0.5, 0.8], openings)["height"] == pytest.approx(0.6)


def test_a_point_between_columns_reads_their_mean():
    block = block_of((4, 4, 8), ratio=1.0)
    flow = still(block, 0.5)
    flow.F[4] *= 0.5
    assert read(block, flow, [0.5, 0.4, 0.1])["height"] == pytest.approx(0.375)
    assert read(block, flow, [0.5 + 1e-12, 0.4, 0.1])["height"] == pytest.approx(0.375)
    assert read(block, flow, [0.51, 0.4, 0.1])["height"] == pytest.approx(0.25)
