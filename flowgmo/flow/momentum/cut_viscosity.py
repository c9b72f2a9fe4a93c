"""Viscosity on faces near solids: the terms of viscosity.py with open fractions.

    V dq/dt = nu [ sum c_n (q_n - q) + s (q_wall - q) ],      c_n = A_n / (distance to n * width of the face's cell)

A face stands for the middle of its open part: the distance to a neighbour is that of the two open heights' middles,
(e dy + e_n dy_n) / 2, with e = V / (the part's shadow along that direction, wall_shear.py). A neighbour inside a solid
gives no stress; one on a wall square to it (0) does. Linear and parabolic profiles so come out as between walls on mesh
planes, wherever the walls cut the cells.

A sliver holds little liquid with much wall: explicitly it would need a small step. So its balance of forces is given
the inertia of a larger volume W = max(V, dt nu (sum c_n + s)), at which a step does not overshoot,

    dq/dt = (V / W) (everything + viscous terms - grad p / rho)

with the pressure of the last step; the projection adds what p gains. A sliver then follows its neighbours within a few
steps, and what is steady is so whatever the step: with W in the viscous terms alone, walls of slivers would not hold
against gravity and pressure. Below viscous_limit this changes slivers only. implicit_viscosity.py uses V itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cut_faces import ONE, U64, wet_face
from flowgmo.kernel import flow_kernel, inner

Array = np.ndarray


class CutViscosity(NamedTuple):
    """Cut faces of one component.

    rows (n, 4); c (n, 6) [1/length2] below and above along x, y, z; V (n,) [-]; s (n,) [1/length2] of solid walls;
    speed (n,) [length/time] of the walls along the component, None: at rest.
    """

    rows: Array
    c: Array
    V: Array
    s: Array
    speed: Array | None


@flow_kernel
def diffuse_cut(rows, first, last, ci, cj, ck, q, F, c, V, s, speed, factor, limit, gradient, out, change):
    """out and change (None: not wanted) += factor (sum c_n (q_n - q) + s (speed - q)) / V on cut faces.

    speed None: the walls are at rest. gradient (n,) [length/time2]: grad p / rho of the last step; with it, out holds
    all other accelerations before, and slivers are made heavier as above, W by limit = dt nu. None: by V as it is, at
    least limit * (sum c_n + s).
    """
    for r in range(first, last):
        i = U64(rows[r, 0])
        j = U64(rows[r, 1])
        k = U64(rows[r, 2])
        if not wet_face(F, i, j, k, ci, cj, ck):
            continue
        q0 = q[i, j, k]
        total = -s[r] * q0 if speed is None else s[r] * (speed[r] - q0)
        for n in range(6):
            a, b, h = _neighbour(i, j, k, n)
            if c[r, n] > 0.0 and wet_face(F, a, b, h, ci, cj, ck):
                total += c[r, n] * (q[a, b, h] - q0)
        least = s[r]
        for n in range(6):
            least += c[r, n]
        whole = max(V[r], limit * least)
        if whole > 0.0:
            if gradient is not None:
                slower = (out[i, j, k] - gradient[r]) * (min(V[r] / whole, 1.0) - 1.0)
                out[i, j, k] += slower
                if change is not None:
                    change[i, j, k] += slower
            out[i, j, k] += factor * total / whole
            if change is not None:
                change[i, j, k] += factor * total / whole


@inner
def _neighbour(i, j, k, n):
    """Neighbour n: 0, 1 below and above along x, 2, 3 along y, 4, 5 along z."""
    if n == 0:
        return i - ONE, j, k
    if n == 1:
        return i + ONE, j, k
    if n == 2:
        return i, j - ONE, k
    if n == 3:
        return i, j + ONE, k
    if n == 4:
        return i, j, k - ONE
    return i, j, k + ONE


@inner
def _height(V, A, i, j, k, ci, cj, ck, di, dj, dk):
    """Open height along d, as a share of the width, of the two cells of a face of component c; 1 where all is solid."""
    part = 0.0
    shadow = 0.0
    for e in range(2):
        a = i + U64(e) * ci
        b = j + U64(e) * cj
        h = k + U64(e) * ck
        part += V[a, b, h]
        if A is not None:
            shadow += max(V[a, b, h], max(A[a, b, h], A[a - di, b - dj, h - dk]))
    return part / shadow if shadow > 0.0 else 1.0


@inner
def _conduct_along(V, Ac, Ad, d, i, j, k, ci, cj, ck, di, dj, dk, c, r, n):
    """c[r, n] and c[r, n + 1] towards the faces below and above along d; d widths of cells in that direction."""
    own = ci * di + cj * dj + ck * dk > U64(0)
    m = i * di + j * dj + k * dk
    size = 0.5 * (d[m] + d[m + ONE]) if own else d[m]
    here = _height(V, Ad, i, j, k, ci, cj, ck, di, dj, dk)
    for side in range(2):
        up = U64(side)
        down = ONE - up
        # the neighbour, and the faces of d between it and P: below them, or on P's own cells
        a = i + di * up - di * down
        b = j + dj * up - dj * down
        h = k + dk * up - dk * down
        if not (Ac[a, b, h] > 0.0 or V[a, b, h] >= 1.0 or V[a + ci, b + cj, h + ck] >= 1.0):
            c[r, n + side] = 0.0
            continue
        if own:
            area = 0.5 * (Ac[i, j, k] + Ac[a, b, h])
            distance = d[m + up]
        else:
            e = i - di * down
            f = j - dj * down
            g = k - dk * down
            area = 0.5 * (Ad[e, f, g] + Ad[e + ci, f + cj, g + ck])
            there = _height(V, Ad, a, b, h, ci, cj, ck, di, dj, dk)
            distance = 0.5 * (here * d[m] + there * d[m + up - down])
        c[r, n + side] = area / (distance * size) if distance > 0.0 else 0.0


@flow_kernel
def conduct_cut(rows, first, last, ci, cj, ck, A, V, Ax, Ay, Az, dx, dy, dz, c, volume):
    """Fill c (n, 6) and volume (n,) of cut faces; A the areas of the component's own faces."""
    for r in range(first, last):
        i = U64(rows[r, 0])
        j = U64(rows[r, 1])
        k = U64(rows[r, 2])
        volume[r] = 0.5 * (V[i, j, k] + V[i + ci, j + cj, k + ck])
        for n in range(6):
            c[r, n] = 0.0
        if Ax is not None:
            _conduct_along(V, A, Ax, dx, i, j, k, ci, cj, ck, ONE, U64(0), U64(0), c, r, 0)
        if Ay is not None:
            _conduct_along(V, A, Ay, dy, i, j, k, ci, cj, ck, U64(0), ONE, U64(0), c, r, 2)
        if Az is not None:
            _conduct_along(V, A, Az, dz, i, j, k, ci, cj, ck, U64(0), U64(0), ONE, c, r, 4)
