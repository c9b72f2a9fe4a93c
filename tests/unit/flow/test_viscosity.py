"""Explicit viscosity: order, balance, stability beside slivers, no stress from air, symmetries."""

import numpy as np
import pytest
from momentum_scenes import (
    NOTHING,
    blocks,
    inside,
    mesh,
    operators,
    places,
    random_velocity,
    reflected,
    reflected_grid,
    reflected_open,
    shape_of,
    viscous,
    wrap,
)

from flowgmo.flow.fields import G, Open
from flowgmo.flow.momentum.viscosity import viscous_limit
from flowgmo.flow.team import Team


def smooth(grid, c):
    """Component c and its laplacian."""
    x, y, z = places(grid, c)
    k = 2 * np.pi
    q = np.sin(k * x + c) * np.cos(k * y) * np.sin(2 * k * z - 1) + np.cos(k * y + 2 * c)
    return q, -6 * k**2 * np.sin(k * x + c) * np.cos(k * y) * np.sin(2 * k * z - 1) - k**2 * np.cos(k * y + 2 * c)


@pytest.mark.parametrize("graded", [0.0, 0.3])
def test_observed_order(graded):
    """Mean error; measured 1.99. On graded cells the laplacian between centres is first order only where d jumps."""
    errors = []
    for n in (16, 32):
        grid = mesh((n, n, n), graded=graded)
        fields = [smooth(grid, c) for c in range(3)]
        velocity = tuple(np.broadcast_to(f[0], shape_of(grid)).copy() for f in fields)
        got = viscous(grid, velocity, 0.7, 0.0)
        errors.append([np.abs(inside(g - 0.7 * f[1])).mean() for g, f in zip(got, fields, strict=True)])
    order = np.log2(np.array(errors[0]) / errors[1])
    assert order.min() >= 1.93


@pytest.mark.parametrize("solid", [False, True])
def test_explicit_step_at_the_limit_is_stable(solid):
    """Twenty Euler steps of the limit on noise, no-slip walls and slivers: energy falls in each."""
    rng = np.random.default_rng(1)
    grid = mesh((9, 8, 7), graded=0.3)
    open = blocks(grid, rng, 4) if solid else NOTHING
    velocity = random_velocity(grid, rng, open)
    made = operators(grid, open, (True,) * 6)
    dt = viscous_limit(grid, 0.3)
    largest = [max(np.abs(inside(q)).max() for q in velocity)]
    for _ in range(20):
        for c, q in enumerate(velocity):
            close_sides(q, c)
        a = viscous(grid, velocity, 0.3, dt, made)
        velocity = tuple(q + dt * b for q, b in zip(velocity, a, strict=True))
        largest.append(max(np.abs(inside(q)).max() for q in velocity))
    assert max(largest) <= 1.5 * largest[0] and largest[-1] < 0.3 * largest[0]


def close_sides(q, c):
    """Ghosts as beside resting walls without shear, and the normal component 0 on them."""
    for d in range(3):
        m = np.moveaxis(q, d, 0)
        if d == c:
            m[1] = m[-G - 1] = 0.0
            m[0], m[-2], m[-1] = -m[2], -m[-4], -m[-5]
        else:
            m[1], m[0], m[-2], m[-1] = m[2], m[3], m[-3], m[-4]


@pytest.mark.parametrize("free_surface", [False, True])
def test_momentum_is_exchanged_not_made(free_surface):
    """Free slip, periodic, solids and air: the sum of V volume du/dt is 0, so every stress acts on both sides."""
    rng = np.random.default_rng(2)
    grid = mesh((8, 9, 10), graded=0.3)
    n = shape_of(grid)
    open = blocks(grid, rng, 4)
    open = Open(*(wrap(a) for a in open))
    F = wrap((rng.random(n) < 0.6).astype(float)) if free_surface else None
    velocity = tuple(wrap(q) for q in random_velocity(grid, rng, open))
    made = operators(grid, open, solids_stick=False)
    for c, a in enumerate(viscous(grid, velocity, 1.0, 0.0, made, F)):
        V = 0.5 * (open.V + np.roll(open.V, -1, axis=c))
        size = [grid[3 + d] if d == c else grid[d] for d in range(3)]
        force = inside(a * V * np.einsum("i,j,k->ijk", *size))
        walls = force_on_closed_faces(grid, open, velocity[c], c, F, made[c])
        assert abs(force.sum() + walls) < 1e-12 * np.abs(force).sum()


