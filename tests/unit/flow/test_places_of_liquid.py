"""First moments of the liquid in cells, and the potential energy that they make."""

import numpy as np
import pytest
from flowgmo_flows import DOWN, GRAVITY, RHO, block_of, flow_of, openings_of, with_ghosts

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import G, Open, grid_of
from flowgmo.flow.observe.measures import total
from flowgmo.flow.observe.places_of_liquid import moment_in_cut_cell, moment_under
from flowgmo.flow.surface.plic import plane_offset, volume_under
from flowgmo.flow.team import Team
from flowgmo.kernel import kernel


@kernel
def moments(m, alpha, out):
    for n in range(len(m)):
        for d in range(3):
            out[n, d] = moment_under((m[n, 0], m[n, 1], m[n, 2]), alpha[n], d)


@kernel
def volumes(m, alpha, out):
    for n in range(len(m)):
        out[n] = volume_under((m[n, 0], m[n, 1], m[n, 2]), alpha[n])


@kernel
def offsets(m, F, out):
    for n in range(len(m)):
        out[n] = plane_offset((m[n, 0], m[n, 1], m[n, 2]), F[n])


@kernel
def in_cut_cell(opened, i, j, k, d, F, up):
    return moment_in_cut_cell(opened, i, j, k, d, F, up)


def of_planes(m, alpha):
    """Volumes (n,) and moments (n, 3) of the unit cube under planes."""
    out, V = np.empty((len(m), 3)), np.empty(len(m))
    moments(m, alpha, out)
    volumes(m, alpha, V)
    return V, out


def planes(count=400, seed=1):
    """Oblique ones of all signs, along axes and edges, all but along them, and nearly empty or full."""
    random = np.random.default_rng(seed)
    m = random.normal(size=(count, 3))
    m[::4, random.integers(3)] = 0.0
    m[1::4] *= 10.0 ** random.uniform(-13, 0, (len(m[1::4]), 3))
    m[2::40] = [0.0, 0.0, -3.0]
    F = random.uniform(size=count)
    F[::5] = 10.0 ** random.uniform(-9, -1, len(F[::5]))
    F[1::5] = 1.0 - F[::5]
    alpha = np.empty(count)
    offsets(m, F, alpha)
    return m, alpha, F


def test_moments_add_up_over_the_parts_of_a_cell():
    """Eight boxes of unequal size have together what the whole has: measured 4e-16. With their centres' places the
    sums converge to the moments, so that these are what they are called."""
    m, alpha, F = planes()
    whole = of_planes(m, alpha)[1]
    ends, total = [0.0, 0.31, 1.0], np.zeros_like(whole)
    for corner in np.ndindex(2, 2, 2):
        low = np.array([ends[c] for c in corner])
        size = np.array([ends[c + 1] for c in corner]) - low
        V, part = of_planes(m * size, alpha - m @ low)
        total += size.prod() * (low * V[:, None] + size * part)
    assert np.abs(total - whole).max() < 1e-14
    n, total = 16, np.zeros_like(whole)
    for corner in np.ndindex(n, n, n):
        low = np.array(corner) / n
        total += of_planes(m / n, alpha - m @ low)[0][:, None] * (low + 0.5 / n) / n**3
    assert np.abs(total - whole).max() < 1e-3  # measured 5e-4: 1 / (8 n2), a plane through the middles of parts


def test_mirrored_planes_have_mirrored_moments():
    m, alpha, F = planes()
    V, here = of_planes(m, alpha)
    for d in range(3):
        sign = np.where(np.arange(3) == d, -1.0, 1.0)
        there = of_planes(m * sign, alpha - m[:, d])[1]
        there[:, d] = V - there[:, d]
        assert np.abs(there - here).max() < 2e-15


def test_scaled_planes_have_the_same_bits():
    m, alpha, F = planes()
    assert np.array_equal(of_planes(m, alpha)[1], of_planes(64.0 * m, 64.0 * alpha)[1])


# ---- level liquid among solids


