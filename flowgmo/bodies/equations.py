"""Equations of motion of bodies without a closed form: control loads, fixed points and axes, mixed components.

    m dv/dt = F                       on the coupled translations, space axes;  v_P(t) prescribed on the others
    I_FF dw_F/dt = (T - w × I w)_F - I_FP dw_P/dt      coupled rotations F, prescribed P, body axes, about B
    dq/dt = ½ q w                     about a fixed point I, T are those about the point and v follows from w
    J d²θ/dt² = a · T                 about a fixed axis a

Every prescribed component needs a residual load to keep it; its work and that of the control loads are carried along.
"""

from __future__ import annotations

from flowgmo.bodies.laws import rate, value
from flowgmo.kernel import inner
from flowgmo.vectors import (
    add,
    cross,
    dot,
    normalized,
    product,
    rotate,
    scale,
    sub,
    turned,
    unrotate,
)

# y: displacement of B (3), q (4), v (3), w body axes (3), work of loads, work of what is prescribed.
# Fixed axis: angle turned in y[0], its rate in y[7].
X, Q, V, W, LOADS, DRIVE, SIZE = 0, 3, 7, 10, 13, 14, 15


@inner
def _three(laws, k, t):
    """Values of three laws as a triple."""
    return (value(laws, k[0], t), value(laws, k[1], t), value(laws, k[2], t))


@inner
def control_loads(body, laws, t, q):
    """Control force (space axes) and torque about B (body axes) at time t, attitude q; triples."""
    f = _three(laws, body.force, t)
    m = _three(laws, body.torque, t)
    if body.load_in_body:
        f = rotate(q, f)
    else:
        m = unrotate(q, m)
    for j in range(body.first_load, body.last_load):
        load = laws.loads[j]
        p = _three(laws, load.law, t)
        if load.in_body:
            m = add(m, cross(load.arm, p))
            p = rotate(q, p)
        else:
            m = add(m, cross(load.arm, unrotate(q, p)))
        f = add(f, p)
    return f, m


@inner
def inertia_about(body):
    """The six different entries xx yy zz xy xz yz of the tensor about B, or about the fixed point (Steiner)."""
    i = body.inertia
    xx, yy, zz, xy, xz, yz = i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]
    if body.hinge == 2:
        a = body.arm
        m = body.mass
        xx += m * (a[1] * a[1] + a[2] * a[2])
        yy += m * (a[0] * a[0] + a[2] * a[2])
        zz += m * (a[0] * a[0] + a[1] * a[1])
        xy -= m * a[0] * a[1]
        xz -= m * a[0] * a[2]
        yz -= m * a[1] * a[2]
    return (xx, yy, zz, xy, xz, yz)


@inner
def tensor_times(i, x):
    """Symmetric tensor (six entries) times triple."""
    return (
        i[0] * x[0] + i[3] * x[1] + i[4] * x[2],
        i[3] * x[0] + i[1] * x[1] + i[5] * x[2],
        i[4] * x[0] + i[5] * x[1] + i[2] * x[2],
    )


@inner
def solve_free(i, free, r):
    """x with (I x)_F = r_F on the free components F, zero elsewhere: the inverse of the free-free block (Cramer)."""
    f0, f1, f2 = free[3] != 0, free[4] != 0, free[5] != 0
    a, b, c = (i[0] if f0 else 1.0), (i[1] if f1 else 1.0), (i[2] if f2 else 1.0)
    d = i[3] if f0 and f1 else 0.0
    e = i[4] if f0 and f2 else 0.0
    f = i[5] if f1 and f2 else 0.0
    r0, r1, r2 = (r[0] if f0 else 0.0), (r[1] if f1 else 0.0), (r[2] if f2 else 0.0)
    m00, m01, m02 = b * c - f * f, e * f - d * c, d * f - b * e
    m11, m12, m22 = a * c - e * e, d * e - a * f, a * b - d * d
    det = a * m00 + d * m01 + e * m02
    return (
        (m00 * r0 + m01 * r1 + m02 * r2) / det,
        (m01 * r0 + m11 * r1 + m12 * r2) / det,
        (m02 * r0 + m12 * r1 + m22 * r2) / det,
    )


