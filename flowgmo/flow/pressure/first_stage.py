"""What the pressure of the last step does to the velocity of Heun's first stage.

The pressure is that of the surface a step ago. Between liquid cells its gradient changes little within a step. At the
free surface it does not: there it is p over the distance to the surface, and a surface that has moved by a tenth of a
cell would push a tenth harder, up in one step and down in the next. Such a face takes the gradient of the face behind
it, on the other side of its liquid cell:

    o----g----o----|==x     the gradient at the surface x is g, as under a level surface at rest

Where there is none (liquid one cell deep) the cell beyond the surface may have been liquid when p held, or a shut void
(pockets.py): it still has its p, and the gradient was that between the two centres. Else p over the distance is all
that is known,

    dt p / (rho theta h)   but no more than  max(2 dt p / (rho h), |g| dt)

since theta may have become nothing: 2 p / h is that of a surface in the face, and liquid at rest asks for g. Without
that p over a thousandth of h made 640 m/s of 2.2 kPa, and the second stage 4e4 (hard/wet_plug_free, where a cell beside
the plug fell dry). Faces of thin cells gain more, each in its own measure (thin_cells.py).
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.face_bits import LAST, NO_BIT, first_bit, start_of, words_of
from flowgmo.flow.fields import G
from flowgmo.flow.pressure.projection import Projector, scale_liquid
from flowgmo.flow.pressure.thin_cells import ease_of_face
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.kernel import flow_kernel, inlined, inner


@inner
def _alone(q, p, factor, b, area, A, low, h, pull, own, upper):
    """What a face at the surface, between the cells own and upper (i, j, k), gains that has no liquid behind; low: the
    own cell is the liquid one."""
    inside = q[own] if low else q[upper]
    beyond = factor * (p[upper] if low else p[own])
    out = 1.0 if low else -1.0
    if beyond != 0.0:
        return out * (inside - beyond) / h
    if A is not None:
        area *= A[own]
    most = max(abs(inside) / (0.5 * h), pull)
    return out * min(max(inside * b[own] / area, -most), most)


@inlined
def _at_surface(b, areas, A, eased, q, wet, step, p, factor, h, pull, low, i, j, k):
    """What a face at the surface gains: the gradient of the face behind, or as _alone; low: the own cell is liquid."""
    di, dj, dk = step
    n = q.shape[0] * di + q.shape[1] * dj + q.shape[2] * dk
    e, f, g = i, j, k
    at = i * di + j * dj + k * dk
    if G <= at < n - G - 1:
        s = np.int64(-1 if low else 1)
        behind = b[i + s * di, j + s * dj, k + s * dk] > 0.0
        cell = np.int64(-1 if low else 2)
        if not (behind and wet[i + cell * di, j + cell * dj, k + cell * dk] != 0):
            area = areas[0][i] * areas[1][j] * areas[2][k]
            return _alone(q, p, factor, b, area, A, low, h[at], pull, (i, j, k), (i + di, j + dj, k + dk))
        e, f, g = i + s * di, j + s * dj, k + s * dk
    area = areas[0][e] * areas[1][f] * areas[2][g]
    if A is not None:
        area *= A[e, f, g]
    gained = (q[e, f, g] - q[e + di, f + dj, g + dk]) * b[e, f, g] / area
    if eased is not None:
        if e != i or f != j or g != k:
            gained /= ease_of_face(*eased, dj + 2 * dk, e, f, g)
    return gained


@inlined
def _push_amid(b, S, area_z, A, q, wet, step, up, u, i, j, k0, k1, start):
    """Faces k0 <= k < k1 amid liquid; bits, from `start` on, of those at the surface. Without a branch."""
    di, dj, _ = step
    surface = NO_BIT
    for k in range(k0, k1):
        plain = (wet[i, j, k] != 0) == (wet[i + di, j + dj, k + up] != 0)
        area = S * area_z[k]
        if A is not None:
            area *= A[i, j, k]
        gained = (q[i, j, k] - q[i + di, j + dj, k + up]) * b[i, j, k] / area
        held = b[i, j, k] > 0.0
        u[i, j, k] += gained if plain & held else 0.0
        surface |= ONE << (k - start) if held & (not plain) else NO_BIT
    return surface


@flow_kernel
def push_as_behind(columns, first, last, b, area_x, area_y, area_z, A, lines, eased, q, wet, d, p, factor, h, pull, u):
    """u -= (q_upper - q_lower) b / (A S) on the upper faces along d with b > 0, at the surface as above.

    p: of the last step, factor p = q where it was liquid; h (n,) [length]: distances of centres along d; pull
    [length/time]: |g| dt along d. lines: solid_lines.py; eased: None or what thin_cells.ease_of_face asks for.
    """
    step = np.int64(d == 0), np.int64(d == 1), np.int64(d == 2)
    di, dj, dk = step
    up = np.uint64(dk)
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        k0, k1 = np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        S = area_x[i] * area_y[j]
        ask_ahead(columns, c, last, q, di, dj)
        ask_ahead(columns, c, last, b, 0, 0)
        ask_ahead(columns, c, last, u, 0, 0)
        ask_at_solids(columns, c, last, A, lines)
        free = True
        if A is not None:
            free = lines[i, j] == 0
        for word in range(*words_of(k0, k1)):
            start = start_of(word)
            ends = max(k0, start), min(k1, start + LAST + ONE)
            if free:
                surface = _push_amid(b, S, area_z, None, q, wet, step, up, u, i, j, *ends, start)
            else:
                surface = _push_amid(b, S, area_z, A, q, wet, step, up, u, i, j, *ends, start)
            while surface != NO_BIT:
                k = start + first_bit(surface)
                surface &= surface - ONE
                low = wet[i, j, k] != 0
                areas = area_x, area_y, area_z
                u[i, j, k] += _at_surface(b, areas, A, eased, q, wet, step, p, factor, h, pull, low, i, j, np.int64(k))


def push_by_last_pressure(projector: Projector, p: np.ndarray, dt: float, velocity: list) -> None:
    """velocity -= dt grad p / rho, p [mass/length/time2] of the last step, with the present surface and sides."""
    m = projector.matrix
    projector.ease_gravity(velocity, dt)
    projector.team.run(scale_liquid, m.faces, p, dt / projector.rho, projector.wet, projector.q)
    projector.sides.fill_pressure(projector.q, dt, velocity)
    for d, u in enumerate(velocity):
        if u is not None:
            eased, A, lines = projector.eased, projector.openings[1 + d], projector.lines
            last = p, dt / projector.rho, projector.grid[3 + d], dt * abs(float(projector.sides.gravity[d]))
            args = (m.b[d], *projector.areas[d], A, lines, eased, projector.q, projector.wet, np.int64(d), *last, u)
            for columns in (m.faces, projector.lower_faces[d]):
                if columns is not None:
                    projector.team.run(push_as_behind, columns, *args)
