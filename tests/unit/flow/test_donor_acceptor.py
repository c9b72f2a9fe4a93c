"""The cheaper flux: same books and bounds as planes, fronts that stay sharp, larger errors of shape."""

import numpy as np
import pytest
from liquid_scenes import (
    carry,
    even,
    fractions,
    graded,
    half_space,
    largest_cfl,
    mesh,
    periodic,
    random_velocity,
    volume,
)

from flowgmo.flow.surface.donor_acceptor import donor_acceptor_flux

DA = {"carry": donor_acceptor_flux}


def test_a_front_moves_at_its_speed_and_stays_one_cell_wide():
    """A wall of liquid pushed along x for 21 steps at CFL .3: exact to 1e-13, one mixed cell, both ways."""
    for sign in (1.0, -1.0):
        block, grid, shape = mesh(even(30, 30.0), even(5), even(6))
        F = np.zeros(shape)
        F[12:18] = 1.0
        q = (np.full(shape, sign), None, np.zeros(shape))
        carry(F, grid, [(q, 0.3)] * 21, periodic, **DA)
        at = np.arange(len(F)) - 12 - 0.3 * 21 * sign  # left edge of each cell, in the liquid's frame
        exact = np.clip(np.minimum(at + 1, 6.0) - np.maximum(at, 0.0), 0.0, 1.0)
        assert np.abs(F[2:-2, 4, 4] - exact[2:-2]).max() <= 1e-13


def test_level_water_slides_along_itself():
    """Level water at .4 of a cell moved along x and y: F unchanged to 1e-14 (the donor's share, not the acceptor's)."""
    block, grid, shape = mesh(even(8), even(7), graded(9, 1.1))
    F = np.zeros(shape)
    F[:, :, :6], F[:, :, 6] = 1.0, 0.4
    start = F.copy()
    q = (np.full(shape, 1.0), np.full(shape, -0.7), np.zeros(shape))
    carry(F, grid, [(q, 0.4 / largest_cfl(q, grid))] * 20, periodic_in_plane, **DA)
    assert np.abs(F - start).max() <= 1e-14


def periodic_in_plane(F):
    top, bottom = F[:, :, -2:].copy(), F[:, :, :2].copy()
    periodic(F)
    F[:, :, -2:], F[:, :, :2] = top, bottom


def test_volume_and_bounds_as_with_planes():
    """Sphere there and back: volume to round-off, 0 <= F <= 1 to 1e-14; error over volume .119, ten times
    the planes'."""
    x = even(24)
    block, grid, shape = mesh(x, x, x)
    F = fractions(block, lambda x, y, z: (x - 0.35) ** 2 + (y - 0.33) ** 2 + (z - 0.36) ** 2 < 0.25**2)
    start = F.copy()
    q = tuple(np.full(shape, s) for s in (1.0, 0.9, 0.8))
    count = int(np.ceil(0.3 * largest_cfl(q, grid) / 0.5))
    back = tuple(-v for v in q)
    over, under, _ = carry(F, grid, [(q, 0.3 / count)] * count + [(back, 0.3 / count)] * count, **DA)
    assert volume(F, grid) == pytest.approx(volume(start, grid), rel=1e-13)
    assert over <= 1e-14 and under >= -1e-14
    assert np.abs(F - start).sum() / start.sum() <= 0.15


def test_books_close_with_solids_and_any_velocity():
    """Random velocities past an oblique solid in a closed box: 1e-14 a step."""
    rng = np.random.default_rng(5)
    block, grid, shape = mesh(graded(8, 1.1), even(7), graded(9, 0.92))
    opened, F = half_space(block, (0.5, 0.4, -0.7), 0.35, 0.6)
    start, steps = volume(F, grid, opened.V), []
    for _ in range(30):
        q = random_velocity(shape, rng)
        steps.append((q, 0.4 / largest_cfl(q, grid)))
    carry(F, grid, steps, opened=opened, **DA)
    assert abs(volume(F, grid, opened.V) / start - 1) <= 30e-14
    assert (F[opened.V == 0] == 0).all()
