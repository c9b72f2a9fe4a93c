"""Layers of an array of mesh size along one direction, ghosts included: what fills ghosts is made of these."""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_for
from flowgmo.flow.fields import G
from flowgmo.kernel import inner, kernel

Layers = list[tuple[int, int, int, float]]  # rows and factors of `fill_layers`

SET = -1  # in place of a layer to copy: a number


@kernel
def copy_layer(a, d, to, source, factor):
    """Layer `to` along direction d becomes factor times layer `source`, ghosts included."""
    nx, ny, nz = a.shape
    if d == 0:
        for j in range(ny):
            for k in range(nz):
                a[to, j, k] = factor * a[source, j, k]
    elif d == 1:
        for i in range(nx):
            for k in range(nz):
                a[i, to, k] = factor * a[i, source, k]
    else:
        for i in range(nx):
            for j in range(ny):
                a[i, j, to] = factor * a[i, j, source]


@kernel
def copy_layer_where_dry(a, d, to, source, F, beside, least):
    """Layer `to` becomes layer `source` in lines along d on which F <= least in layer `beside`."""
    nx, ny, nz = a.shape
    if d == 0:
        for j in range(ny):
            for k in range(nz):
                if F[beside, j, k] <= least:
                    a[to, j, k] = a[source, j, k]
    elif d == 1:
        for i in range(nx):
            for k in range(nz):
                if F[i, beside, k] <= least:
                    a[i, to, k] = a[i, source, k]
    else:
        for i in range(nx):
            for j in range(ny):
                if F[i, j, beside] <= least:
                    a[i, j, to] = a[i, j, source]


@kernel
def set_layer(a, d, to, value):
    """Layer `to` along direction d becomes a number, ghosts included."""
    nx, ny, nz = a.shape
    if d == 0:
        for j in range(ny):
            for k in range(nz):
                a[to, j, k] = value
    elif d == 1:
        for i in range(nx):
            for k in range(nz):
                a[i, to, k] = value
    else:
        for i in range(nx):
            for j in range(ny):
                a[i, j, to] = value


@kernel
def fill_layers(a, rows, factors):
    """One after the other: layer `to` along d becomes factor times layer `source`, or factor where that is SET.

    rows (n, 3) int64: d, to, source; factors (n,). All layers of an array in one call: many calls cost more than these.
    Those along z that follow one another are done together: each cell of such a layer is in another line of memory.
    """
    n = 0
    while n < len(rows):
        end = n + 1
        if rows[n, 0] == 2:
            while end < len(rows) and rows[end, 0] == 2:
                end += 1
            _fill_lines(a, rows[n:end], factors[n:end])
        elif rows[n, 2] == SET:
            set_layer(a, rows[n, 0], rows[n, 1], factors[n])
        else:
            copy_layer(a, rows[n, 0], rows[n, 1], rows[n, 2], factors[n])
        n = end


@inner
def _fill_lines(a, rows, factors):
    """fill_layers along z: of the lines of one i after another, which stay near the processor meanwhile."""
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            ask_for(a, i + 1, j, rows[0, 1])
            ask_for(a, i + 1, j, rows[-1, 1])
        for n in range(len(rows)):
            to, factor = np.uint64(rows[n, 1]), factors[n]
            if rows[n, 2] == SET:
                for j in range(a.shape[1]):
                    a[i, j, to] = factor
            else:
                source = np.uint64(rows[n, 2])
                for j in range(a.shape[1]):
                    a[i, j, to] = factor * a[i, j, source]


def as_arguments(layers: Layers) -> tuple[np.ndarray, np.ndarray]:
    """(rows, factors) of `fill_layers`."""
    rows = np.array([row[:3] for row in layers], np.int64).reshape(-1, 3)
    return rows, np.array([row[3] for row in layers], float)


@kernel
def fill_dry_layers(a, rows, F, beside, least):
    """copy_layer_where_dry for rows (n, 3) of d, to, source; beside (n,): the layer of F."""
    for n in range(len(rows)):
        copy_layer_where_dry(a, rows[n, 0], rows[n, 1], rows[n, 2], F, beside[n], least)


@kernel
def join_cells(a, joined_x, joined_y, joined_z):
    """The first ghosts of a cell value at joined (periodic) sides: the first cells of the other side."""
    nx, ny, nz = a.shape
    if joined_x:
        copy_layer(a, 0, G - 1, nx - G - 1, 1.0)
        copy_layer(a, 0, nx - G, G, 1.0)
    if joined_y:
        copy_layer(a, 1, G - 1, ny - G - 1, 1.0)
        copy_layer(a, 1, ny - G, G, 1.0)
    if joined_z:
        copy_layer(a, 2, G - 1, nz - G - 1, 1.0)
        copy_layer(a, 2, nz - G, G, 1.0)
