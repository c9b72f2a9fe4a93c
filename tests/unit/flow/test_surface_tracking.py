"""The liquid moves: shapes come back, volume is kept to round-off, level water stays level, no side is preferred."""

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
    swirl,
    volume,
)


def vortex(n, sub=32):
    """(error, volume change, over, under) of a disc in the vortex of Rider and Kothe 1998 that turns back at T/2 = 4.

    Steps of equal displacement, sum of CFL numbers 1/2: as the velocity's cosine lets them be.
    """
    block, grid, _ = mesh(even(n), [0, 1 / n], even(n))
    F = fractions(block, lambda x, y, z: (x - 0.5) ** 2 + (z - 0.75) ** 2 < 0.15**2 + 0 * y, sub)
    start = F.copy()
    q = swirl(block, lambda x, z: np.sin(np.pi * x) ** 2 * np.sin(np.pi * z) ** 2 / np.pi)
    travel = 8 / np.pi  # of each half: the integral of cos(pi t / 8) over 0 .. 4
    count = int(np.ceil(travel * largest_cfl(q, grid) / 0.5))
    dt = travel / count
    back = tuple(None if v is None else -v for v in q)
    over, under, _ = carry(F, grid, [(q, dt)] * count + [(back, dt)] * count)
    error = np.abs(F - start)[2:-2, 2, 2:-2].sum() / n**2
    return error, volume(F, grid) / volume(start, grid) - 1, over, under


@pytest.mark.parametrize(("n", "bound"), [(32, 0.042), (64, 0.0098)])
def test_disc_in_a_reversed_vortex(n, bound):
    """Error .0235, .0060 and, at 128, .0014; the bound is 1.2 x plicRDF's .035, .0082, .0023. The disc is drawn into a
    thread 3/4 of a cell wide at 32 cells, and where it tears is chance (.022 to .029, .0060 to .0076 with steps a few
    per cent shorter). Without the moments .057, .0074, planes found anew for the second sweep .0583, .0069, and without
    line_fit.py .0632, .0118. Over- and underfull by round-off only."""
    error, change, over, under = vortex(n)
    assert error <= bound
    assert abs(change) <= 1e-13
    assert over <= 1e-14 and under >= -1e-14


def test_a_carried_disc_converges():
    """There and back by .3 of the domain in three directions, discs 12, 24 and 48 cells across: error over area .0057,
    .0010, .00022 along the diagonal, order 2.3 (1 m/s by 1/2: .0052, .0009, .00023; 1/10: .0019, .0003, .00013). Planes
    found anew between the sweeps: .0066, .0013, .00025, and lines of least misfit everywhere: .0065, .0020, .00036;
    what falls behind in the choice of the estimate costs order."""
    for across, most in ((0.9, (0.0063, 0.00113, 0.00025)), (0.5, (0.0057, 0.001, 0.00026))):
        errors = [_carried_disc(n, 1.0, across) for n in (24, 48, 96)]
        assert (np.array(errors) <= most).all()
        assert np.log2(errors[0] / errors[2]) / 2 >= 2.0


def _carried_disc(n, u, w):
    block, grid, shape = mesh(even(n), [0, 0.1], even(n))
    F = fractions(block, lambda x, y, z: (x - 0.35) ** 2 + (z - 0.33) ** 2 + 0 * y < 0.25**2, 32)
    start, q = F.copy(), (np.full(shape, u), None, np.full(shape, w))
    count = int(np.ceil(0.3 * largest_cfl(q, grid) / 0.5))
    back = (-q[0], None, -q[2])
    carry(F, grid, [(q, 0.3 / count)] * count + [(back, 0.3 / count)] * count)
    return np.abs(F - start)[2:-2, 2, 2:-2].sum() / start[2:-2, 2, 2:-2].sum()


def _rotation(block):
    return swirl(block, lambda x, z: 0.5 * ((x - 0.5) ** 2 + (z - 0.5) ** 2))


def test_slotted_disc_after_one_turn():
    """Zalesak's disc, 100 cells, R 15 and slot 5 cells wide: error over area .0289 at CFL 1/2, Youngs alone .0320. All
    of it at the corners. A reconstruction that flips or drifts loses the slot: > .1."""
    n = 100
    block, grid, _ = mesh(even(n), [0, 1 / n], even(n))
    F = fractions(
        block,
        lambda x, y, z: (
            ((x - 0.5) ** 2 + (z - 0.75) ** 2 < 0.15**2) & ((np.abs(x - 0.5) > 0.025) | (z > 0.85)) & (y > -1)
        ),
        16,
    )
    start, q = F.copy(), _rotation(block)
    count = int(np.ceil(2 * np.pi * 0.92 * n / 0.5))
    over, under, _ = carry(F, grid, [(q, 2 * np.pi / count)] * count)
    assert np.abs(F - start).sum() / start.sum() <= 0.0305
    assert volume(F, grid) == pytest.approx(volume(start, grid), rel=1e-13)