def force_on_closed_faces(grid, open, q, c, F, operator):
    """What walls square to c take: the stress towards closed faces that lie on walls, from the faces beside them."""
    size = [grid[3 + d] if d == c else grid[d] for d in range(3)]
    total = 0.0
    for row, conducts in zip(operator.cut.rows, operator.cut.c, strict=True):
        P = tuple(row[:3])
        if F is not None and not max(F[P], F[tuple(np.add(P, np.eye(3, dtype=int)[c]))]) > 0:
            continue
        for m in range(6):
            N = list(P)
            N[m // 2] += 2 * (m % 2) - 1
            N = tuple(N)
            wet = F is None or max(F[N], F[tuple(np.add(N, np.eye(3, dtype=int)[c]))]) > 0
            if open[1 + c][N] == 0 and wet:
                total += conducts[m] * q[P] * np.prod([size[d][P[d]] for d in range(3)])
    return total


def test_air_brings_no_stress():
    """What the faces in air hold changes nothing, and they get no acceleration."""
    rng = np.random.default_rng(3)
    grid = mesh((9, 8, 7))
    F = (rng.random(shape_of(grid)) < 0.4).astype(float)
    velocity = random_velocity(grid, rng)
    dry = [np.maximum(F, np.roll(F, -1, axis=c)) == 0 for c in range(3)]
    a = viscous(grid, velocity, 1.0, 0.0, F=F)
    b = viscous(grid, tuple(np.where(d, 1e9, q) for q, d in zip(velocity, dry, strict=True)), 1.0, 0.0, F=F)
    for p, q, d in zip(a, b, dry, strict=True):
        assert np.array_equal(inside(p), inside(q)) and not inside(p)[inside(d)].any() and inside(p).any()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_absent_direction(axis):
    rng = np.random.default_rng(5)
    thin, thick = [8, 7, 6], [8, 7, 6]
    thin[axis], thick[axis] = 1, 4
    small, large = mesh(thin, graded=0.2), mesh(thick, graded=0.2)
    velocity = tuple(
        None if q is None else np.repeat(np.take(q, [2], axis=axis), 5, axis=axis) for q in random_velocity(small, rng)
    )
    spread = tuple(np.zeros(shape_of(large)) + (0 if q is None else np.take(q, [2], axis=axis)) for q in velocity)
    got = viscous(small, velocity, 1.0, 0.0)
    full = viscous(large, spread, 1.0, 0.0)
    for a, b in zip(got, full, strict=True):
        if a is not None:
            assert np.array_equal(np.take(a, 2, axis=axis), np.take(b, 3, axis=axis))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_mirrored(axis):
    """Mirrored along an axis, with solids, walls and air: the same values mirrored, to round-off."""
    rng = np.random.default_rng(axis)
    grid = mesh((9, 8, 7), (1.0, 1.2, 0.7), graded=0.3)
    open = blocks(grid, rng)
    F = (rng.random(shape_of(grid)) < 0.7).astype(float)
    velocity = random_velocity(grid, rng, open)
    straight = viscous(grid, velocity, 1.0, 1e-3, operators(grid, open, (True,) * 6), F)
    other = reflected_grid(grid, axis)
    made = operators(other, reflected_open(open, axis), (True,) * 6)
    back = viscous(other, reflected(velocity, axis), 1.0, 1e-3, made, np.flip(F, axis).copy())
    for a, b in zip(straight, reflected(back, axis), strict=True):
        m = [slice(G, -G)] * 3
        m[axis] = slice(G, -G - 1)  # the upper side's face has no partner among real cells
        assert np.abs(a[tuple(m)] - b[tuple(m)]).max() < 1e-12 * np.abs(a).max()


def test_permuted_axes():
    """x, y, z renamed to z, x, y gives the same numbers."""
    rng = np.random.default_rng(7)
    grid = mesh((9, 8, 7), (1.0, 1.2, 0.7), graded=0.3)
    open = blocks(grid, rng)
    velocity = random_velocity(grid, rng, open)
    turn = [2, 0, 1]  # new axis e is the old axis turn[e]

    def turned(a):
        return np.ascontiguousarray(a.transpose(turn))

    other = type(grid)(*(grid[t] for t in turn), *(grid[3 + t] for t in turn))
    straight = viscous(grid, velocity, 1.0, 1e-3, operators(grid, open, (True,) * 6))
    made = operators(other, Open(turned(open.V), *(turned(open[1 + t]) for t in turn)), (True,) * 6)
    back = viscous(other, tuple(turned(velocity[t]) for t in turn), 1.0, 1e-3, made)
    for e, t in enumerate(turn):
        assert np.abs(turned(straight[t]) - back[e]).max() < 1e-12 * np.abs(back[e]).max()


def test_threads_units_and_cut_faces_that_are_open():
    rng = np.random.default_rng(6)
    n = (24, 22, 20)
    grid = mesh(n, graded=0.2)
    small = mesh(n, (2.0**-7,) * 3, 0.2)
    open = blocks(grid, rng)
    velocity = random_velocity(grid, rng, open)
    one = viscous(grid, velocity, 1.0, 1e-4, operators(grid, open, (True,) * 6))
    three = viscous(grid, velocity, 1.0, 1e-4, operators(grid, open, (True,) * 6, team=Team(3)), team=Team(3))
    scaled = viscous(small, velocity, 1.0, 1e-4 * 2.0**-14, operators(small, open, (True,) * 6))
    for a, b, c in zip(one, three, scaled, strict=True):
        assert np.array_equal(a, b) and np.array_equal(a * 2.0**14, c)
    ones = Open(*(np.ones(shape_of(grid)) for _ in range(4)))
    plain = viscous(grid, velocity, 1.0, 0.0)
    all_cut = viscous(grid, velocity, 1.0, 0.0, operators(grid, ones._replace(V=ones.V - 1e-15)))
    for a, b, c in zip(plain, viscous(grid, velocity, 1.0, 0.0, operators(grid, ones)), all_cut, strict=True):
        assert np.array_equal(a, b)
        assert np.abs(inside(a - c)).max() < 1e-12 * np.abs(a).max()
