"""Bodies whose motion has no closed form: control loads, fixed points and axes, partly prescribed velocities.

    m dv/dt = F                       on the coupled translations, space axes;  v_P(t) prescribed on the others
    I_FF dw_F/dt = (T - w × I w)_F - I_FP dw_P/dt      coupled rotations F, prescribed P, body axes, about B
    dq/dt = ½ q w                     about a fixed point I, T are those about the point and v follows from w
    J d²θ/dt² = a · T                 about a fixed axis a

Every prescribed component needs a residual load to keep it; its work and that of the control loads are integrated
along. Dormand & Prince's 8(5,3) pair with steps that end at the kinks of the tables (Hairer, Nørsett & Wanner 1993,
II.5; coefficients as tabulated in scipy).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.integrate import DOP853

from flowgmo.bodies.laws import next_kink, rate, value
from flowgmo.bodies.rotation import cross, dot, norm, product, rotate, turned, unrotate

_A = np.ascontiguousarray(DOP853.A[: DOP853.n_stages, : DOP853.n_stages])
_B = np.ascontiguousarray(DOP853.B)
_C = np.ascontiguousarray(DOP853.C[: DOP853.n_stages])
_E3 = np.ascontiguousarray(DOP853.E3)
_E5 = np.ascontiguousarray(DOP853.E5)
STAGES = len(_C)
TOLERANCE = 1e-12  # local error relative to the change in a step: 1e-9 and better over thousands of steps
MAX_SUBSTEPS = 1_000_000  # a step that needs more is given up with an error, not a hang

# y: displacement of B (3), q (4), v (3), w body axes (3), work of loads, work of what is prescribed.
# Fixed axis: angle turned in y[0], its rate in y[7].
X, Q, V, W, LOADS, DRIVE, SIZE = 0, 3, 7, 10, 13, 14, 15


@njit(cache=True)
def loads_on(b, A, laws, t, q, force, torque):
    """Add gravity and control loads on body b at time t: force (3,) space axes, torque (3,) about B, body axes.

    Returns the control part of both (6,), which the work of the loads needs.
    """
    f = np.zeros(3)
    m = np.zeros(3)
    for k in range(3):
        f[k] = value(laws, A.force[b, k], t)
        m[k] = value(laws, A.torque[b, k], t)
    if A.load_in_body[b]:
        f = rotate(q, f)
    else:
        m = unrotate(q, m)
    for j in range(A.first_load[b], A.first_load[b + 1]):
        p = np.array([value(laws, A.load_law[j, 0], t), value(laws, A.load_law[j, 1], t), value(laws, A.load_law[j, 2], t)])
        p_B = p if A.load_axes[j] else unrotate(q, p)
        f = f + (rotate(q, p) if A.load_axes[j] else p)
        m = m + cross(A.load_arm[j], p_B)
    control = np.zeros(6)
    control[:3] = f
    control[3:] = m
    force += f + A.mass[b] * A.gravity
    torque += m
    return control


@njit(cache=True)
def accelerations(b, A, laws, t, q, w, free, after):
    """dv/dt (3,) space axes, dw/dt (3,) body axes, residual force, residual torque, control loads (6,) of body b.

    q, w (3,) body axes; free (6,) True where a component is solved for; the residuals keep the other components;
    after: at a kink of a prescribed velocity, take the motion behind it, not the one that led there.
    A torque on a body about a fixed point is about that point.
    """
    force = np.zeros(3)
    torque = np.zeros(3)
    control = loads_on(b, A, laws, t, q, force, torque)
    inertia = A.inertia[b]
    if A.hinge[b] == 2:
        arm = A.arm[b]
        inertia = inertia + A.mass[b] * (dot(arm, arm) * np.eye(3) - np.outer(arm, arm))
        # a force at the mass centre turns about the point; the given total torque is already about it
        torque = torque + cross(arm, unrotate(q, force))
        control[3:] += cross(arm, unrotate(q, control[:3]))
        control[:3] = 0.0
    dv = np.zeros(3)
    for k in range(3):
        dv[k] = force[k] / A.mass[b] if free[k] else rate(laws, A.drive[b, k], t, after)
    dw = np.zeros(3)
    for k in range(3):
        if not free[3 + k]:
            dw[k] = rate(laws, A.drive[b, 3 + k], t, after)
    gyro = cross(w, inertia @ w)
    right = torque - gyro - inertia @ dw
    matrix = np.eye(3)
    for i in range(3):
        if free[3 + i]:
            for j in range(3):
                if free[3 + j]:
                    matrix[i, j] = inertia[i, j]
        else:
            right[i] = 0.0
    turn = np.linalg.solve(matrix, right)
    dw = dw + turn
    residual = np.zeros(6)
    if A.hinge[b] == 0:
        residual[:3] = A.mass[b] * dv - force
    residual[3:] = inertia @ dw + gyro - torque
    for k in range(6):
        if free[k]:
            residual[k] = 0.0
    return dv, dw, residual, control


@njit(cache=True)
def hinge_acceleration(b, A, laws, t, angle):
    """d²θ/dt² of a body on a fixed axis, and the control loads' moment about the axis."""
    a = A.axis[b]
    q = turned(np.array([1.0, 0.0, 0.0, 0.0]), angle * a)
    force = np.zeros(3)
    torque = np.zeros(3)
    control = loads_on(b, A, laws, t, q, force, torque)
    arm = rotate(q, A.arm[b])
    moment = dot(a, cross(arm, force)) + dot(a, rotate(q, torque))
    given = dot(a, cross(arm, control[:3])) + dot(a, rotate(q, control[3:]))
    return moment / A.hinge_moment[b], given


