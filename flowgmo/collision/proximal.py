"""One proximal step of all contacts of a group, a semismooth Newton method over its bodies.

See contact_newton.py for what it is for. In the scaled coordinates of links.py find y with, ρ = stiff/k of a contact,

    F(y) = y - sum Gᵀ p(z) = 0        z = p_k - ρ u(y)

clip      p = clip(z): Coulomb's law (Alart & Curnier 1991). Its slope is not symmetric where a contact slides.
convex    p = project(z - ρ μ |u_t| n), the nearest point of Coulomb's cone (De Saxcé & Feng 1998), with μ |u_t| held
          at its last value: F is the gradient of the strictly convex ½|y|² + sum |p|²/(2ρ), and Newton steps, halved
          until that falls, always end at the solution. Where μ |u_t| is that of the solution, so is p.

Newton: (1 + sum Gᵀ ρ D G) δ = -F with D the slope of the map, d = z_t/|z_t|:

    open 0      sticks 1      slides  w nᵀ + (p_t/|z_t|)(1 - n nᵀ - d dᵀ)             clip,    w = n + μ d
                                      w wᵀ/(1 + μ²) + the same                        convex
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.banded import factor, substitute
from flowgmo.collision.links import OPEN, ROUND_OFF, SLIDES, STICKS, add_impulse, clip, velocity
from flowgmo.kernel import inner
from flowgmo.vectors import add, along, dot, norm, put, scale, sub, triple

INNER = 8  # Newton steps of a proximal step: those that succeed take 1 to 4 near the solution
SHORTER = 4  # halvings of a step where no merit is sure to fall
MOST_CONVEX, SHORTEST = 12, 10  # steps and halvings of a convex one
LOOSE = 0.1  # of what F was, divided by ρ k: what F leaves is then below what the proximal step leaves


@inner
def project(z, n, mu):
    """Nearest point of Coulomb's cone, and its state."""
    zn = dot(z, n)
    t = sub(z, scale(zn, n))
    size = norm(t)
    if size <= mu * zn:
        return z, STICKS
    if zn <= -mu * size:
        return (0.0, 0.0, 0.0), OPEN
    pn = (zn + mu * size) / (1.0 + mu * mu)
    return add(scale(pn, n), scale(mu * pn / size, t)), SLIDES


@inner
def trial(link, slots, stiff, convex):
    """z of a contact."""
    z = sub(triple(link.base), scale(stiff / link.k, velocity(slots, link)))
    return along(z, -stiff / link.k * link.shift, triple(link.n)) if convex else z


@inner
def map_all(links, slots, group, stiff, convex):
    """Write p, states and F at y; returns |F|², and the merit: the convex function, or |F|² again."""
    for s in range(group.low, group.high):
        for k in range(6):
            slots[s].f[k] = slots[s].y[k]
    total = 0.0
    for c in range(group.first, group.last):
        link = links[c]
        if link.k > 0.0:
            z = trial(link, slots, stiff, convex)
            p, state = project(z, triple(link.n), link.mu) if convex else clip(z, triple(link.n), link.mu)
            put(link.p, p)
            link.state = state
            if state != OPEN:
                total += 0.5 * link.k / stiff * dot(p, p)
                if link.a >= 0:
                    add_impulse(slots[link.a].f, link.ga, scale(-1.0, p))
                if link.b >= 0:
                    add_impulse(slots[link.b].f, link.gb, scale(-1.0, p))
    square = 0.0
    for s in range(group.low, group.high):
        for k in range(6):
            square += slots[s].f[k] * slots[s].f[k]
            total += 0.5 * slots[s].y[k] * slots[s].y[k]
    return square, total if convex else square


@inner
def fill_slope(d, link, slots, stiff, convex):
    """Write ρ D (3, 3) of a contact that is not open."""
    rho = stiff / link.k
    if link.state == STICKS:
        for i in range(3):
            for j in range(3):
                d[i, j] = rho if i == j else 0.0
        return
    n = triple(link.n)
    z = trial(link, slots, stiff, convex)
    t = sub(z, scale(dot(z, n), n))
    size = norm(t)
    t = scale(1.0 / size, t)
    s = link.mu * dot(triple(link.p), n) / size
    left = along(n, link.mu, t)
    right = scale(1.0 / (1.0 + link.mu * link.mu), left) if convex else n
    for i in range(3):
        for j in range(3):
            d[i, j] = rho * (left[i] * right[j] - s * (n[i] * n[j] + t[i] * t[j]))
        d[i, i] += rho * s


