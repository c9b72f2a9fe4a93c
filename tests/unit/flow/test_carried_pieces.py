"""Steps of two sweeps: lines carried from the first to the second, and where in its cells a thread lies."""

import numpy as np
import pytest
from liquid_scenes import carry, even, fractions, graded, largest_cfl, mesh, periodic, random_velocity, swirl, volume

from flowgmo.flow.fields import Flow, Open
from flowgmo.flow.surface import line_fit, line_moments
from flowgmo.flow.surface.surface_tracking import move_liquid, tracking_of
from flowgmo.flow.team import Team
from flowgmo.kernel import kernel

NOTHING = Open(None, None, None, None)


@kernel
def moments(a, b, alpha):
    return line_moments.moments_under(a, b, alpha)


@kernel
def nearest(a, b, F, x, z):
    return line_moments.nearest_line(a, b, F, x, z)


@kernel
def offset(a, b, F):
    return line_fit.line_offset(a, b, F)


def _lines(count, seed=4):
    rng = np.random.default_rng(seed)
    for angle, F in zip(rng.uniform(0, 2 * np.pi, count), rng.uniform(0.001, 0.999, count), strict=True):
        yield np.cos(angle), np.sin(angle), F


def test_moments_of_a_line_are_those_of_many_points():
    """1600 strips: 1e-6 by the midpoint rule. And along the axes, where a or b is 0: 1e-15."""
    x = (np.arange(1600) + 0.5) / 1600
    for a, b, F in _lines(40):
        alpha = offset(a, b, F)
        if abs(b) < abs(a):
            a, b = b, a  # strips along z
        top = np.clip((alpha - a * x) / b, 0, 1)
        low, high = (0.0 * top, top) if b > 0 else (top, np.ones_like(top))
        wanted = (high - low).mean(), (x * (high - low)).mean(), 0.5 * (high**2 - low**2).mean()
        assert moments(a, b, alpha) == pytest.approx(wanted, abs=1e-6)
    for a, wanted in ((1.0, (0.3, 0.045, 0.15)), (-1.0, (0.3, 0.3 - 0.045, 0.15))):
        assert moments(a, 0.0, offset(a, 0.0, 0.3)) == pytest.approx(wanted, abs=1e-15)
        assert moments(0.0, a, offset(0.0, a, 0.3)) == pytest.approx([wanted[n] for n in (0, 2, 1)], abs=1e-15)


def test_a_line_is_found_again_from_its_moments():
    """1e-6 of an angle; from a thread in the middle, which lies at neither side, what was there is kept."""
    for a, b, F in _lines(300):
        _, x, z = moments(a, b, offset(a, b, F))
        found = nearest(-b, a, F, x, z)
        assert found == pytest.approx((a, b), abs=1e-6)
    assert nearest(0.6, -0.8, 0.4, 0.2, 0.2) == (0.6, -0.8)


def _one_step(F, grid, q, dt, number=0):
    tracking = tracking_of(grid)
    move_liquid(Team(1), tracking, Flow(*q, None, F, dt), NOTHING, dt, number, lambda F: None)
    return tracking.pieces.moments


@pytest.mark.parametrize("number", [0, 1])
def test_a_line_is_carried_exactly_and_its_moments_with_it(number):
    """A strip, turned by 20 degrees, carried by (.3, -.2) cells: F to 1e-14 of the line where it then is
    (found anew for the second sweep it would be so too), moments, where they are kept, to 1e-14."""
    block, grid, shape = mesh(np.arange(13.0), [0, 1], np.arange(13.0))
    a, b, alpha = np.cos(0.35), np.sin(0.35), 6.0

    def cells(shift):
        found = np.zeros((*shape, 3))
        for i in range(-2, shape[0] - 2):
            for k in range(-2, shape[2] - 2):
                at = alpha + shift - a * i - b * k
                found[i + 2, :, k + 2] = moments(a, b, at)
        return found

    F = cells(0.0)[..., 0].copy()
    q = np.full(shape, 0.3), None, np.full(shape, -0.2)
    kept = _one_step(F, grid, q, 1.0, number)
    inside, wanted = (slice(4, -4), 2, slice(4, -4)), cells(0.3 * a - 0.2 * b)
    assert np.abs(F - wanted[..., 0])[inside].max() <= 1e-13
    known = kept[inside][..., 0] >= 0.0
    assert np.abs((kept - wanted)[inside][known]).max(initial=0.0) <= 1e-13


@pytest.mark.parametrize(
    ("kind", "width", "most"), [(even, 1.0, 0.3), (lambda n: graded(n, 1.04), 1.5, 0.08)], ids=["even", "graded"]
)
def test_a_thread_about_as_thin_as_a_cell_stays_one(kind, width, most):
    """A ring as wide as a cell, and half as wide again in graded cells, carried along the diagonal by a quarter of the
    domain and back: error over area .19, .040; from F alone .57, .115."""
    n = 32
    block, grid, shape = mesh(kind(n), [0, 0.1], kind(n))
    F = fractions(block, lambda x, y, z: np.abs(np.hypot(x - 0.35, z - 0.36) - 0.2) < 0.5 * width / n + 0 * y, 32)
    start, q = F.copy(), (np.full(shape, 1.0), None, np.full(shape, 0.9))
    count = int(np.ceil(0.25 * largest_cfl(q, grid) / 0.5))
    back = (-q[0], None, -q[2])
    over, under, _ = carry(F, grid, [(q, 0.25 / count)] * count + [(back, 0.25 / count)] * count)
    assert np.abs(F - start).sum() / start.sum() <= most
    assert volume(F, grid) == pytest.approx(volume(start, grid), rel=1e-13)
    assert over <= 1e-14 and under >= -1e-14


