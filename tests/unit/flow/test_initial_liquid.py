"""Liquid at the start: exact for planes with and without solids, regions in order, orders for spheres."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import INNER, HalfSpace, ball, box, cylinder, exact_volume, graded_block, unit_vectors  # noqa: E402

from flowgmo.flow.favor.cut_pairs import cell_volumes  # noqa: E402
from flowgmo.flow.favor.fractions import open_fractions  # noqa: E402
from flowgmo.flow.fields import Open  # noqa: E402
from flowgmo.flow.surface.initial_liquid import Region, initial_liquid, level_of_volume  # noqa: E402
from flowgmo.geometry import Component, Limits, Piece, Quadric, StlMesh  # noqa: E402
from flowgmo.geometry.transform import rotation  # noqa: E402
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


def limits(lo, hi):
    return Component([Piece(limits=Limits(*zip(lo, hi, strict=True)))])


def shares(planes, a, b):
    return np.clip((np.minimum(planes[1:], b) - np.maximum(planes[:-1], a)) / np.diff(planes), 0.0, 1.0)


def filled(block, lo, hi):
    """Exact F of a box along the mesh."""
    return np.einsum("i,j,k->ijk", *(shares(p, a, b) for p, a, b in zip(block.planes, lo, hi, strict=True)))


def test_boxes_along_the_mesh_are_exact_in_every_cell():
    """Faces on mesh planes, on walls, in between; overlapping, meeting, touching at an edge and at a corner, a hole.

    Measured 2e-16; by the distance of the box alone its edge cells held .9375 and .854 in place of 1.
    """
    block = graded_block(10, LENGTHS)
    x, y, z = block.planes
    whole = (np.array([x[2], y[3], z[0]]), np.array([x[5], y[8], z[4]]))
    cases = {
        "meets": (np.array([x[5], y[3], z[0]]), np.array([0.83, y[8], z[4]])),
        "touches at an edge": (np.array([x[5], y[8], z[0]]), np.array([x[7], LENGTHS[1], z[4]])),
        "touches at a corner": (np.array([x[5], y[8], z[4]]), np.array([x[10], y[11], z[9]])),
        "meets in a cell": (np.array([x[2], y[3], 0.513]), np.array([x[5], y[8], 0.777])),
    }
    for lo, hi in cases.values():
        first = (whole[0], np.append(whole[1][:2], 0.513)) if lo[2] == 0.513 else whole
        F = initial_liquid(block, NOTHING, regions=[Region(limits(*first)), Region(limits(lo, hi))])[INNER]
        exact = filled(block, *first) + filled(block, lo, hi)
        np.testing.assert_allclose(F, exact, atol=1e-13)
        assert (F[exact == 1.0] == 1.0).all()
        assert (F[exact == 0.0] == 0.0).all()
    over = (np.array([0.31, 0.5, 0.1]), np.array([0.9, 1.1, 0.4]))
    both = (np.maximum(whole[0], over[0]), np.minimum(whole[1], over[1]))
    F = initial_liquid(block, NOTHING, regions=[Region(limits(*whole)), Region(limits(*over))])[INNER]
    np.testing.assert_allclose(F, filled(block, *whole) + filled(block, *over) - filled(block, *both), atol=1e-13)
    F = initial_liquid(block, NOTHING, regions=[Region(limits(*whole)), Region(limits(*over), False)])[INNER]
    np.testing.assert_allclose(F, filled(block, *whole) - filled(block, *both), atol=1e-13)


def test_liquid_that_fits_between_solids():
    """Liquid whose faces lie on those of solids, on mesh planes and oblique: all that is open between them is full."""
    block = graded_block(9, LENGTHS)
    x, y, z = block.planes
    step = limits((x[0], y[0], z[0]), (x[4], y[10], z[3]))
    region = Region(limits((x[4], y[0], z[0]), (x[9], y[10], z[3])))
    open_ = open_fractions(block, [step]).open
    F = initial_liquid(block, open_, [step], regions=[region])[INNER]
    assert (F[4:, :, :3] == 1.0).all()
    assert F[:, :, 3:].max() == F[:4].max() == 0.0
    n = unit_vectors(np.random.default_rng(2), 1)[0]
    h = n @ [0.5, 0.6, 0.4]
    slope, rest = HalfSpace(n, h), Region(HalfSpace(-n, -h))
    open_ = open_fractions(block, [slope]).open
    F = initial_liquid(block, open_, [slope], regions=[rest])
    assert (F[open_.V > 0.0] == 1.0).all()


def hull_volume(*boxes):
    n, h = (np.concatenate([getattr(b.sheets, name) for b in boxes]) for name in "nh")
    return exact_volume(n, h, (0, 0, 0), LENGTHS)


def test_unions_of_oblique_boxes_are_exact():
    """Boxes in any directions, one beside the other, across each other, with a hole, around a solid, from triangles.

    Against hulls of scipy: measured 2e-15. Edges cut off by chords missed up to .1 of a cell along the seam.
    """
    block = graded_block(12, LENGTHS)
    turn = (20, 30, 40)
    one = box((0.2, 0.2, 0.15), (0.4, 0.6, 0.4), turn)
    beside = box((0.1, 0.2, 0.15), np.array([0.4, 0.6, 0.4]) + rotation(turn) @ [0.3, 0, 0], turn)
    across = box((0.15, 0.25, 0.2), (0.55, 0.7, 0.45), (-10, 50, 70))
    solid = HalfSpace([0.2, -0.3, 1.0], 0.2)
    a, b, both = hull_volume(one), hull_volume(across), hull_volume(one, across)
    mesh = Component([Piece(stl=StlMesh(*one.triangles()))])
    for regions, exact in (
        ([Region(one), Region(beside)], a + hull_volume(beside)),
        ([Region(one), Region(across)], a + b - both),
        ([Region(one), Region(across, False)], a - both),
        ([Region(one), Region(across, True, 0.25)], a - both + 0.25 * b),
        ([Region(mesh), Region(across)], a + b - both),
    ):
        F = initial_liquid(block, NOTHING, regions=regions)
        assert volume_of(block, F) == pytest.approx(exact, rel=1e-12)
        assert ((F >= 0.0) & (F <= 1.0)).all()
    open_ = open_fractions(block, [solid], least=0.0, lone=0.0).open
    F = initial_liquid(block, open_, [solid], regions=[Region(one)])
    n, h = np.append(one.sheets.n, [-solid.n], axis=0), np.append(one.sheets.h, -solid.h)
    assert volume_of(block, F, open_) == pytest.approx(exact_volume(n, h, (0, 0, 0), LENGTHS), rel=1e-12)


def test_two_curved_regions_that_meet_leave_no_gap():
    """z = a parabola on either side of a mesh plane, and of one within a cell: as one region, 2e-10 of a cell.

    What the decks of a standing wave do; the cells at the joint lost .1 of a cell before.
    """
    block = Block(np.linspace(0, 1, 11), np.linspace(0, 0.05, 2), np.linspace(0, 1, 21), graded_block(4).neighbours)
    for joint in (0.5, 0.537):
        parts = [
            Component([Piece(limits=Limits(x=ends), quadric=Quadric(c=-0.52, cz=1.0, cx2=0.04))])
            for ends in ((None, joint), (joint, None))
        ]
        F = initial_liquid(block, NOTHING, regions=[Region(part) for part in parts])
        edges = block.x
        exact = 0.52 - 0.04 * np.diff(edges**3) / 3 / np.diff(edges)
        np.testing.assert_allclose((F[INNER] * np.diff(block.z)).sum((1, 2)), exact, atol=2e-6 * 0.05)


def test_orders_of_curved_regions():
    """Error of the volume at 10, 20, 40 cells; bounds at 40. The sphere of triangles is told from its own volume: exact
    where a cell holds up to five of them.

    Measured: cylinder, oblique, with its ends 2e-5, 4e-7, 1e-7; along the mesh 5e-4, 1.2e-4, 5e-5; the sphere of 528
    triangles 5e-4, 2e-5, 1e-6.
    """
    vertices, faces = ball(0.25, (0.5, 0.52, 0.49)).triangles(24)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    shapes = {
        "oblique": (cylinder(0.2, 0.25, (0.5, 0.5, 0.5), (20, 30, 40)), np.pi * 0.04 * 0.5, 2e-5),
        "upright": (cylinder(0.2, 0.31, (0.5, 0.5, 0.5)), np.pi * 0.04 * 0.62, 1e-4),
        "mesh": (Component([Piece(stl=StlMesh(vertices, faces))]), (a * np.cross(b, c)).sum() / 6, 3e-6),
    }
    for shape, volume, bound in shapes.values():
        F = initial_liquid(graded_block(40), NOTHING, regions=[Region(shape)])
        assert abs(volume_of(graded_block(40), F) / volume - 1) < bound
        assert ((F >= 0.0) & (F <= 1.0)).all()


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