@inner
def assemble(links, slots, group, matrix, stiff, convex):
    """Write the matrix 1 + sum Gᵀ ρ D G in bands, and what each contact was taken for."""
    d, dg, reach = matrix.d, matrix.dg, matrix.reach
    a = matrix.a.reshape(matrix.a.size)  # entry (i, j) is a[3 reach i + reach + j]
    for i in range(a.size):
        a[i] = 0.0
    for i in range(6 * (group.high - group.low)):
        matrix.ends[i] = i
        a[(3 * reach + 1) * i + reach] = 1.0
    for c in range(group.first, group.last):
        link = links[c]
        link.matrix = link.state
        if link.state != OPEN:
            fill_slope(d, link, slots, stiff, convex)
            for col, gc in ((link.a, link.ga), (link.b, link.gb)):
                if col >= 0:
                    for i in range(3):
                        for k in range(6):
                            dg[i, k] = d[i, 0] * gc[0, k] + d[i, 1] * gc[1, k] + d[i, 2] * gc[2, k]
                    for row, gr in ((link.a, link.ga), (link.b, link.gb)):
                        if row >= 0:
                            for q in range(6):
                                i = 6 * (row - group.low) + q
                                at = 3 * reach * i + reach + 6 * (col - group.low)
                                matrix.ends[i] = max(matrix.ends[i], 6 * (col - group.low) + 5)
                                for k in range(6):
                                    a[at + k] += gr[0, q] * dg[0, k] + gr[1, q] * dg[1, k] + gr[2, q] * dg[2, k]


@inner
def line_search(links, slots, group, matrix, merit, stiff, convex):
    """y against the step matrix.x, halved until the merit falls (the last try is kept); returns |F|² and merit."""
    x = matrix.x
    slope = 0.0  # of the convex function along -x
    for s in range(group.low, group.high):
        for k in range(6):
            slots[s].step[k] = slots[s].y[k]
            slope += slots[s].f[k] * x[6 * (s - group.low) + k]
    t = 1.0
    square = 0.0
    now = 0.0
    for _ in range(SHORTEST if convex else SHORTER):
        for s in range(group.low, group.high):
            for k in range(6):
                slots[s].y[k] = slots[s].step[k] - t * x[6 * (s - group.low) + k]
        square, now = map_all(links, slots, group, stiff, convex)
        if convex:
            # a hundredth of what the slope promises; the merit itself carries round-off
            if now <= merit - 0.01 * t * slope + 4.0 * ROUND_OFF * abs(merit):
                break
        elif now < (1.0 - 0.1 * t) * merit:  # a tenth of what a linear F would give
            break
        t *= 0.5
    return square, now


@inner
def unchanged(links, group):
    """Whether the last factors serve: same states, and none slides."""
    for c in range(group.first, group.last):
        if links[c].state != links[c].matrix or links[c].state == SLIDES:
            return False
    return True


@inner
def round_off(links, group, stiff):
    """What |F| cannot fall below: that of k p, and that of u times ρ."""
    most = 0.0
    for c in range(group.first, group.last):
        link = links[c]
        if link.k > 0.0:
            size = link.k * norm(triple(link.p)) + stiff * norm(triple(link.u0))
            most = max(most, size / np.sqrt(link.k))
    return ROUND_OFF * most


@inner
def proximal_step(links, slots, group, matrix, stiff, convex):
    """Solve F(y) = 0. Returns the number of Newton steps, and whether it is solved; y, p and F hold what was reached.

    matrix.made [0]: the stiffness that its factors are for, 0 where they serve nothing.
    """
    square, merit = map_all(links, slots, group, stiff, convex)
    first = square
    if convex:
        matrix.made[0] = 0.0
    n = 6 * (group.high - group.low)
    most = MOST_CONVEX if convex else INNER
    count = np.int64(0)
    done = False
    while count < most and not done:
        if matrix.made[0] != stiff or not unchanged(links, group):
            assemble(links, slots, group, matrix, stiff, convex)
            factor(matrix.a, n, matrix.reach, matrix.rows, matrix.ends)
            matrix.made[0] = stiff
        for s in range(group.low, group.high):
            for k in range(6):
                matrix.x[6 * (s - group.low) + k] = slots[s].f[k]
        substitute(matrix.a, n, matrix.reach, matrix.rows, matrix.ends, matrix.x)
        square, merit = line_search(links, slots, group, matrix, merit, stiff, convex)
        count += 1
        enough = LOOSE / max(stiff, 1.0) * np.sqrt(first)
        done = np.sqrt(square) <= max(enough, round_off(links, group, stiff))
    if convex:
        matrix.made[0] = 0.0
    return count, done
