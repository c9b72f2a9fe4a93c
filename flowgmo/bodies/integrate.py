"""Dormand & Prince's 8(5,3) pair for the equations of motion, with steps that end at the kinks of the tables.

Source: Hairer, Nørsett & Wanner 1993, II.5; coefficients in dop853.py.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies import dop853
from flowgmo.bodies.dop853 import STAGES
from flowgmo.bodies.equations import LOADS, SIZE, Q, V, W, derivative
from flowgmo.bodies.laws import next_kink
from flowgmo.kernel import inner

_A, _B, _C, _E3, _E5 = dop853.A, dop853.B, dop853.C, dop853.E3, dop853.E5
TOLERANCE = 1e-12  # local error relative to the change in a step: 1e-9 and better over thousands of steps
MAX_SUBSTEPS = 200_000  # a step that needs more is given up with an error, not a hang


@inner
def _kink_after(body, laws, t):
    at = np.inf
    for k in range(6):
        at = min(at, next_kink(laws, body.drive[k], t))
    for k in range(3):
        at = min(at, next_kink(laws, body.force[k], t), next_kink(laws, body.torque[k], t))
    for j in range(body.first_load, body.last_load):
        for k in range(3):
            at = min(at, next_kink(laws, laws.loads[j].law[k], t))
    return at


@inner
def _group(y, i):
    """Norm of three components from i on."""
    return np.sqrt(y[i] * y[i] + y[i + 1] * y[i + 1] + y[i + 2] * y[i + 2])


@inner
def _error(K, y, step, hinged):
    """Hairer's error norm of a step, in units of TOLERANCE; 1 is the limit.

    The error counts against what a group of components is or becomes in the step, so no unit enters; quaternions and
    a hinge's angle count as they are.
    """
    turn = 1.0
    speed = _group(y, V) + (_group(K[0], V) + _group(K[STAGES], V)) * step
    place = 1.0 if hinged else speed * step
    spin = _group(y, W) + (_group(K[0], W) + _group(K[STAGES], W)) * step
    err3 = 0.0
    err5 = 0.0
    for i in range(LOADS):
        size = place if i < Q else turn if i < V else speed if i < W else spin
        if size == 0.0:
            continue
        e3 = 0.0
        e5 = 0.0
        for j in range(STAGES + 1):
            e3 += K[j, i] * _E3[j]
            e5 += K[j, i] * _E5[j]
        err3 += (e3 / size) ** 2
        err5 += (e5 / size) ** 2
    if err5 == 0.0:
        return 0.0
    return step * err5 / np.sqrt((err5 + 0.01 * err3) * LOADS) / TOLERANCE


@inner
def integrate(body, laws, t0, t1, y, angle, free):
    """y (SIZE,) of a body from t0 to t1, in place; `angle` where a fixed-axis body stands at y[X] = 0.

    free (6,): nonzero where a component is solved for. Returns False if the step size collapsed.
    """
    K = np.zeros((STAGES + 1, SIZE))
    work = np.zeros(SIZE)
    hinged = body.hinge == 1
    t = t0
    h = t1 - t0
    derivative(body, laws, t, y, angle, free, True, K[0])
    fast = _group(y, W) + np.sqrt(_group(K[0], W))
    if hinged:
        fast = abs(y[V]) + np.sqrt(abs(K[0, V]))
    if fast * h > 0.5:
        h = 0.5 / fast  # half a radian at first
    for _ in range(MAX_SUBSTEPS):
        if t >= t1:
            return True
        stop = min(t1, _kink_after(body, laws, t))
        step = min(h, stop - t)
        last = step >= stop - t
        end = stop if last else t + step
        for i in range(1, STAGES + 1):
            for k in range(SIZE):
                s = 0.0
                for j in range(i):
                    s += (_A[i, j] if i < STAGES else _B[j]) * K[j, k]
                work[k] = y[k] + step * s
            at = end if i == STAGES else t + _C[i] * step
            derivative(body, laws, at, work, angle, free, False, K[i])
        error = _error(K, y, step, hinged)
        if not np.isfinite(error):
            return False
        if error <= 1.0:
            t = end
            for k in range(SIZE):
                y[k] = work[k]
                K[0, k] = K[STAGES, k]
            if last and t < t1:
                derivative(body, laws, t, y, angle, free, True, K[0])
            grow = 5.0 if error == 0.0 else min(5.0, max(0.3, 0.9 * error**-0.125))
            h = max(h, step * grow) if last else step * grow
        else:
            h = step * max(0.2, 0.9 * error**-0.125)
            if t + h == t:
                return False
    return False
