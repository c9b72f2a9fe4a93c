"""Advection on faces near solids: the stencil of advection.py with open fractions.

FAVOR (Hirt & Sicilian 1985, A porosity technique for the definition of obstacles) divides by the open volume V of the
momentum's cell and multiplies by the open areas of its ends, so that what carries q is the flow through the opening:

    dq/dt = - [ U_r (q_r - q_P) / d_r + U_l (q_P - q_l) / d_l ] / 2,       U_r = (A u)_r / V, |U_r| <= |u|_r

Dividing by V alone, a corner cut small (A ~ V^(2/3)) would feel any speed and shorten the step: so U_r is no faster
than the faster of the two faces that it is the mean of. It is (A u)_r / V wherever flow runs along a wall (V = A).

Along its own direction, between two open faces l and r, it is also

    |U| >= |u_l + u_r| / 2  where the flow speeds up, u_r > u_l,       |U| <= |u_l + u_r| / 2  where it slows down

The pressure gives a face the inertia of A S h, whatever V is (b = A S / h): of all velocities that fit the walls a
projection takes the nearest in

    K = 1/2 rho sum over faces A S h u^2

In a slit Q = A u is the same everywhere, so that advection changes K by

    dK/dt = - rho S Q sum over ends of U (u_r - u_l),       U = (u_l + u_r) / 2:  the sum of (u_r^2 - u_l^2) / 2

The mean is what Bernoulli has: what is lost where the slit narrows comes back where it widens, and nothing is made.
With the bound at least as much is lost as that, whatever value q between u_l and u_r the end has, since both of its
differences, q - u_l and u_r - q, have the same sign. (A u) / V alone makes energy where V is large before the slit and
small in it: with A = 1, .013, .029, .045, 1 and V = 1, .33, .021, .037, .45, 1 in cells, water that comes in loses a
seventh of what it should, and gets back half of that, so that K gains .19 u^2 rho S Q, u the largest speed. Beside a
block that stands still, with a head of 8 cm, that made 2 m/s 216 within .25 s (tests/physics/test_slits.py); beside a
plug that wedged it gained 8 % a step, to 1800 m/s. Where a slit widens slowly, V = A, (A u) / V is u behind, less than
the mean: Borda's and Carnot's loss, (u_l - u_r)^2 / 2.

With max(V, A_r, A_l) for V, of both ends, water that comes into a slit through a face open to the full is hardly slowed
down either where little of the cell behind it is open: 20 J from nothing under such a block.

Where u_l and u_r go opposite ways the bounds end without a jump, so that a velocity of nothing but round-off, beside a
plane of symmetry, does not decide: the upper one is half of the faster, the lower one

    |u_l + u_r| / 2 times |A_l u_l + A_r u_r| / (A_l |u_l| + A_r |u_r|)

What is on the far side of a closed face:
* A closed face of a cell that is open to the full is a wall lying on that face: its normal velocity, which is stored
  there (0), is the truth. Water that comes down a wall and turns round its edge carries none of it along the edge.
  So it is while liquid touches it: over air it says nothing, and would hold back liquid that moves away.
* Any other closed face lies inside a solid and holds nothing. There q_P itself is taken, so that a uniform stream
  along an oblique wall stays uniform.
"""

from __future__ import annotations

import math

from flowgmo.flow.favor.cut_faces import STEPS, U64, wet_face
from flowgmo.flow.momentum.upstream import end_value
from flowgmo.kernel import flow_kernel, inlined, inner

(X, _, _), (_, Y, _), (_, _, Z) = STEPS
NO = U64(0)


DRY = 1e-6  # F up to which a cell counts as dry: what rests there takes no part (liquid.DUST)


@inner
def _known(q, A, V, F, i, j, k, ci, cj, ck, otherwise):
    """q of a face of component c, or `otherwise` where it lies inside a solid or on a dry wall."""
    if A[i, j, k] > 0.0:
        return q[i, j, k]
    if V[i, j, k] >= 1.0 or V[i + ci, j + cj, k + ck] >= 1.0:
        if F is None:
            return q[i, j, k]
        return q[i, j, k] if max(F[i, j, k], F[i + ci, j + cj, k + ck]) > DRY else otherwise
    return otherwise


@inner
def _carried(flow, V, area, u, area_next, u_next):
    """flow / V, but no faster than the two faces that it comes through."""
    most = max(abs(u) if area > 0.0 else 0.0, abs(u_next) if area_next > 0.0 else 0.0)
    return min(max(flow / V, -most), most)