def test_liquid_fills_no_cell_beyond_its_volume_with_courant_numbers_of_one():
    """Along each direction almost 1, in the reversed vortex: over and under 1e-14; split as before, .2."""
    block, grid, _ = mesh(even(32), [0, 1 / 32], even(32))
    F = fractions(block, lambda x, y, z: (x - 0.5) ** 2 + (z - 0.75) ** 2 < 0.15**2 + 0 * y, 16)
    q = swirl(block, lambda x, z: np.sin(np.pi * x) ** 2 * np.sin(np.pi * z) ** 2 / np.pi)
    dt = 0.95 / 32 / max(np.abs(q[0]).max(), np.abs(q[2]).max())
    start = volume(F, grid)
    over, under, _ = carry(F, grid, [(q, dt)] * 80)
    assert over <= 1e-14 and under >= -1e-14
    assert volume(F, grid) == pytest.approx(start, rel=1e-13)


def test_a_thread_goes_through_periodic_sides():
    """Once around in both directions: volume to round-off, and what enters is what left, to the last bit; begun five
    and three cells further on 1e-8 (measured 4e-10: what tears tells round-off apart)."""
    block, grid, shape = mesh(even(16), [0, 0.1], even(12))
    F = fractions(block, lambda x, y, z: np.abs(x + 0.4 * z - 0.6) < 0.03 + 0 * y, 16)
    periodic(F)
    start, q = F.copy(), (np.full(shape, 1.0), None, np.full(shape, -1.0))
    count = 64
    joined = {"fill": periodic, "periodic": (True, False, True)}
    over, under, entered = carry(F, grid, [(q, 1.0 / count)] * count, **joined)
    assert volume(F, grid) == pytest.approx(volume(start, grid), rel=1e-13)
    assert np.abs(entered[::2] + entered[1::2]).max() <= 1e-16
    assert over <= 1e-14 and under >= -1e-14
    other, by = np.roll(start[2:-2, :, 2:-2], (5, 3), (0, 2)), start.copy()
    by[2:-2, :, 2:-2] = other
    periodic(by)
    carry(by, grid, [(q, 1.0 / count)] * count, **joined)
    assert np.abs(by[2:-2, :, 2:-2] - np.roll(F[2:-2, :, 2:-2], (5, 3), (0, 2))).max() <= 1e-8


def _threads_of_liquid(seed=8):
    rng = np.random.default_rng(seed)
    block, grid, shape = mesh(even(21), [0, 0.1], graded(18, 0.97))
    F = fractions(block, lambda x, y, z: np.abs(np.sin(17 * x + 3 * z) * np.cos(11 * z - 4 * x)) < 0.2 + 0 * y, 8)
    q = random_velocity(shape, rng)
    return grid, F, q, 0.4 / largest_cfl(q, grid)


def test_mirrored_threads_give_the_mirrored_result():
    """1e-8 after 6 steps (measured 4e-11: a thread's line is where two distances are almost the same)."""
    grid, F, q, dt = _threads_of_liquid()
    start = F.copy()
    carry(F, grid, [(q, dt)] * 6)
    for axis in (0, 2):
        flip = lambda a, axis=axis: np.ascontiguousarray(np.flip(a, axis))  # noqa: E731
        mirrored = [None if v is None else flip(v) for v in q]
        mirrored[axis] = -np.roll(mirrored[axis], -1, axis)
        widths = [w[::-1].copy() if e == axis else w for e, w in enumerate(grid[:3])]
        between = [np.roll(h[::-1], -1).copy() if e == axis else h for e, h in enumerate(grid[3:])]
        other = flip(start)
        carry(other, type(grid)(*widths, *between), [(mirrored, dt)] * 6)
        assert np.abs(flip(other) - F)[2:-2, 2:-2, 2:-2].max() <= 1e-8


def test_one_layer_along_any_axis_is_the_same_scene():
    """Meshes of one layer in y, z and x, with the same order of sweeps: 1e-11 after 6 steps."""
    grid, F, q, dt = _threads_of_liquid()
    start = F.copy()
    carry(F, grid, [(q, dt)] * 6)
    for axes in ((0, 2, 1), (1, 0, 2)):  # x z y, y x z: sweeps along x and z stay first and second
        turn = lambda a, axes=axes: np.ascontiguousarray(a.transpose(axes))  # noqa: E731
        around = type(grid)(*(grid[e] for e in axes), *(grid[3 + e] for e in axes))
        other = turn(start)
        carry(other, around, [([None if q[e] is None else turn(q[e]) for e in axes], dt)] * 6)
        assert np.abs(other.transpose(np.argsort(axes)) - F)[2:-2, 2:-2, 2:-2].max() <= 1e-11


def test_threads_of_the_program_and_powers_of_two_change_no_bit():
    grid, F, q, dt = _threads_of_liquid()
    results = []
    for threads, scale in ((1, 1.0), (2, 1.0), (3, 2.0**-20)):
        G = F.copy()
        scaled = type(grid)(*(a * scale for a in grid))
        carry(G, scaled, [([None if v is None else v * scale for v in q], dt)] * 6, threads=threads)
        results.append(G)
    assert (results[0] == results[1]).all() and (results[0] == results[2]).all()
