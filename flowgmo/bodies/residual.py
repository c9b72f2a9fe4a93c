"""The load that keeps a prescribed motion: what is missing in the equations of motion of a driven body with mass.

    F = m a - m g - F_control        T = I dw/dt + w × I w - T_control    about B

with the acceleration of B from that of the driven point, a = a_ref + α × r + ω × (ω × r). Components that are solved
for need no residual and have none. At a kink of a table: the motion that led there; at t = 0 the one that begins.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import DRIVEN, FORCED
from flowgmo.bodies.equations import accelerations, control_loads, inertia_about, tensor_times
from flowgmo.bodies.laws import rate
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import add, along, cross, dot, put, quad, rotate, scale, sub, triple, unrotate


@inner
def residual_load(body, row, laws, t):
    """Residual force and torque (triples) of a body at time t, space axes, torque about B; zeros where none
    is needed."""
    zero = (0.0, 0.0, 0.0)
    if body.mass == 0.0 or (body.motion != DRIVEN and body.motion != FORCED):
        return zero, zero
    q, w = quad(row.q), triple(row.w)
    w_B = unrotate(q, w)
    solved = 0
    for k in range(6):
        solved += body.coupled[k]
    if solved > 0:
        return _partly_kept(body, laws, laws.forced, t, q, w_B)
    alpha_B, a = _driven_acceleration(body, row, laws, t, q, w)
    f, m = control_loads(body, laws, t, q)
    force = sub(along(scale(body.mass, a), -body.mass, body.gravity), f)
    inertia = inertia_about(body)
    if body.hinge == 2:  # the tensor about B, not about the point
        i = body.inertia
        inertia = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
    if body.hinge == 1 and inertia[0] + inertia[1] + inertia[2] == 0.0:
        return force, sub(scale(_moment_about_B(body), rotate(q, alpha_B)), rotate(q, m))
    torque = sub(add(tensor_times(inertia, alpha_B), cross(w_B, tensor_times(inertia, w_B))), m)
    return force, rotate(q, torque)


@inner
def _partly_kept(body, laws, forced, t, q, w_B):
    """Of a body of which some components are solved for (it is then one of the forced)."""
    if forced is None:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    _, _, held, kept, _, _ = accelerations(body, laws, t, q, w_B, body.coupled, t <= 0.0)
    return held, rotate(q, kept)


@inner
def _moment_about_B(body):
    """Of a body of which only the moment about its fixed axis is given: J - m d² (Steiner)."""
    lever = cross(triple(body.axis), triple(body.arm))
    return body.hinge_moment - body.mass * dot(lever, lever)


@inner
def _driven_acceleration(body, row, laws, t, q, w):
    """dw/dt (body axes), acceleration of B (space axes) of a prescribed body; a body that waits at a stop has none."""
    if body.hinge == 1:
        spin = rate(laws, body.drive[3], t, t <= 0.0)
        if body.stopped and w[0] == 0.0 and w[1] == 0.0 and w[2] == 0.0:
            spin = 0.0
        alpha = scale(spin, triple(body.axis))
        alpha_B = unrotate(q, alpha)
        a = (0.0, 0.0, 0.0)
    else:
        alpha_B = (
            rate(laws, body.drive[3], t, t <= 0.0),
            rate(laws, body.drive[4], t, t <= 0.0),
            rate(laws, body.drive[5], t, t <= 0.0),
        )
        alpha = rotate(q, alpha_B)
        a = (_push_of(body, row, laws, 0, t), _push_of(body, row, laws, 1, t), _push_of(body, row, laws, 2, t))
    arm = rotate(q, body.arm) if body.hinge else scale(-1.0, rotate(q, body.reference))
    return alpha_B, add(a, add(cross(alpha, arm), cross(w, cross(w, arm))))


@inner
def _push_of(body, row, laws, k, t):
    limited = np.isfinite(body.lo[k]) or np.isfinite(body.hi[k])
    return 0.0 if body.hinge == 2 or (limited and row.v[k] == 0.0) else rate(laws, body.drive[k], t, t <= 0.0)


@kernel
def residual_rows(A, laws, asked, rows, rows_force, rows_torque):
    """Residual loads of all bodies at all asked times: rows (k, n) POSE into rows_force, rows_torque (k, n, 3)."""
    for r in range(asked.size):
        for b in range(A.size):
            force, torque = residual_load(A[b], rows[r, b], laws, asked[r])
            put(rows_force[r, b], force)
            put(rows_torque[r, b], torque)
