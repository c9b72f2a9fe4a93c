"""The velocity before the pressure acts: u* = u + dt a, with all accelerations but the pressure's.

`IORDER` 1: one stage, a = a(u). `IORDER` 3: two stages (Heun), second order in time,

    u1 = u + dt (a(u) - grad p / rho)           p of the last step: u1 fits the walls up to dt2
    u* = u + dt (a(u) + a(u1)) / 2

A step that an impact has cut short is no measure of the pressure: what moving walls ask of the liquid changes from one
step to the next by a part of u (the means of the open fractions are others), however short the step, and p = rho q / dt
is as much larger. Where the next step is long again, u1 would gain that part dt / (last dt) times: 128 m/s in liquid of
3.5 m/s (five bodies dropped into a tank, a step of 3.5 ms after one of 33 us), and u* crosses 28 cells where one stage
crosses .43. So steps more than AGED (stages.py) times as long as the last one have one stage.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.kernel import flow_kernel, inlined


@inlined
def _accelerate_column(A, u, a, dt, out, i, j, k0, k1):
    """One column of `accelerate`."""
    for k in range(k0, k1):
        new = u[i, j, k] + dt * a[i, j, k]
        if A is not None:
            if A[i, j, k] == 0.0:
                new = 0.0
        out[i, j, k] = new


@flow_kernel
def accelerate(columns, first, last, A, lines, u, a, dt, out):
    """out = u + dt a on the columns' upper faces; 0 where they are closed. lines: solid_lines.py."""
    for c in range(first, last):
        ask_at_solids(columns, c, last, A, lines)
        ask_ahead(columns, c, last, u, 0, 0)
        ask_ahead(columns, c, last, a, 0, 0)
        ask_ahead(columns, c, last, out, 0, 0)
        i, j, k0, k1 = columns[c, 0], columns[c, 1], np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        if A is not None:
            if lines[i, j] != 0:
                _accelerate_column(A, u, a, dt, out, i, j, k0, k1)
                continue
        _accelerate_column(None, u, a, dt, out, i, j, k0, k1)


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
        ask_ahead(columns, c, last, out, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            out[i, j, k] += value