@inner
def _without_gain(U, flow_low, u_low, flow_high, u_high):
    """U between two open faces with velocities u_low and u_high along it, and flows, bound by their mean as above."""
    mean = 0.5 * abs(u_low + u_high)
    if u_high > u_low:
        through = abs(flow_low) + abs(flow_high)
        least = mean * abs(flow_low + flow_high) / through if through > 0.0 else 0.0
        return math.copysign(max(abs(U), least), U)
    return math.copysign(min(abs(U), max(mean, 0.5 * max(abs(u_low), abs(u_high)))), U)


@inlined
def _along(q, A, V, F, vel, Ad, i, j, k, ci, cj, ck, di, dj, dk, ends, slopes, m, g):
    """U dq/dd on face P = (i, j, k) of component c; d the direction of vel, m P's index along it, g as in advect."""
    q0 = q[i, j, k]
    above = _known(q, A, V, F, i + di, j + dj, k + dk, ci, cj, ck, q0)
    below = _known(q, A, V, F, i - di, j - dj, k - dk, ci, cj, ck, q0)
    above2 = _known(q, A, V, F, i + di + di, j + dj + dj, k + dk + dk, ci, cj, ck, above)
    below2 = _known(q, A, V, F, i - di - di, j - dj - dj, k - dk - dk, ci, cj, ck, below)
    a = i - di
    b = j - dj
    h = k - dk
    upper = (1.0 - g) * Ad[i, j, k]
    upper_next = g * Ad[i + ci, j + cj, k + ck]
    lower = (1.0 - g) * Ad[a, b, h]
    lower_next = g * Ad[a + ci, b + cj, h + ck]
    flow_upper, flow_upper_next = upper * vel[i, j, k], upper_next * vel[i + ci, j + cj, k + ck]
    flow_lower, flow_lower_next = lower * vel[a, b, h], lower_next * vel[a + ci, b + cj, h + ck]
    open_volume = (1.0 - g) * V[i, j, k] + g * V[i + ci, j + cj, k + ck]
    if not open_volume > 0.0:
        return 0.0
    U_upper = flow_upper + flow_upper_next
    U_lower = flow_lower + flow_lower_next
    U_upper = _carried(U_upper, open_volume, upper, vel[i, j, k], upper_next, vel[i + ci, j + cj, k + ck])
    U_lower = _carried(U_lower, open_volume, lower, vel[a, b, h], lower_next, vel[a + ci, b + cj, h + ck])
    if ci * di + cj * dj + ck * dk > NO:
        if upper > 0.0 and upper_next > 0.0:
            U_upper = _without_gain(U_upper, flow_upper, q0, flow_upper_next, above)
        if lower > 0.0 and lower_next > 0.0:
            U_lower = _without_gain(U_lower, flow_lower, below, flow_lower_next, q0)
    q_upper = end_value(U_upper, below, q0, above, above2, slopes, m)
    q_lower = end_value(U_lower, below2, below, q0, above, slopes, m - U64(1))
    return U_upper * (q_upper - q0) * ends.upper[m] + U_lower * (q0 - q_lower) * ends.lower[m]


@flow_kernel
def advect_cut(rows, first, last, ci, cj, ck, q, A, F, out, u, v, w, V, Ax, Ay, Az, far, ends, slopes):
    """out -= (u . grad) q on wet cut faces, rows (n, 4); other arguments as of advection.advect."""
    for r in range(first, last):
        i = U64(rows[r, 0])
        j = U64(rows[r, 1])
        k = U64(rows[r, 2])
        if not wet_face(F, i, j, k, ci, cj, ck):
            continue
        g = far[i * ci + j * cj + k * ck]
        total = 0.0
        if u is not None:
            own = 0.5 if ci > NO else g
            total += _along(q, A, V, F, u, Ax, i, j, k, ci, cj, ck, X, NO, NO, ends[0], slopes[0], i, own)
        if v is not None:
            own = 0.5 if cj > NO else g
            total += _along(q, A, V, F, v, Ay, i, j, k, ci, cj, ck, NO, Y, NO, ends[1], slopes[1], j, own)
        if w is not None:
            own = 0.5 if ck > NO else g
            total += _along(q, A, V, F, w, Az, i, j, k, ci, cj, ck, NO, NO, Z, ends[2], slopes[2], k, own)
        out[i, j, k] -= total
