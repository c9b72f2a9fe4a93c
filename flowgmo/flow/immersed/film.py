"""The liquid squeezed out of a gap thinner than the mesh resolves: how it holds back what closes or opens the gap.

**The film.** Two walls with the gap H(x, y) close with the speed v; viscosity rules. Reynolds' equation (1886)

    div(H^3 grad p) = - 12 mu v

has in a gap that opens as a paraboloid, H = h + (k1 x^2 + k2 y^2) / 2 with k1, k2 the relative curvatures, the solution
H^3 grad p = - 12 mu v / (k1 + k2) grad H, so that p = 6 mu v / ((k1 + k2) H^2), and its integral is the force

    F = 12 pi mu v / ((k1 + k2) sqrt(k1 k2) h)

6 pi mu R^2 v / h for a ball and a wall. With a_i^2 = 2 h / k_i, the distances at which the gap has doubled, the same is

    F = 3 pi mu a1^3 a2^3 / (a1^2 + a2^2) v / h^3

which is also the force of an elliptic plate with the half axes a1, a2 (a disc: 3 pi mu R^4 v / (2 h^3)), and of a long
strip of length 2 a2 and cross curvature k1, 3 sqrt(2) pi mu L (R / h)^1.5 v. So the film reaches as far as the gap has
doubled or the surface ends, and falls as h^-p with p = 1, 1.5, 3 as 0, 1, 2 of the directions end.

**What the mesh has of it.** In a gap of H = N cells of width d the mesh's friction on the mean flow is 12 mu / (H^2 +
2 d^2) in place of 12 mu / H^2: the faces' centres lie half a cell off the walls (N = 1: a third of it). The same steps
with H (H^2 + c^2) for H^3, c = sqrt(2) d, give the part of h^-p which the mesh has, and with which it stays finite:

    p = 1      2 (atan(c / h) / c - h / (2 c^2) ln(1 + c^2 / h^2))             pi / c at contact
    p = 1.5    (8 / c^2) (sqrt((sqrt(h^2 + c^2) + h) / 2) - sqrt(h))
    p = 3      1 / (h (h^2 + c^2))

Only the difference is added here, from REACH cells on. Of a ball 10 cells across that nears a wall at Re 0.25 the
mesh alone had, in Stokes' drag, 5.4, 6.9, 12.6 at gaps of 1, .5, .05 cells; exact 6.3, 11.4, 101.9; with the film 6.2,
10.8, 102.4.

**Roughness.** Walls touch with the tips of their roughness; then their mean planes are `rough` apart. In all of the
above h is the gap + rough. Approach from y0 to touch takes a finite impulse, about ln(d / rough).

**Along the wall** the force grows as ln(h) only, and the mesh has most of it: left out. So are turns that tilt a film.

**In a step** the force is lam = - (D (rate) + E), D = theta dt k, E = (1 - theta) dt k rate0 in place of an impulse, k
the mean of k(h) along the way of the gap: then the impulses of all steps add up to that of the way, whatever the steps
are. rate = N U - s is the gap's speed at the end of the step, with rows N of flow/immersed/contact_rows.py. With
velocity W (impulse) of the bodies

    W' = W - W N^T X N W,    U*' = U* - W N^T X (N U* - s + E / D),    X = (1 / D + N W N^T)^-1

so that the matrix of the pressure stays symmetric and positive, and bodies without inertia follow the film. theta is
1 where the path has the velocity of the end. Where it has the mean of both theta is 1/2, and more where dt k would turn
the speed round, 1 - 1 / (dt k N W N^T) of the stiffest film: with V = theta U + (1 - theta) U0 the films change the
energy by - dt V^T K V - (theta - 1/2) (U - U0)^T M (U - U0), never above zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray

REACH = 2.0  # cells: there the mesh has .93 of the force of a ball (see above)
_X, _W = np.polynomial.legendre.leggauss(8)
NODES, WEIGHTS = 0.5 * (_X + 1.0)[:, None], 0.5 * _W[:, None]  # on 0 .. 1
SOLVED = 1e-3  # of the speeds at hand: what the film's impulse may miss for the way that the gap goes then
GUESSES = 12  # halved steps to the way of the gap: 2^-12 of it


class Films(NamedTuple):
    """k films between bodies. gap (k,) [length] between the tips, >= 0; strength (k,) [mass/time]: force per speed at
    this gap were it all left to the film, which goes with h^-p; power p (k,); cell (k,) [length]: width along the
    normal; rough (k,) [length]."""

    gap: Array
    strength: Array
    power: Array
    cell: Array
    rough: Array


def strength_of(curvatures: Array, h: Array, mu: float) -> Array:
    """(k,) [mass/time] 12 pi mu / ((k1 + k2) sqrt(k1 k2) h), h (k,) > 0 [length].

    curvatures (k, 2) [1/length] > 0: relative ones at this gap; mu [mass/length/time].
    """
    first, second = curvatures.T
    return 12.0 * np.pi * mu / ((first + second) * np.sqrt(first * second) * h)


def missing(h: Array, power: Array, cell: Array) -> Array:
    """(k,) share of the force that the mesh does not have. h (k,) > 0, cell (k,) > 0 [length]."""
    x = np.sqrt(2.0) * cell / h
    ball = 2.0 * (np.arctan(x) / x - 0.5 * np.log1p(x * x) / (x * x))
    strip = 8.0 / (x * x) * (np.sqrt(0.5 * (np.sqrt(1.0 + x * x) + 1.0)) - 1.0)
    plate = 1.0 / (1.0 + x * x)
    part = np.where(power == 1.0, ball, np.where(power == 1.5, strip, plate))
    return 1.0 - part


def resistance(films: Films, gap: Array) -> Array:
    """(k,) [mass/time]: force per speed at these gaps (k,); 0 from REACH cells on, constant below 0."""
    end = REACH * films.cell
    begins = _lacking(films, end + films.rough)
    return np.maximum(_lacking(films, np.clip(gap, 0.0, end) + films.rough) - begins, 0.0)


def _lacking(films: Films, h: Array) -> Array:
    """(k,) [mass/time]."""
    grown = ((films.gap + films.rough) / h) ** films.power
    return films.strength * grown * missing(h, films.power, films.cell)


def mean_resistance(films: Films, change: Array) -> Array:
    """(k,) [mass/time]: mean of `resistance` along the way from gap to gap + change (k,); none beyond touch.

    Times change it is the impulse of the whole way to rounding of the quadrature (1e-7, from .1 cells to a thousandth).
    """
    end = REACH * films.cell
    first = np.clip(films.gap, 0.0, end)
    last = films.gap + change
    way = np.clip(last, 0.0, end) - first
    a = first + films.rough
    x = way / a
    tiny = np.abs(x) < 1e-6  # below it ln(1 + x) / x is 1 - x / 2 to rounding
    log = np.log1p(x)
    per = np.where(tiny, 1.0 - 0.5 * x, log / np.where(tiny, 1.0, x)) / a
    h = a * np.exp(NODES * log)
    total = (WEIGHTS * h * resistance(films, h - films.rough)).sum(axis=0)
    whole = (films.gap < end) & (last >= 0.0) & (last <= end)  # else only a part of the way counts
    return total * per * np.where(whole, 1.0, np.clip(way / np.where(whole, 1.0, change), 0.0, 1.0))


class Squeeze:
    """Films in one step. rows N (k, 6 n), speed s (k,) of n bodies; rate0 (k,) [length/time]: the gaps' speeds at its
    start; mean: the gap goes the way of the mean of both speeds (else of that of the end)."""

    def __init__(self, films: Films, rows: Array, speed: Array, rate0: Array, dt: float, *, mean: bool) -> None:
        self.films, self.rows, self.speed, self.rate0, self.dt, self.mean = films, rows, speed, rate0, dt, mean
        self.k = np.zeros(len(rate0))
        self.theta = 1.0
        self.used = (np.zeros(len(rate0)), np.zeros(len(rate0)))  # D and E of the last `soften`

    def guess(self, W: Array, U: Array) -> None:
        """Take for k what fits the velocities U (6 n,) that all else would give; W (6 n, 6 n): inverse masses."""
        self.give = np.einsum("ij,ij->i", self.rows @ W, self.rows)
        rate, free = self.rate0, self.rows @ U - self.speed
        low, high = np.zeros(len(free)), np.ones(len(free))  # of free, between which the rate at the end is sought
        for _ in range(GUESSES):
            middle = 0.5 * (low + high)
            self._set(mean_resistance(self.films, self._way(middle * free)))
            D, E = self._factors()
            rate = (free - self.give * E) / (1.0 + self.give * D)
            too_low = rate * np.sign(free) > middle * np.abs(free)
            low, high = np.where(too_low, middle, low), np.where(too_low, high, middle)

    def _way(self, rate: Array) -> Array:
        return self.dt * (0.5 * (self.rate0 + rate) if self.mean else rate)

    def _set(self, k: Array) -> None:
        self.k = k
        if self.mean:
            stiff = float((self.dt * k * self.give).max(initial=0.0))
            self.theta = max(0.5, 1.0 - 1.0 / max(stiff, 1.0))

    def _factors(self) -> tuple[Array, Array]:
        """D and E [mass], [mass length/time]."""
        return self.theta * self.dt * self.k, (1.0 - self.theta) * self.dt * self.k * self.rate0

    def soften(self, W: Array, start: Array) -> tuple[Array, Array]:
        """W' (6 n, 6 n) and U*' (6 n,): inverse masses and velocities with the films, see above."""
        D, E = self.used = self._factors()
        some = D > 0.0
        if not some.any():
            return W, start
        N, D, E = self.rows[some], D[some], E[some]
        NW = N @ W
        X = np.linalg.inv(np.diag(1.0 / D) + NW @ N.T)
        X = 0.5 * (X + X.T)
        less = NW.T @ X
        return W - less @ NW, start - less @ (N @ start - self.speed[some] + E / D)

    def impulses(self, U: Array) -> Array:
        """(k,) along the normals, when the step ends with U (6 n,), which were found with the last `soften`."""
        D, E = self.used
        return -(D * (self.rows @ U - self.speed) + E)

    def unfit(self, U: Array) -> bool:
        """Whether the gaps went another way than was taken; k is then that of the way with U (6 n,)."""
        rate = self.rows @ U - self.speed
        self._set(mean_resistance(self.films, self._way(rate)))
        D, E = self._factors()
        off = np.abs(D * rate + E + self.impulses(U)) * self.give
        return bool((off > SOLVED * np.maximum(np.abs(rate), np.abs(self.rate0))).any())