@njit(cache=True)
def _derivative(b, A, laws, t, y, angle, free, after, dy):
    dy[:] = 0.0
    if A.hinge[b] == 1:
        dy[V], given = hinge_acceleration(b, A, laws, t, angle + y[X])
        dy[X] = y[V]
        dy[LOADS] = given * y[V]
        return
    q = y[Q : Q + 4] / np.sqrt(np.sum(y[Q : Q + 4] ** 2))
    v = y[V : V + 3].copy()
    w = y[W : W + 3].copy()
    for k in range(3):
        if not free[k]:
            v[k] = value(laws, A.drive[b, k], t)
        if not free[3 + k]:
            w[k] = value(laws, A.drive[b, 3 + k], t)
    dv = np.zeros(3)
    dw = np.zeros(3)
    if A.mass[b] > 0.0:
        dv, dw, residual, control = accelerations(b, A, laws, t, q, w, free, after)
        dy[LOADS] = dot(control[:3], v) + dot(control[3:], w)
        dy[DRIVE] = dot(residual[:3], v) + dot(residual[3:], w)
    if A.hinge[b] == 0:
        dy[X : X + 3] = v
    dy[Q : Q + 4] = 0.5 * product(q, np.array([0.0, w[0], w[1], w[2]]))
    dy[V : V + 3] = dv
    dy[W : W + 3] = dw


@njit(cache=True)
def _kink_after(b, A, laws, t):
    at = np.inf
    for k in range(6):
        at = min(at, next_kink(laws, A.drive[b, k], t))
    for k in range(3):
        at = min(at, next_kink(laws, A.force[b, k], t), next_kink(laws, A.torque[b, k], t))
    for j in range(A.first_load[b], A.first_load[b + 1]):
        for k in range(3):
            at = min(at, next_kink(laws, A.load_law[j, k], t))
    return at


@njit(cache=True)
def _group(y, i, n):
    s = 0.0
    for k in range(i, i + n):
        s += y[k] * y[k]
    return np.sqrt(s)


@njit(cache=True)
def integrate(b, A, laws, t0, t1, y, angle, free):
    """y (SIZE,) of body b from t0 to t1, in place; `angle` where a fixed-axis body stands at y[X] = 0.

    Returns False if the step size collapsed.
    """
    K = np.zeros((STAGES + 1, SIZE))
    work = np.zeros(SIZE)
    scale = np.ones(SIZE)
    t = t0
    h = t1 - t0
    _derivative(b, A, laws, t, y, angle, free, True, K[0])
    fast = _group(y, W, 3) + np.sqrt(_group(K[0], W, 3)) + abs(y[V]) * A.hinge[b] + np.sqrt(abs(K[0, V])) * A.hinge[b]
    if fast * h > 0.5 and A.hinge[b] > 0 or _group(y, W, 3) * h > 0.5:
        h = 0.5 / fast  # half a radian at first
    for _ in range(MAX_SUBSTEPS):
        if t >= t1:
            return True
        kink = _kink_after(b, A, laws, t)
        stop = min(t1, kink)
        step = min(h, stop - t)
        last = step >= stop - t
        for i in range(1, STAGES):
            work[:] = y
            for j in range(i):
                if _A[i, j] != 0.0:
                    work += (step * _A[i, j]) * K[j]
            _derivative(b, A, laws, t + _C[i] * step, work, angle, free, False, K[i])
        work[:] = y
        for j in range(STAGES):
            if _B[j] != 0.0:
                work += (step * _B[j]) * K[j]
        end = stop if last else t + step
        _derivative(b, A, laws, end, work, angle, free, False, K[STAGES])
        # the error counts against what a group of components is or becomes in the step: no unit enters
        scale[X : X + 3] = _group(y, V, 3) * step + _group(K[0], V, 3) * step * step
        if A.hinge[b] == 1:
            scale[X : X + 3] = 1.0
        scale[V : V + 3] = _group(y, V, 3) + _group(K[0], V, 3) * step + _group(K[STAGES], V, 3) * step
        scale[W : W + 3] = _group(y, W, 3) + _group(K[0], W, 3) * step + _group(K[STAGES], W, 3) * step
        err3 = 0.0
        err5 = 0.0
        for i in range(LOADS):
            e3 = 0.0
            e5 = 0.0
            for j in range(STAGES + 1):
                e3 += K[j, i] * _E3[j]
                e5 += K[j, i] * _E5[j]
            if scale[i] > 0.0:
                err3 += (e3 / (TOLERANCE * scale[i])) ** 2
                err5 += (e5 / (TOLERANCE * scale[i])) ** 2
        error = 0.0
        if err5 > 0.0:
            error = step * err5 / np.sqrt((err5 + 0.01 * err3) * LOADS)
        if not np.isfinite(error):
            return False
        if error <= 1.0:
            t = end
            y[:] = work
            K[0] = K[STAGES]
            if last and t < t1:
                _derivative(b, A, laws, t, y, angle, free, True, K[0])
            grow = 5.0 if error == 0.0 else min(5.0, max(0.3, 0.9 * error**-0.125))
            h = max(h, step * grow) if last else step * grow
        else:
            h = step * max(0.2, 0.9 * error**-0.125)
            if t + h == t:
                return False
    return False