@pytest.mark.parametrize("x", [even(24), graded(24, 1.03)], ids=["even", "graded"])
def test_sphere_carried_across_the_diagonal(x):
    """There and back by a third of the domain: error over volume .0121 even, .0127 graded, 12 cells across
    (Youngs alone .0213, .0234, heights wherever they exist .0150, .0163)."""
    block, grid, shape = mesh(x, x, x)
    F = fractions(block, lambda x, y, z: (x - 0.35) ** 2 + (y - 0.33) ** 2 + (z - 0.36) ** 2 < 0.25**2)
    start = F.copy()
    q = tuple(np.full(shape, s) for s in (1.0, 0.9, 0.8))
    count = int(np.ceil(0.3 * largest_cfl(q, grid) / 0.5))
    back = tuple(-v for v in q)
    over, under, _ = carry(F, grid, [(q, 0.3 / count)] * count + [(back, 0.3 / count)] * count)
    assert np.abs(F - start).sum() / start.sum() <= 0.0135
    assert volume(F, grid) == pytest.approx(volume(start, grid), rel=1e-13)
    assert over <= 1e-14 and under >= -1e-14


def test_sphere_in_a_deforming_flow_keeps_its_volume():
    """LeVeque 1996, 3-D, T = 3, 24 cells: volume to round-off, no cell over- or underfull though the sphere becomes a
    sheet thinner than a cell; error .0113 (its volume: .0141) is all lost shape at this size."""
    n, T = 24, 3.0
    block, grid, shape = mesh(even(n), even(n), even(n))
    F = fractions(block, lambda x, y, z: (x - 0.35) ** 2 + (y - 0.35) ** 2 + (z - 0.35) ** 2 < 0.15**2)
    start = F.copy()
    q = _deformation(block, shape)
    travel = T / np.pi
    count = int(np.ceil(travel * largest_cfl(q, grid) / 0.5))
    back = tuple(-v for v in q)
    over, under, _ = carry(F, grid, [(q, travel / count)] * count + [(back, travel / count)] * count)
    assert volume(F, grid) == pytest.approx(volume(start, grid), rel=1e-13)
    assert over <= 1e-13 and under >= -1e-13
    assert np.abs(F - start)[2:-2, 2:-2, 2:-2].sum() / n**3 <= 0.014


def _deformation(block, shape):
    """u = 2 sin^2(pi x) sin(2 pi y) sin(2 pi z), v = -sin(2 pi x) sin^2(pi y) sin(2 pi z), w likewise, as means over
    faces, so that the fluxes of a cell sum to zero."""
    waves = [np.diff(-np.cos(2 * np.pi * p) / (2 * np.pi)) / np.diff(p) for p in block.planes]  # of sin(2 pi x)
    at = [np.sin(np.pi * p) ** 2 for p in block.planes]
    out = []
    for axis, sign in enumerate((2.0, -1.0, -1.0)):
        q = np.zeros(shape)
        factors = [at[e] if e == axis else waves[e] for e in range(3)]
        box = tuple(slice(1, -2) if e == axis else slice(2, -2) for e in range(3))
        q[box] = sign * factors[0][:, None, None] * factors[1][None, :, None] * factors[2][None, None, :]
        out.append(q)
    return tuple(out)


@pytest.mark.parametrize("layers", [(9, 8, 10), (1, 8, 10), (9, 1, 10), (9, 8, 1), (1, 9, 1)])
def test_a_closed_box_keeps_its_volume_whatever_the_velocity(layers):
    """Random velocities with div u of order u / dx, 60 steps, with 1, 2 and 3 directions: books to 1e-14 a step."""
    rng = np.random.default_rng(11)
    block, grid, shape = mesh(*(graded(n, 1.06) for n in layers))
    F = np.zeros(shape)
    F[2:-2, 2:-2, 2:-2] = np.clip(rng.uniform(-1, 2, layers), 0, 1)
    start = volume(F, grid)
    steps = []
    for _ in range(60):
        q = random_velocity(shape, rng)
        steps.append((q, 0.4 / largest_cfl(q, grid)))
    _, _, entered = carry(F, grid, steps)
    assert (entered == 0).all()
    assert abs(volume(F, grid) / start - 1) <= 60e-14


