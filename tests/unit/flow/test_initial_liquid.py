"""Liquid at the start: exact for planes with and without solids, regions in order, orders for spheres."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import INNER, HalfSpace, ball, box, exact_volume, graded_block, unit_vectors  # noqa: E402

from flowgmo.flow.cut_pairs import cell_volumes  # noqa: E402
from flowgmo.flow.fields import Open  # noqa: E402
from flowgmo.flow.fractions import open_fractions  # noqa: E402
from flowgmo.flow.initial_liquid import Region, initial_liquid, level_of_volume  # noqa: E402
from flowgmo.mesh import Block  # noqa: E402

NOTHING = Open(None, None, None, None)
LENGTHS = (1.0, 1.3, 0.8)


def volume_of(block, F, open_=NOTHING):
    room = 1.0 if open_.V is None else open_.V[INNER]
    return float((F[INNER] * room * cell_volumes(block)).sum())


def test_height_in_a_box_with_an_oblique_solid_is_exact():
    """FLHT and one or two half-spaces of solid in any direction, on a graded mesh: measured 4e-16 of the volume."""
    rng = np.random.default_rng(0)
    block = graded_block(9, LENGTHS)
    for count in (1, 1, 1, 2, 2):
        n = unit_vectors(rng, count)
        h = n @ [0.5, 0.6, 0.4] - 0.15
        solids = [HalfSpace(a, b) for a, b in zip(n, h, strict=True)]
        fractions = open_fractions(block, solids, least=0.0, lone=0.0).open
        F = initial_liquid(block, fractions, solids, height=0.437)
        exact = exact_volume([*-n, [0, 0, 1.0]], [*-h, 0.437], (0, 0, 0), LENGTHS)
        assert volume_of(block, F, fractions) == pytest.approx(exact, rel=1e-12)
        assert ((F >= 0.0) & (F <= 1.0)).all()
        assert (F[fractions.V == 0.0] == 0.0).all()


def test_height_without_solids():
    """Full below, empty above, the cut layer to its share; on a mesh plane exactly 0 and 1."""
    block = graded_block(8, LENGTHS)
    F = initial_liquid(block, NOTHING, height=0.3)
    k = np.searchsorted(block.z, 0.3) - 1
    assert (F[..., 2 : 2 + k] == 1.0).all()
    assert (F[..., 3 + k : -2] == 0.0).all()
    np.testing.assert_allclose(F[..., 2 + k], (0.3 - block.z[k]) / (block.z[k + 1] - block.z[k]), rtol=1e-13)
    assert set(np.unique(initial_liquid(block, NOTHING, height=block.z[4]))) == {0.0, 1.0}
    assert (initial_liquid(block, NOTHING, height=9.0) == 1.0).all()
    assert (initial_liquid(block, NOTHING, height=-9.0) == 0.0).all()


@pytest.mark.parametrize("gravity", [(0, 0, -9.81), (0, 3, 0), (1, 2, -9), (-4, -5, 6), (1e-9, 0, -9.81)])
def test_volume_with_a_level_surface(gravity):
    """VLIN: the volume to 1e-13 of itself, and the plane is where the dual hull of scipy has that volume: 4e-13."""
    block = graded_block(8, LENGTHS)
    n = np.array([0.3, 0.2, 0.933])
    n /= np.linalg.norm(n)
    solid = HalfSpace(n, 0.3)
    fractions = open_fractions(block, [solid], least=0.0, lone=0.0).open
    up = -np.array(gravity) / np.linalg.norm(gravity)
    for open_, solids, wanted in ((NOTHING, [], 0.37), (fractions, [solid], 0.21), (fractions, [solid], 1e-4)):
        F = initial_liquid(block, open_, solids, volume=wanted, gravity=gravity)
        assert volume_of(block, F, open_) == pytest.approx(wanted, rel=1e-13)
        height = level_of_volume(block, open_, solids, wanted, up).height
        planes, offsets = ([up], [height]) if open_ is NOTHING else ([up, -n], [height, -0.3])
        assert exact_volume(planes, offsets, (0, 0, 0), LENGTHS) == pytest.approx(wanted, rel=1e-9)


def test_volume_around_a_curved_solid():
    """A ball across the surface: the liquid of the mesh is what was asked for, whatever the ball's own error."""
    block = graded_block(14)
    solids = [ball(0.3, (0.5, 0.5, 0.5))]
    fractions = open_fractions(block, solids).open
    for wanted in (0.05, 0.4, 0.6):
        F = initial_liquid(block, fractions, solids, volume=wanted, gravity=(0.1, 0, -1))
        assert volume_of(block, F, fractions) == pytest.approx(wanted, rel=1e-12)


