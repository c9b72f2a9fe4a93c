"""The velocity before the pressure acts: u* = u + dt a, with all accelerations but the pressure's.

`IORDER` 1: one stage, a = a(u). `IORDER` 3: two stages (Heun), second order in time,

    u1 = u + dt (a(u) - grad p / rho)           p of the last step: u1 fits the walls up to dt2
    u* = u + dt (a(u) + a(u1)) / 2
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import flow_kernel


@flow_kernel
def accelerate(columns, first, last, A, u, a, dt, out):
    """out = u + dt a on the columns' upper faces; 0 where they are closed."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            new = u[i, j, k] + dt * a[i, j, k]
            if A is not None:
                if A[i, j, k] == 0.0:
                    new = 0.0
            out[i, j, k] = new


@flow_kernel
def fill(columns, first, last, value, out):
    """out = value in the columns' cells."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            out[i, j, k] = value


@flow_kernel
def add(columns, first, last, value, out):
    """out += value in the columns' cells."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            out[i, j, k] += value
