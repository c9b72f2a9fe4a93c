"""Liquid beside bodies that move: what their walls give to the kinetic energy and momentum of cells that they cut.

    kinetic    rho / 2 sum of F V volume 1/2 S_b s u_d^2         over the closed faces of cells, for each direction d
    momentum   rho     sum of F V volume 1/2 S_b s u_d           s = u of the opposite face / u_d, within 0 .. 1

u_d is the component of n (n . (v + w x r)), what the wall of body b pushes in the cell as it is now, S_b its share of
the face: along its walls the liquid slips, and the spin of a ball moves nothing (body_fluxes.py). In measures.py the
velocity of a cell is the mean of its two faces, and a closed one is at rest. But liquid between a piston and the next
face moves with the piston: else half of that cell's energy would go, and come back when the piston passes a plane of
faces (.03 of all there is, each time). It does as far as s says: a plate that has come down on water, or one that was
hit, has a velocity which the liquid under it does not yet have. What the faces themselves hold of the body's velocity
is that of the step before.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.fields import Flow, Grid, Open
from flowgmo.kernel import inner, kernel

NEITHER, BALL, REVOLVED = 0, 1, 2  # what `middle` of body_fluxes says of a body


@inner
def _wall_speed(r, U, kind, middle):
    """v + w x r of a wall at r from B, without turns that move nothing (crossings.wall_speeds); triples."""
    if kind == BALL:
        r = (middle[0, 0], middle[0, 1], middle[0, 2])
    wx, wy, wz = U[3], U[4], U[5]
    vx = U[0] + wy * r[2] - wz * r[1]
    vy = U[1] + wz * r[0] - wx * r[2]
    vz = U[2] + wx * r[1] - wy * r[0]
    if kind == REVOLVED:
        ax, ay, az = middle[1, 0], middle[1, 1], middle[1, 2]
        cx, cy, cz = r[0] - middle[0, 0], r[1] - middle[0, 1], r[2] - middle[0, 2]
        about = wx * ax + wy * ay + wz * az
        vx -= about * (ay * cz - az * cy)
        vy -= about * (az * cx - ax * cz)
        vz -= about * (ax * cy - ay * cx)
    return vx, vy, vz


@inner
def _with_wall(u, A, i, j, k, m, n, o, low, high, speed):
    """Sum over the two closed faces of a cell along one direction of S_b s |u_d|; u None: 0.

    low, high: the body's shares of them, the lower one at (i - m, j - n, k - o); speed: u_d.
    """
    total = 0.0
    if u is not None:
        below, above = A[i - m, j - n, k - o], A[i, j, k]
        for upper in range(2):  # the face, and how the liquid passes the opposite one
            opened = above if upper == 1 else below
            share = min(max(high if upper == 1 else low, 0.0), 1.0) if not opened > 0.0 else 0.0
            through = 0.0
            if upper == 1 and below > 0.0:
                through = u[i - m, j - n, k - o]
            if upper == 0 and above > 0.0:
                through = u[i, j, k]
            if through * speed > 0.0:
                total += share * min(abs(through), abs(speed))
    return total


@kernel
def _sum_beside(numbers, shares, grid, centres, opened, F, u, v, w, place, U, kind, middle, out):
    """out (4,) += kinetic energy / rho, momentum / rho. centres: tuple of three (n + 4,), else as beside_body."""
    x, y, z = centres
    for c in range(len(numbers)):
        k = numbers[c] % len(z)
        j = numbers[c] // len(z) % len(y)
        i = numbers[c] // (len(z) * len(y))
        part = grid.dx[i] * grid.dy[j] * grid.dz[k] * opened.V[i, j, k]
        if F is not None:
            part *= max(F[i, j, k], 0.0)
        s = shares[c]
        ax = (s[1] - s[0]) * grid.dy[j] * grid.dz[k]
        ay = (s[3] - s[2]) * grid.dz[k] * grid.dx[i]
        az = (s[5] - s[4]) * grid.dx[i] * grid.dy[j]
        size = ax * ax + ay * ay + az * az
        if not (part > 0.0 and size > 0.0):
            continue
        r = (x[i] - place[0], y[j] - place[1], z[k] - place[2])
        wall = _wall_speed(r, U, kind, middle)
        across = (ax * wall[0] + ay * wall[1] + az * wall[2]) / size
        px, py, pz = across * ax, across * ay, across * az
        mx = part * _with_wall(u, opened.Ax, i, j, k, 1, 0, 0, s[0], s[1], px)
        my = part * _with_wall(v, opened.Ay, i, j, k, 0, 1, 0, s[2], s[3], py)
        mz = part * _with_wall(w, opened.Az, i, j, k, 0, 0, 1, s[4], s[5], pz)
        out[0] += 0.25 * (mx * abs(px) + my * abs(py) + mz * abs(pz))
        out[1] += 0.5 * (mx if px > 0.0 else -mx)
        out[2] += 0.5 * (my if py > 0.0 else -my)
        out[3] += 0.5 * (mz if pz > 0.0 else -mz)


def beside_body(
    cover: BodyCover,
    flow: Flow,
    opened: Open,
    grid: Grid,
    centres: list[np.ndarray],
    place: np.ndarray,
    U: np.ndarray,
    middle: np.ndarray | None = None,
) -> tuple[float, np.ndarray]:
    """Kinetic energy / rho [length5/time2] and momentum / rho (3,) [length4/time] beside one body.

    opened: what all bodies leave open now; centres: of cells, (n + 4,) for each direction; place (3,): B; U (6,):
    velocity of B and spin; middle: of balls and bodies of revolution, as in body_fluxes.
    """
    out, kind, turned = np.zeros(4), NEITHER, np.zeros((2, 3))
    if middle is not None:
        kind = REVOLVED if middle.ndim == 2 else BALL
        turned[: middle.ndim] = middle
    of_body = np.ascontiguousarray(place, float), np.ascontiguousarray(U, float), kind, turned
    _sum_beside(cover.numbers, cover.shares, grid, tuple(centres), opened, flow.F, *flow.velocity, *of_body, out)
    return float(out[0]), out[1:]


def beside_bodies(
    covers: list[BodyCover],
    flow: Flow,
    opened: Open,
    grid: Grid,
    centres: list[np.ndarray],
    places: np.ndarray,
    velocities: np.ndarray,
    middles: list[np.ndarray | None],
) -> tuple[float, np.ndarray]:
    """The same of all of them: places (b, 3), velocities (b, 6), middles of each."""
    kinetic, momentum = 0.0, np.zeros(3)
    for cover, place, U, middle in zip(covers, places, velocities, middles, strict=True):
        own, gained = beside_body(cover, flow, opened, grid, centres, place, U, middle)
        kinetic, momentum = kinetic + own, momentum + gained
    return kinetic, momentum