def test_volumes_of_nothing_of_everything_and_of_too_much():
    block = graded_block(6)
    assert (initial_liquid(block, NOTHING, volume=0.0) == 0.0).all()
    assert (initial_liquid(block, NOTHING, volume=1.0) == 1.0).all()
    with pytest.raises(ValueError, match="does not fit"):
        initial_liquid(block, NOTHING, volume=1.01)


def test_a_sphere_of_liquid():
    """Error of its volume: measured 8.5e-5 at 10 cells across, 8e-6 at 20, 4e-7 at 40; order 3.4 and 4.4."""
    errors = []
    for n in (20, 40):
        block = graded_block(n, grade=0.0)
        F = initial_liquid(block, NOTHING, regions=[Region(ball(0.25, (0.5, 0.52, 0.49)))])
        errors.append(abs(volume_of(block, F) / (4 / 3 * np.pi * 0.25**3) - 1))
    assert errors[0] < 1e-4
    assert errors[1] < 1e-5


def test_regions_act_in_their_order():
    """Planes only, so exact: add, hole, add again half full; the last that contains a point decides."""
    block = graded_block(9)
    big, hole, small = (
        box((0.3, 0.3, 0.3), (0.5, 0.5, 0.5)),
        HalfSpace([0.2, 0.3, 1], 0.4),
        HalfSpace([1, 0.1, 0], 0.45),
    )
    exact_low = exact_volume([hole.n, small.n], [hole.h, small.h])
    only_hole = exact_volume([hole.n], [hole.h])
    F = initial_liquid(block, NOTHING, regions=[Region(HalfSpace([0, 0, 1], 9.0)), Region(hole, False)])
    assert volume_of(block, F) == pytest.approx(1 - only_hole, rel=1e-13)
    F = initial_liquid(
        block, NOTHING, regions=[Region(HalfSpace([0, 0, 1], 9.0)), Region(hole, False), Region(small, True, 0.5)]
    )
    by_small = exact_volume([small.n], [small.h])
    assert volume_of(block, F) == pytest.approx(1 - only_hole - by_small + exact_low + 0.5 * by_small, rel=1e-13)
    F = initial_liquid(block, NOTHING, height=0.37, regions=[Region(small, False)])
    exact = exact_volume([[0, 0, 1.0], -small.n], [0.37, -small.h])
    assert volume_of(block, F) == pytest.approx(exact, rel=1e-13)
    F = initial_liquid(block, NOTHING, regions=[Region(big), Region(big, False)])
    assert volume_of(block, F) == 0.0


def test_two_regions_that_overlap_count_once():
    """The union of two half-spaces that both contain a cell's seam leaves no gap there."""
    block = graded_block(9)
    n = unit_vectors(np.random.default_rng(5), 1)[0]
    h = n @ [0.5, 0.5, 0.5]
    F = initial_liquid(block, NOTHING, regions=[Region(HalfSpace(n, h)), Region(HalfSpace(-n, -h))])
    np.testing.assert_allclose(F, 1.0, atol=1e-14)


def test_scaled_and_mirrored():
    """Length times 1024: the same bits. x mirrored: the same to round-off."""
    block = graded_block(10)
    solids, region = [ball(0.2, (0.4, 0.5, 0.45))], [Region(ball(0.15, (0.7, 0.6, 0.7)))]
    fractions = open_fractions(block, solids).open
    F = initial_liquid(block, fractions, solids, region, volume=0.3, gravity=(0.1, 0.2, -1))
    large = Block(*(1024 * p for p in block.planes), block.neighbours)
    big_solids = [ball(0.2 * 1024, 1024 * np.array([0.4, 0.5, 0.45]))]
    big_region = [Region(ball(0.15 * 1024, 1024 * np.array([0.7, 0.6, 0.7])))]
    again = initial_liquid(
        large,
        open_fractions(large, big_solids).open,
        big_solids,
        big_region,
        volume=0.3 * 2.0**30,
        gravity=(0.1, 0.2, -1),
    )
    np.testing.assert_array_equal(again, F)
    mirror = Block(1.0 - block.x[::-1], block.y, block.z, block.neighbours)
    solids, region = [ball(0.2, (0.6, 0.5, 0.45))], [Region(ball(0.15, (0.3, 0.6, 0.7)))]
    again = initial_liquid(
        mirror, open_fractions(mirror, solids).open, solids, region, volume=0.3, gravity=(-0.1, 0.2, -1)
    )
    np.testing.assert_allclose(again[::-1], F, atol=1e-11)
