"""Where a plane cuts bodies: curves that close, run around what is inside, and enclose the area of the cut."""

import numpy as np
import pytest

from flowgmo.geometry.primitives import Ball, Box
from postproc.outlines import curve_of, outlines
from postproc.scene import Surface
from postproc.slices import _beyond, _limits


def surface(points, faces):
    return Surface(1, "body", False, np.asarray(points, float), np.asarray(faces), 0.0)


def joined(*meshes):
    starts = np.cumsum([0, *(len(points) for points, _ in meshes)])
    return surface(
        np.concatenate([p for p, _ in meshes]),
        np.concatenate([f + start for (_, f), start in zip(meshes, starts, strict=False)]),
    )


def area(loop):
    """Enclosed by a curve (n, 2), > 0 counterclockwise."""
    x, y = loop.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def turned(points, seed=3):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return points @ (q * np.sign(np.linalg.det(q))).T


BALL = Ball(1.0).faces(48)
BOX = Box(np.array([-1.0, -0.5, -0.25]), np.array([1.0, 0.5, 0.25])).faces(4)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("at", [-0.9, -0.31, 0.0, 0.5])
def test_a_ball_is_cut_in_a_circle(axis, at):
    # Measured: .3 to .9 % less than pi r^2, the chords of 48 steps around. 3 % would reveal a corner that is left out.
    (loop,) = outlines(surface(*BALL), axis, at)
    assert abs(area(loop)) == pytest.approx(np.pi * (1 - at**2), rel=0.03)
    assert np.allclose(np.linalg.norm(loop, axis=1), np.sqrt(1 - at**2), atol=0.02)


def test_a_plane_beside_a_body_cuts_nothing():
    assert outlines(surface(*BALL), 2, 1.5) == [] and outlines(surface(*BALL), 2, -1.5) == []


@pytest.mark.parametrize("axis", range(3))
def test_a_turned_box_is_cut_exactly(axis):
    """The sum of the cut's areas over many planes is the volume, and all cuts run the same way."""
    body = surface(turned(BOX[0]), BOX[1])
    low, high = body.points[:, axis].min(), body.points[:, axis].max()
    planes = low + (high - low) * (np.arange(2000) + 0.5) / 2000
    areas = [sum(area(loop) for loop in outlines(body, axis, at)) for at in planes]
    # Measured: 1e-6 to 1e-7; the midpoint rule of 2000 planes.
    assert abs(np.mean(areas)) * (high - low) == pytest.approx(1.0, rel=1e-5)
    assert len({np.sign(a) for a in areas}) == 1


def test_a_plane_through_corners_and_faces_gives_closed_curves():
    """A box cut in the plane of its lower face, of its upper one, and through the corners of a ball's equator."""
    assert [abs(area(loop)) for loop in outlines(surface(*BOX), 2, -0.25)] == []
    assert [abs(area(loop)) for loop in outlines(surface(*BOX), 2, 0.25)] == [pytest.approx(2.0)]
    on_corners = BALL[0][np.abs(BALL[0][:, 2]).argmin(), 2]
    (loop,) = outlines(surface(*BALL), 2, float(on_corners))
    assert abs(area(loop)) == pytest.approx(np.pi, rel=0.03)


def test_a_hole_runs_the_other_way_and_overlapping_pieces_the_same():
    inner = (0.5 * BALL[0], BALL[1][:, ::-1])
    outer, hole = sorted((area(loop) for loop in outlines(joined(BALL, inner), 0, 0.1)), key=abs, reverse=True)
    assert outer * hole < 0
    shell = curve_of(outlines(joined(BALL, inner), 0, 0.1))
    assert shell.contains_point((0.7, 0.0)) and shell.to_polygons() and len(shell.to_polygons()) == 2
    beside = (BALL[0] + [1.0, 0.0, 0.0], BALL[1])
    first, second = (area(loop) for loop in outlines(joined(BALL, beside), 2, 0.1))
    assert first * second > 0


def test_faces_that_do_not_close_end_where_they_end():
    points, faces = BALL
    assert len(outlines(surface(points, faces[::3]), 1, 0.2)) > 1


def test_a_few_cells_far_away_do_not_set_the_scale():
    values = np.linspace(0.0, 1.0, 1000)
    assert _limits(values) == (0.0, 1.0) and _beyond(values, (0.0, 1.0)) == "neither"
    values[:3] = -50.0, 80.0, np.nan
    low, high = _limits(values)
    assert -0.1 < low <= 0.02 and 0.9 < high < 1.1
    assert _beyond(values, (low, high)) == "both"
    assert _limits(np.full(5, np.nan)) == (0.0, 1.0) and _limits(np.zeros(4)) == (0.0, 1.0)