def cut_tank(block, n, c, height):
    """Openings of what n . x <= c leaves open, F of level liquid up to z = height among it; exact."""
    planes_ = [with_ghosts(x) for x in block.planes]
    shape = tuple(len(x) - 1 for x in planes_)
    at = np.stack(np.meshgrid(*(x[:-1] for x in planes_), indexing="ij"), -1).reshape(-1, 3)
    size = np.stack(np.meshgrid(*(np.diff(x) for x in planes_), indexing="ij"), -1).reshape(-1, 3)
    m, alpha = size * n, c - at @ n
    V, A = of_planes(m, alpha)[0], []
    for d in range(3):
        face = m.copy()
        face[:, d] = 0.0
        A.append(of_planes(face, alpha - m[:, d])[0])
    tall = np.clip((height - at[:, 2]) / size[:, 2], 0.0, 1.0)
    below = m.copy()
    below[:, 2] *= tall
    held = tall * of_planes(below, alpha)[0]
    F = np.divide(held, V, out=np.zeros_like(V), where=V > 0.0)
    return Open(*(a.reshape(shape).copy() for a in (V, *A))), F.reshape(shape)


def potential(block, F, opened, gravity=DOWN):
    columns = all_columns(tuple(n + 2 * G for n in block.shape))
    return total(Team(1), columns, grid_of(block), opened, flow_of(block, F), RHO, gravity, 1e-9)


@pytest.mark.parametrize(
    "n", [(0.3, -0.2, 1.0), (1.0, 0.1, -0.7), (-0.5, 0.5, -0.2), (0.0, 1.0, 0.3), (0.02, 0.0, 1.0)]
)
@pytest.mark.parametrize("height", [0.13, 0.37, 0.634, 0.91, 1.0])
def test_level_water_above_and_under_any_oblique_plane(n, height):
    """The tank is one large cell, whose moment is known. Measured 3e-15; with centres of cells 1e-3 to 1e-2."""
    n, block = np.array(n), block_of((7, 6, 9))
    c = 0.5 * n.sum() + 0.11 * np.abs(n).sum()
    opened, F = cut_tank(block, n, c, height)
    found = potential(block, F, opened)
    V, moment = of_planes(np.array([[n[0], n[1], n[2] * height]]), np.array([c]))
    assert found.volume == pytest.approx(height * V[0], rel=1e-13)
    assert found.potential == pytest.approx(RHO * GRAVITY * height**2 * moment[0, 2], rel=1e-12)


@pytest.mark.parametrize("up", [-1, 1])
def test_mirrored_gravity_has_the_mirrored_energy(up):
    n, block = np.array([0.3, -0.2, 1.0]), block_of((7, 6, 9), ratio=1.0)
    opened, F = cut_tank(block, n, 0.7, 0.55)
    here = potential(block, F, opened).potential
    flip = [np.flip(a, 2).copy() for a in (F, *opened)]
    flip[4] = np.roll(flip[4], -1, 2)
    assert potential(block, flip[0], Open(*flip[1:]), -DOWN).potential == pytest.approx(here, rel=1e-14)


def test_a_box_that_is_lowered_lifts_the_weight_of_the_water_it_displaces():
    """Closed form of the whole, at 60 heights over three cells; edges and corners lie inside cells. Measured 1e-10 of
    rho g cell^4; with centres of cells the error jumps by .3 of that for each cell of the bottom. Where the surface is
    in the layer of the box's top or bottom 1.1e-3: a level of a cell with a corner is another one to the program
    (cut_level.py), and tilts the planes beside it."""
    block = block_of((8, 9, 10))
    z, area = with_ghosts(block.z), 0.42 * 0.47
    cell = float(np.diff(block.z).mean())
    for low in np.linspace(0.2, 0.5, 60):
        box = np.array([[0.23, 0.31, low], [0.65, 0.78, low + 0.31]])
        opened = openings_of(block, [box])[0]
        level = 0.5 + area * min(0.31, (0.5 - low) / (1.0 - area))
        if level > low + 0.31:
            level = 0.5 + area * 0.31
        F = level_among_box(block, box, level, opened.V, z)
        wanted = RHO * GRAVITY * (0.5 * level**2 - area * 0.5 * (min(level, low + 0.31) ** 2 - low**2))
        found = potential(block, F, opened)
        assert found.volume == pytest.approx(0.5, rel=1e-13)
        layers = np.searchsorted(z, [level, low, low + 0.31])
        bound = 2e-3 if layers[0] in layers[1:] else 1e-9
        assert abs(found.potential - wanted) < bound * RHO * GRAVITY * cell**4