@inner
def accelerations(body, laws, t, q, w, free, after):
    """Accelerations of a body and the loads that keep what is prescribed; all triples.

    q, w tuples (w in body axes); free (6,) nonzero where a component is solved for; after: at a kink of a prescribed
    velocity, take the motion behind it, not the one that led there.
    Returns dv/dt (space axes), dw/dt (body axes), residual force and torque on the components that are not free,
    control force and torque. About a fixed point the torques are about that point and there are no forces.
    """
    f, m = control_loads(body, laws, t, q)
    weight = scale(body.mass, body.gravity)
    force = add(f, weight)
    torque = m
    if body.hinge == 2:
        # a force at the mass centre turns about the point; the given total torque is already about it
        torque = add(m, cross(body.arm, unrotate(q, force)))
        m = add(m, cross(body.arm, unrotate(q, f)))
        f = (0.0, 0.0, 0.0)
    driven = (
        0.0 if free[0] else rate(laws, body.drive[0], t, after),
        0.0 if free[1] else rate(laws, body.drive[1], t, after),
        0.0 if free[2] else rate(laws, body.drive[2], t, after),
    )
    dv = (
        force[0] / body.mass if free[0] else driven[0],
        force[1] / body.mass if free[1] else driven[1],
        force[2] / body.mass if free[2] else driven[2],
    )
    dw = (
        0.0 if free[3] else rate(laws, body.drive[3], t, after),
        0.0 if free[4] else rate(laws, body.drive[4], t, after),
        0.0 if free[5] else rate(laws, body.drive[5], t, after),
    )
    inertia = inertia_about(body)
    gyro = cross(w, tensor_times(inertia, w))
    dw = add(dw, solve_free(inertia, free, sub(sub(torque, gyro), tensor_times(inertia, dw))))
    lacking = sub(add(tensor_times(inertia, dw), gyro), torque)
    kept = (
        0.0 if free[3] else lacking[0],
        0.0 if free[4] else lacking[1],
        0.0 if free[5] else lacking[2],
    )
    held = (0.0, 0.0, 0.0)
    if body.hinge == 0:
        held = (
            0.0 if free[0] else body.mass * dv[0] - force[0],
            0.0 if free[1] else body.mass * dv[1] - force[1],
            0.0 if free[2] else body.mass * dv[2] - force[2],
        )
    return dv, dw, held, kept, f, m


@inner
def hinge_acceleration(body, laws, t, angle):
    """d²θ/dt² of a body on a fixed axis at `angle` [rad], and the control loads' moment about the axis."""
    a = (body.axis[0], body.axis[1], body.axis[2])
    q = turned((1.0, 0.0, 0.0, 0.0), scale(angle, a))
    f, m = control_loads(body, laws, t, q)
    arm = rotate(q, body.arm)
    given = dot(a, cross(arm, f)) + dot(a, rotate(q, m))
    weight = dot(a, cross(arm, scale(body.mass, body.gravity)))
    return (given + weight) / body.hinge_moment, given


@inner
def derivative(body, laws, t, y, angle, free, after, dy):
    for k in range(SIZE):
        dy[k] = 0.0
    if body.hinge == 1:
        bend, given = hinge_acceleration(body, laws, t, angle + y[X])
        dy[V] = bend
        dy[X] = y[V]
        dy[LOADS] = given * y[V]
        return
    _free_derivative(body, laws, laws.forced, t, y, free, after, dy)


@inner
def _free_derivative(body, laws, forced, t, y, free, after, dy):
    if forced is None:
        return
    q = normalized((y[Q], y[Q + 1], y[Q + 2], y[Q + 3]))
    v = (
        y[V] if free[0] else value(laws, body.drive[0], t),
        y[V + 1] if free[1] else value(laws, body.drive[1], t),
        y[V + 2] if free[2] else value(laws, body.drive[2], t),
    )
    w = (
        y[W] if free[3] else value(laws, body.drive[3], t),
        y[W + 1] if free[4] else value(laws, body.drive[4], t),
        y[W + 2] if free[5] else value(laws, body.drive[5], t),
    )
    if body.mass > 0.0:
        dv, dw, held, kept, f, m = accelerations(body, laws, t, q, w, free, after)
        dy[LOADS] = dot(f, v) + dot(m, w)
        dy[DRIVE] = dot(held, v) + dot(kept, w)
        for k in range(3):
            dy[V + k] = dv[k]
            dy[W + k] = dw[k]
    if body.hinge == 0:
        for k in range(3):
            dy[X + k] = v[k]
    dq = product(q, (0.0, w[0], w[1], w[2]))
    for k in range(4):
        dy[Q + k] = 0.5 * dq[k]