def test_books_of_an_open_box_close_on_all_six_sides():
    """Liquid streams obliquely through a box that is open on all sides, with solids: what is in it changed by what
    entered to 1e-14 a step; each side carries some."""
    rng = np.random.default_rng(12)
    block, grid, shape = mesh(graded(8, 1.1), even(7), graded(9, 0.92))
    opened, _ = half_space(block, (0.5, 0.4, -0.7), 0.35, 0.0)
    F = rng.uniform(0, 1, shape) * (opened.V > 0)
    kept = F.copy()

    def fill(F):
        inside = F[2:-2, 2:-2, 2:-2].copy()
        F[...] = kept
        F[2:-2, 2:-2, 2:-2] = inside

    before, steps = volume(F, grid, opened.V), []
    for n in range(30):
        q = [rng.uniform(-1, 1, shape) + 0.3 * np.sin(n) for _ in range(3)]
        steps.append((q, 0.4 / largest_cfl(q, grid)))
    _, _, entered = carry(F, grid, steps, fill, opened)
    assert (np.abs(entered) > 1e-6).all()
    assert abs(volume(F, grid, opened.V) - before - entered.sum()) <= 30e-14 * before


def test_periodic_sides_carry_on():
    """Liquid that leaves on one side enters on the other: volume to round-off, and a turn around brings it back, with
    .134 of shape lost by a sphere 7 x 6 x 5 cells across. With a wrong side it would be elsewhere: about 2."""
    block, grid, shape = mesh(even(12), even(10), even(8))
    F = fractions(block, lambda x, y, z: (x - 0.4) ** 2 + (y - 0.45) ** 2 + (z - 0.5) ** 2 < 0.3**2)
    start = F.copy()
    q = tuple(np.full(shape, s) for s in (1.0, 1.0, 1.0))
    count = 60 + 12
    _, _, entered = carry(F, grid, [(q, 1.0 / count)] * count, periodic)
    assert volume(F, grid) == pytest.approx(volume(start, grid), rel=1e-13)
    assert np.abs(entered[::2] + entered[1::2]).max() <= 1e-15
    assert np.abs(F - start)[2:-2, 2:-2, 2:-2].sum() / start[2:-2, 2:-2, 2:-2].sum() <= 0.15


def _scene(seed=21):
    rng = np.random.default_rng(seed)
    block, grid, shape = mesh(even(11), graded(9, 1.05), graded(10, 0.95))
    F = fractions(block, lambda x, y, z: (x - 0.45) ** 2 + (y - 0.5) ** 2 + (z - 0.55) ** 2 < 0.33**2)
    q = random_velocity(shape, rng)
    return grid, F, q, 0.4 / largest_cfl(q, grid)


def test_a_mirrored_scene_gives_the_mirrored_result():
    """1e-13 after 6 steps, all orders of sweeps, each axis flipped."""
    grid, F, q, dt = _scene()
    start = F.copy()
    carry(F, grid, [(q, dt)] * 6)
    for axis in range(3):
        flip = lambda a, axis=axis: np.ascontiguousarray(np.flip(a, axis))  # noqa: E731
        mirrored = [flip(v) for v in q]
        mirrored[axis] = -np.roll(mirrored[axis], -1, axis)
        widths = [w[::-1].copy() if e == axis else w for e, w in enumerate(grid[:3])]
        between = [np.roll(h[::-1], -1).copy() if e == axis else h for e, h in enumerate(grid[3:])]
        other = flip(start)
        carry(other, type(grid)(*widths, *between), [(mirrored, dt)] * 6)
        assert np.abs(flip(other) - F)[2:-2, 2:-2, 2:-2].max() <= 1e-13


def test_permuted_axes_differ_by_the_order_of_sweeps_only():
    """x y z -> y z x: after 6 steps, all orders, .012 of the liquid (measured .006); a mistake in an index: all."""
    grid, F, q, dt = _scene()
    other = np.ascontiguousarray(F.transpose(1, 2, 0))
    turned = [np.ascontiguousarray(q[e].transpose(1, 2, 0)) for e in (1, 2, 0)]
    around = type(grid)(*(grid[e] for e in (1, 2, 0)), *(grid[3 + e] for e in (1, 2, 0)))
    carry(F, grid, [(q, 0.2 * dt)] * 6)
    carry(other, around, [(turned, 0.2 * dt)] * 6)
    assert np.abs(other.transpose(2, 0, 1) - F)[2:-2, 2:-2, 2:-2].sum() <= 0.012 * F[2:-2, 2:-2, 2:-2].sum()


