"""Faces that are hardly open: widened for the pressure, passed by what goes with the body as they are."""

import numpy as np
import pytest
from flow_solids import ball, graded_block
from flowgmo_wet_bodies import play, tank

from flowgmo.flow.favor.fractions import open_fractions
from flowgmo.flow.favor.moving_openings import MovingOpenings
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.fields import Open, grid_of
from flowgmo.flow.immersed.narrow_faces import NARROW, NarrowFaces, reach_slits


def _moved(block):
    """The mean openings of a ball's step, and what it touches."""
    still, poses = (
        open_fractions(block, []),
        [Pose(np.eye(3), np.array(t)) for t in ((0.5, 0.5, 0.5), (0.51, 0.5, 0.5))],
    )
    moving = MovingOpenings(block, still, [], [ball(0.2, (0.0, 0.0, 0.0))], poses[:1])
    return moving.mean, moving.sweep(poses[1:])


def test_faces_are_open_by_a_hundredth_and_shares_shrink_as_much():
    """A + S = 1 on each widened face inside the domain."""
    mean, swept = _moved(graded_block(14))
    before = Open(*(a.copy() for a in mean))
    numbers = np.ravel_multi_index(tuple(swept.cells.T.astype(np.int64)), mean.V.shape)
    found = NarrowFaces(mean, numbers)
    mine, seen = found.shares_of(swept.shares[0]), 0
    for d, (A, was) in enumerate(zip(mean[1:], before[1:], strict=True)):
        assert (A[was != A] == NARROW).all()
        at = tuple(mine.cells.T)
        widened = (was != A)[at]
        seen += widened.sum()
        np.testing.assert_allclose(mine.faces[widened, 2 * d + 1], 1.0 - NARROW, atol=1e-12)
    assert seen > 5


def _at_surface(block, beyond):
    """Widened faces along x of a ball's step, all of them with liquid on the lower or upper (beyond) side, and b with
    the surface at theta = .01 to 1.1 of h."""
    mean, swept = _moved(block)
    NarrowFaces(mean, np.ravel_multi_index(tuple(swept.cells.T.astype(np.int64)), mean.V.shape))
    faces, grid = np.flatnonzero(mean.Ax == NARROW), grid_of(block)
    liquid, i = np.unravel_index(faces + beyond * mean.V[0].size, mean.V.shape), np.unravel_index(faces, mean.V.shape)
    wet, b = np.zeros(mean.V.shape, np.int8), np.zeros(mean.V.shape)
    wet[liquid] = 1
    at = np.flatnonzero((wet.reshape(-1)[faces] == 1) != (wet.reshape(-1)[faces + mean.V[0].size] == 1))
    faces, theta = faces[at], np.linspace(0.01, 1.1, len(at))
    j, k = (x[at] for x in i[1:])
    conductance = NARROW * grid.dy[j] * grid.dz[k]
    b.reshape(-1)[faces] = conductance / (theta * grid.hx[i[0][at]])
    slit = 0.5 * grid.dx[liquid[0][at]] / grid.hx[i[0][at]]
    return faces, wet, b, grid, conductance, theta, slit


@pytest.mark.parametrize("beyond", [0, 1])
def test_the_surface_is_no_nearer_than_the_slit(beyond):
    """theta' = max(theta, half the liquid cell); what gravity gives is less by theta / theta'. On a graded mesh."""
    faces, wet, b, grid, conductance, theta, slit = _at_surface(graded_block(14), beyond)
    assert len(faces) > 3
    before, h = b.copy(), conductance / (b.reshape(-1)[faces] * theta)
    opened = np.full(wet.shape, NARROW)
    share = reach_slits(faces, 0, wet, opened, b, grid)
    np.testing.assert_allclose(b.reshape(-1)[faces], conductance / (np.maximum(theta, slit) * h), rtol=1e-13)
    np.testing.assert_allclose(share, np.minimum(theta / slit, 1.0), rtol=1e-13)
    wet[...] = 1  # amid liquid nothing changes
    assert (reach_slits(faces, 0, wet, opened, before, grid) == 1.0).all()
    np.testing.assert_allclose(before.reshape(-1)[faces], conductance / (theta * h), rtol=1e-13)