def level_among_box(block, box, level, V, z):
    """F of water up to z = level in what a box leaves open."""
    x, y = (with_ghosts(a) for a in (block.x, block.y))
    on = [
        np.clip((np.minimum(p[1:], b) - np.maximum(p[:-1], a)) / np.diff(p), 0, 1)
        for p, a, b in zip((x, y), box[0], box[1], strict=False)
    ]
    below = np.clip((level - z[:-1]) / np.diff(z), 0, 1)
    top = np.minimum(np.minimum(z[1:], box[1, 2]), level)
    inside = np.clip((top - np.maximum(z[:-1], box[0, 2])) / np.diff(z), 0, 1)
    held = below[None, None, :] - np.einsum("i,j,k->ijk", *on, inside)
    return np.divide(held, V, out=np.zeros_like(V), where=V > 0.0).clip(0.0, 1.0)


def test_mixed_cut_cells_fill_from_empty_to_full_without_a_jump():
    """Steps of 1 / 200 of the open volume of a cell that a corner or a plane cuts move the moment by no more than
    liquid of that volume, and the end is the whole open part."""
    block = block_of((5, 5, 5))
    corner = openings_of(block, [np.array([[0.45, 0.5, 0.42], [2, 2, 2]])])[0]
    oblique = cut_tank(block, np.array([0.4, 0.3, 1.0]), 0.8, 1.0)[0]
    for opened in (corner, oblique):
        cut = np.argwhere((opened.V > 0.0) & (opened.V < 1.0))
        cut = cut[((cut >= G) & (cut < 5 + G)).all(axis=1)]
        for i, j, k in cut:
            V = opened.V[i, j, k]
            for up in (-1.0, 1.0):
                found = [in_cut_cell(opened, i, j, k, 2, F, up) for F in np.linspace(0.0, 1.0, 201)]
                steps = np.diff(found)
                assert found[0] == 0.0 and steps.min() > -1e-12 and steps.max() < V / 200 * (1.0 + 1e-6)
                assert found[-1] == pytest.approx(in_cut_cell(opened, i, j, k, 2, 1.0, 1.0), abs=1e-13)


def test_energy_is_absent_without_gravity():
    block = block_of((5, 4, 6))
    opened, F = cut_tank(block, np.array([0.4, 0.3, 1.0]), 0.8, 0.6)
    assert potential(block, F, opened, np.zeros(3)).potential == 0.0


@pytest.mark.parametrize("tiny", [1e-15, -1e-15, 1e-13, -1e-13])
def test_round_off_of_a_face_does_not_say_which_solid_a_cell_has(tiny):
    """A ball's cap comes through the upper face, on both sides along x the same but for round-off. By it alone moments
    differed by 3.5e-3: 4e-5 J to and fro of a ball that floats still (hard/wet_spin_ball)."""
    shape, at = (5, 5, 5), (2, 2, 2)
    V, Ax, Ay, Az = (np.ones(shape) for _ in range(4))
    V[at], Az[at], Ay[at], Ay[2, 1, 2], Ax[at], Ax[1, 2, 2] = 0.943, 0.8, 0.99, 0.9, 0.98, 0.98
    even = in_cut_cell(Open(V, Ax, Ay, Az), *at, 2, 1.0, 1.0)
    Ax[1, 2, 2] += tiny
    assert abs(in_cut_cell(Open(V, Ax, Ay, Az), *at, 2, 1.0, 1.0) - even) <= 1e-9
