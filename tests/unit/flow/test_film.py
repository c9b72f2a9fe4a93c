"""The law of thin films (flow/immersed/film.py) against closed forms and integrals; what steps make of it."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from flowgmo.flow.immersed.film import (
    REACH,
    Films,
    Squeeze,
    mean_resistance,
    missing,
    resistance,
    strength_of,
)

MU = 0.7


def films(gap, strength=1.0, power=1.0, cell=0.2, rough=1e-4):
    """strength: times h^-p the force per speed."""
    gap = np.atleast_1d(np.asarray(gap, float))
    strength = strength * (gap + rough) ** -power
    return Films(gap, strength, *(np.full(len(gap), x) for x in (power, cell, rough)))


def test_strength_of_balls_strips_and_plates():
    # A ball and a wall; two unlike balls; a crossed pair of cylinders; a strip; a disc. All exact: the formula of the
    # elliptic plate and of the strip is the same.
    h, R = 0.01, 1.5
    wall = np.array([[1.0 / R, 1.0 / R]])
    assert strength_of(wall, h, MU) == pytest.approx(6.0 * np.pi * MU * R**2 / h, rel=1e-14)
    both = 1.0 / R + 1.0 / 0.5
    assert strength_of(np.full((1, 2), both), h, MU) == pytest.approx(6.0 * np.pi * MU / both**2 / h, rel=1e-14)
    half = 0.8  # of the strip's length
    strip = strength_of(np.array([[1.0 / R, 2.0 * h / half**2]]), h, MU)
    thin = 2.0 * h * R / half**2  # of a strip, the ratio of its curvatures
    assert strip == pytest.approx(
        3.0 * np.sqrt(2.0) * np.pi * MU * 2.0 * half * (R / h) ** 1.5 / (1.0 + thin), rel=1e-13
    )
    disc = strength_of(np.full((1, 2), 2.0 * h / R**2), h, MU)
    assert disc == pytest.approx(1.5 * np.pi * MU * R**4 / h**3, rel=1e-13)


@pytest.mark.parametrize("h", [1e-4, 0.02, 0.2, 0.4])
def test_part_of_the_mesh(h):
    # Reynolds' equation with H (H^2 + c^2) in place of H^3, integrated: what the mesh has of the force.
    cell = 0.2
    c2 = 2.0 * cell**2
    ball = 2.0 * quad(lambda x: x / ((x + h) * ((x + h) ** 2 + c2)), 0.0, np.inf, limit=500, points=None)[0]
    strip = 16.0 / np.pi * quad(lambda y: y**2 / ((y**2 + h) * ((y**2 + h) ** 2 + c2)), 0.0, np.inf, limit=500)[0]
    plate = 1.0 / (h * (h**2 + c2))
    for power, part in ((1.0, ball), (1.5, strip), (3.0, plate)):
        found = missing(np.array([h]), np.array([power]), np.array([cell]))
        assert found == pytest.approx(1.0 - part * h**power, rel=2e-6)


@pytest.mark.parametrize("power", [1.0, 1.5, 3.0])
def test_impulse_is_that_of_the_way(power):
    # The sum over parts of a way is that of the whole, and both the integral; nothing beyond touch or REACH cells.
    whole = films(0.3, power=power)
    exact = quad(lambda g: resistance(whole, np.array([g]))[0], 0.0, 0.3, limit=500, points=[1e-4, 1e-3, 1e-2, 0.1])[0]
    assert mean_resistance(whole, np.array([-0.3]))[0] * 0.3 == pytest.approx(exact, rel=2e-3)  # eight nodes, measured
    assert mean_resistance(whole, np.array([-0.7]))[0] * 0.7 == pytest.approx(
        mean_resistance(whole, np.array([-0.3]))[0] * 0.3, rel=1e-14
    )
    ends = np.geomspace(0.3, 1e-3, 13)
    parts = mean_resistance(films(ends[:-1], power=power), np.diff(ends)) @ -np.diff(ends)
    direct = quad(lambda g: resistance(whole, np.array([g]))[0], 1e-3, 0.3, limit=500, points=[1e-2, 0.1])[0]
    assert parts == pytest.approx(direct, rel=1e-9)
    away = films(REACH * 0.2, power=power)
    assert mean_resistance(away, np.array([0.1]))[0] == 0.0
    assert resistance(whole, np.array([-1.0])) == resistance(whole, np.array([0.0]))
    still = mean_resistance(whole, np.array([0.0]))
    assert still == pytest.approx(resistance(whole, whole.gap), rel=1e-12)
    assert mean_resistance(whole, np.array([-1e-13])) == pytest.approx(still, rel=1e-10)


def test_force_begins_at_zero():
    near = resistance(films([0.39999]), np.array([0.39999]))
    assert 0.0 < near[0] < 1e-3
    assert resistance(films([0.4]), np.array([0.4]))[0] == 0.0


def fall(dt, steps, mean, force=-1.0, v=-0.3, gap=0.35, strength=2.0, mass=1.0):
    """Gap and speed of a body that a constant force moves to a wall, by steps with the film alone; impulses so far."""
    N, W, given = np.array([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]]), np.eye(6) / mass, 0.0
    U = np.array([0.0, 0.0, v, 0.0, 0.0, 0.0])
    for _ in range(steps):
        squeeze = Squeeze(films(gap, strength), N, np.zeros(1), N @ U, dt, mean=mean)
        free = U + np.array([0.0, 0.0, dt * force / mass, 0.0, 0.0, 0.0])
        squeeze.guess(W, free)
        for _ in range(6):
            inverse, start = squeeze.soften(W, free)
            assert np.linalg.eigvalsh(inverse)[0] > 0.0
            if not squeeze.unfit(start):
                break
        given += squeeze.impulses(start)[0]
        gap += dt * (0.5 * (U + start) if mean else start)[2]
        U = start
    return gap, U[2], given


@pytest.mark.parametrize("mean", [True, False])
def test_approach_under_a_constant_force(mean):
    # Against the equation of motion. Measured at t = 1, gap .046: 1.5e-7 with steps of .01, second order, where the
    # path has the mean velocity; 1.6e-5, first order, where it has that of the end. At t = 4 the steps are stiff (dt k
    # up to 9 masses): 1 % of the gap of .007 with steps of .04. The force of the gap at the start of a step would
    # throw it back.
    whole = films(0.35, 2.0)

    def equation(t, y):
        return [y[1], -1.0 - resistance(whole, y[:1])[0] * y[1]]

    exact, late = solve_ivp(equation, (0.0, 4.0), [0.35, -0.3], t_eval=(1.0, 4.0), rtol=1e-10, atol=1e-13).y[0]
    errors = [abs(fall(dt, round(1.0 / dt), mean)[0] - exact) for dt in (0.04, 0.02, 0.01)]
    share = 0.35 if mean else 0.55
    assert errors[1] < share * errors[0] and errors[2] < share * errors[1]
    assert errors[2] < (1e-6 if mean else 5e-5)
    assert fall(0.04, 100, mean)[0] == pytest.approx(late, rel=0.02)


def test_no_step_is_too_long():
    # dt k / m is 1e5 at the end: the ball stops before the wall and is not thrown back.
    for mean in (True, False):
        for dt in (0.01, 1.0, 100.0):
            gap, v, _ = fall(dt, 40, mean, mass=1e-3)
            assert v <= 0.0 and gap < 0.35


def test_coasting_loses_what_the_way_says():
    # Without a force m v + (integral of k dh) stays: the sum of impulses does not know the steps.
    for steps in (3, 30):
        gap, v, given = fall(0.4 / steps, steps, True, force=0.0, v=-0.6, strength=0.4)
        way = mean_resistance(films(0.35, 0.4), np.array([gap - 0.35]))[0] * (0.35 - gap)
        assert gap > 0.0
        assert given == pytest.approx(way, rel=2e-3)
        assert v == pytest.approx(-0.6 + given, rel=1e-12)


def test_energy_only_falls():
    # Films between several bodies, of any strength: 200 random sets.
    rng = np.random.default_rng(7)
    for _ in range(200):
        n, k = rng.integers(1, 4), rng.integers(1, 6)
        half = rng.normal(size=(6 * n, 6 * n))
        mass = half @ half.T + 0.1 * np.eye(6 * n)
        W, U = np.linalg.inv(mass), rng.normal(size=6 * n)
        N = rng.normal(size=(k, 6 * n))
        some = films(rng.uniform(0.0, 0.5, k), 10.0 ** rng.uniform(-3, 6))
        for mean in (True, False):
            squeeze = Squeeze(some, N, np.zeros(k), N @ U, 10.0 ** rng.uniform(-4, 0), mean=mean)
            squeeze.guess(W, U)
            _, after = squeeze.soften(W, U)
            change = 0.5 * (after @ mass @ after - U @ mass @ U)
            assert change <= 1e-12 * (U @ mass @ U)
            assert np.allclose(W @ N.T @ squeeze.impulses(after), after - U, atol=1e-9 * np.abs(U).max())


def test_what_is_held_stays_held():
    # A direction that is not solved for has no inverse mass, before and after; a prescribed partner's speed counts.
    W = np.diag([0.0, 0.0, 2.0, 0.0, 0.0, 0.0])
    N = np.array([[0.6, 0.0, 0.8, 0.0, 0.1, 0.0]])
    squeeze = Squeeze(films(0.01), N, np.array([0.5]), np.array([-0.5]), 0.1, mean=False)
    squeeze.guess(W, np.zeros(6))
    inverse, start = squeeze.soften(W, np.zeros(6))
    assert np.count_nonzero(inverse) == 1 and 0.0 < inverse[2, 2] < 2.0
    assert start[2] > 0.0 and np.count_nonzero(start) == 1


def test_scaled_by_powers_of_two():
    W, U = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), np.array([0.1, -0.2, -0.3, 0.2, 0.1, 0.0])
    N = np.array([[0.0, 0.6, 0.8, 0.1, 0.2, 0.0], [0.1, 0.0, -1.0, 0.1, 0.0, 0.3]])
    scale = np.array([1.0, 1.0, 1.0, 0.25, 0.25, 0.25])  # length 4, time 8, mass 32

    def after(L, T, M):
        rows = N * np.where(scale == 1.0, 1.0, L)
        some = Films(
            *(np.array(x) for x in ([0.02 * L] * 2, [30.0 * M / T] * 2, [1.0] * 2, [0.1 * L] * 2, [1e-4 * L] * 2))
        )
        own = U * np.where(scale == 1.0, L / T, 1.0 / T)
        inverse = W / np.where(scale == 1.0, M, M * L * L)
        squeeze = Squeeze(some, rows, np.zeros(2), rows @ own, 0.3 * T, mean=True)
        squeeze.guess(inverse, own)
        return squeeze.soften(inverse, own)[1] / np.where(scale == 1.0, L / T, 1.0 / T)

    assert np.array_equal(after(1.0, 1.0, 1.0), after(4.0, 8.0, 32.0))