def test_wider_slits_come_nearer_to_what_they_are():
    """Open by .02, .055, .0999, .2: half a cell times .889, .5, .001, 0 at least, where the surface is at .05 of h."""
    grid = grid_of(graded_block(14))
    wet, A, b = (np.zeros((18,) * 3) for _ in range(3))
    faces = np.ravel_multi_index((np.array([4, 6, 8, 10]), [5] * 4, [5] * 4), wet.shape)
    wet.reshape(-1)[faces] = 1
    A.reshape(-1)[faces] = opened = np.array([0.02, 0.055, 0.0999, 0.2])
    at = np.unravel_index(faces, wet.shape)
    area, width = grid.dy[at[1]] * grid.dz[at[2]], grid.dx[at[0]]
    b.reshape(-1)[faces] = opened * area / (0.05 * width)
    share = reach_slits(faces, 0, wet, A, b, grid)
    theta = np.maximum(0.5 * np.clip((0.1 - opened) / 0.09, 0.0, 1.0), 0.05)
    np.testing.assert_allclose(share, 0.05 / theta, rtol=1e-12)
    np.testing.assert_allclose(b.reshape(-1)[faces], opened * area / (theta * width), rtol=1e-12)


@pytest.mark.parametrize("level", [0.47, 0.505, 0.5317])
def test_water_at_rest_in_slits_stays_so(level):
    """A box that is held 4e-4 from planes of faces, in cells of .0625; the level .02 of a cell above a centre, or
    far from one. Measured 5e-11; .07 m/s with all of gravity."""
    held = "nobs=1,\nobsid(1)='box', imo(1)=3, iob(1)=1, xl(1)=.1254, xh(1)=.6246, yl(1)=.1254, yh(1)=.6246, "
    text = tank(fl=f"flht={level},", obs=held + "zl(1)=.2, zh(1)=.7, utobs(1,1)=0.,")
    world, state = play(text, 6)
    pushed = [b > 0.0 for b in world.liquid.projector.matrix.b]  # above the surface what is left in slits falls
    assert max(float(np.abs(u[at]).max()) for u, at in zip(state.fluid.velocity, pushed, strict=True)) <= 1e-9


def test_a_stream_that_moves_with_a_ball_passes_by_what_is_open():
    """Outflow of every cell with the widened faces, less what is let by, and what carries the liquid through each face:
    those of a uniform stream through the faces as they are, to rounding."""
    block = graded_block(14)
    mean, swept = _moved(block)
    before, grid, U = Open(*(a.copy() for a in mean)), grid_of(block), np.array([1.0, 0.3, -0.2, 0.0, 0.0, 0.0])
    numbers = np.ravel_multi_index(tuple(swept.cells.T.astype(np.int64)), mean.V.shape)
    found = NarrowFaces(mean, numbers)
    assert sum(len(faces) for faces in found.faces) > 10
    centres = [np.zeros(n) for n in mean.V.shape]
    let_by = found.let_by(swept.shares, grid, centres, np.zeros((1, 3)), U[None], [np.zeros(3)])
    velocity = [np.full(mean.V.shape, u) for u in U[:3]]
    found.lean(velocity, 1.0)
    out = np.zeros(len(numbers))
    for d, (A, was, u) in enumerate(zip(mean[1:], before[1:], velocity, strict=True)):
        narrow = was != A
        assert (A[narrow] == NARROW).all()
        np.testing.assert_allclose(A * u, was * U[d], atol=1e-15)
        at, low = tuple(swept.cells.T), list(swept.cells.T)
        low[d] = low[d] - 1
        area = grid[(d + 1) % 3][at[(d + 1) % 3]] * grid[(d + 2) % 3][at[(d + 2) % 3]]
        out += U[d] * area * ((A - was)[at] - (A - was)[tuple(low)])
    assert abs(out).max() > 1e-6
    np.testing.assert_allclose(let_by, out, atol=1e-17)
    found.lean(velocity, -1.0)
    for u, exact in zip(velocity, U[:3], strict=True):
        np.testing.assert_allclose(u, exact, atol=1e-15)