def test_powers_of_two_and_threads_change_no_bit():
    grid, F, q, dt = _scene()
    block, big, shape = mesh(even(40), even(24), even(30))
    rng = np.random.default_rng(3)
    G = fractions(block, lambda x, y, z: x + 0.3 * y + 0.5 * z < 0.9, 4)
    many = random_velocity(shape, rng)
    results = []
    for threads in (1, 2, 3):
        H = G.copy()
        carry(H, big, [(many, 0.4 / largest_cfl(many, big))] * 3, threads=threads)
        results.append(H)
    assert (results[0] == results[1]).all() and (results[0] == results[2]).all()
    start = F.copy()
    carry(F, grid, [(q, dt)] * 4)
    scaled = type(grid)(*(a * 2.0**-20 for a in grid))
    carry(start, scaled, [([v * 2.0**-20 / 2.0**9 for v in q], dt * 2.0**9)] * 4)
    assert (start == F).all()


def test_one_layer_moves_as_the_same_flow_in_three_dimensions():
    """v None and one cell in y against v = 0 and four cells. The first sweep is the same; for the second, one layer
    carries the first one's lines along, four find planes anew: after two steps .005 of the liquid apart (measured
    .0034), after one that goes along x only 1e-14."""
    flat, grid1, _ = mesh(even(14), [0, 0.1], even(12))
    deep, grid4, _ = mesh(even(14), 0.1 * np.arange(5), even(12))
    psi = lambda x, z: np.sin(np.pi * x) ** 2 * np.sin(np.pi * z) ** 2  # noqa: E731
    inside = lambda x, y, z: (x - 0.5) ** 2 + (z - 0.6) ** 2 + 0 * y < 0.25**2  # noqa: E731
    a, b = fractions(flat, inside), fractions(deep, inside, 8)
    b[...] = a[:, 2:3, :]
    q = swirl(flat, psi)
    dt = 0.4 / largest_cfl(q, grid1)
    wide = [np.repeat(q[0][:, 2:3], 8, 1), np.zeros(b.shape), np.repeat(q[2][:, 2:3], 8, 1)]
    # the same order of sweeps: numbers 0 and 1 are x z and z x, and x y z and z y x
    still = (q[0], None, np.zeros(a.shape)), (wide[0], wide[1], np.zeros(b.shape))
    one, four = a.copy(), b.copy()
    carry(one, grid1, [(still[0], dt)])
    carry(four, grid4, [(still[1], dt)])
    assert np.abs(one[2:-2, 2, 2:-2] - four[2:-2, 3, 2:-2]).max() <= 1e-14
    carry(a, grid1, [(q, dt)] * 2)
    carry(b, grid4, [(wide, dt)] * 2)
    apart = np.abs(a[2:-2, 2, 2:-2] - b[2:-2, 3, 2:-2]).sum() / a[2:-2, 2, 2:-2].sum()
    assert apart <= 0.005


def test_dust_rests_and_is_not_lost():
    """Cells with 1e-14 of liquid, and one with -1e-15, in a flow: their sum is kept to 1e-28."""
    block, grid, shape = mesh(even(8), even(8), even(8))
    F = np.zeros(shape)
    F[4:6, 5, 4] = 1e-14
    F[6, 6, 6] = -1e-15
    before = F[2:-2, 2:-2, 2:-2].sum()
    q = random_velocity(shape, np.random.default_rng(9))
    carry(F, grid, [(q, 0.4 / largest_cfl(q, grid))] * 5)
    assert abs(F[2:-2, 2:-2, 2:-2].sum() - before) <= 1e-28


def test_no_liquid_and_no_directions_do_nothing():
    block, grid, shape = mesh(even(6), even(6), even(6))
    F = np.zeros(shape)
    q = random_velocity(shape, np.random.default_rng(9))
    assert carry(F, grid, [(q, 0.1)])[:2] == (0.0, 0.0)
    F[3, 3, 3] = 0.4
    assert carry(F, grid, [((None, None, None), 0.1)])[:2] == (0.0, 0.0)
    assert F[3, 3, 3] == 0.4


@pytest.mark.parametrize("amount", [3e-9, 2e-6, 5e-3])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_drop_above_a_debt_falls_with_the_flow(amount, axis):
    """A drop in air, above cells that owe a little: its plane lay at the top of its cell, so that nothing ever crossed
    the lower face, and in a scene it hung there while its speed grew by g t. Nearly all is gone after 3.2 cells."""
    block, grid, shape = mesh(even(12), graded(12, 1.03), graded(12, 0.97))
    F, q = np.zeros(shape), [np.zeros(shape) for _ in range(3)]
    turned = np.moveaxis(F, axis, 2)
    turned[6, 6, 9] = amount
    turned[5:8, 5:8, 8] = -1e-2 * amount
    q[axis][...] = -1.0
    before = volume(F, grid)
    carry(F, grid, [(tuple(q), 0.4 / largest_cfl(q, grid))] * 8)
    assert turned[6, 6, 9] <= 0.03 * amount  # .6^8 = .017 in an even mesh
    assert abs(volume(F, grid) - before) <= 1e-14 * amount
