"""Where the water's surface meets a body inside a cell: the part of the wall that the pressure of the cell misses.

The load of a cell counts whole where its centre is in the liquid, and not at all where it is not (body_fluxes.py). In
liquid at rest with its surface at the height h of the cell (from its bottom, in heights of a cell), the pressure
p = rho g dz (h - z) acts on the wall below h only. With the wall a plane m . xi = alpha of the unit cell, m . xi <=
alpha being covered, and D(z) the wall below z in units of 1 / |m|, D = d/d alpha of what is covered below z,

    centre in the liquid   counted too much    force = - m_z (integral from h to 1 of D(1) - D(z)) rho g volume
    centre above it        not counted         force = - m_z (integral from 0 to h of D(z))        rho g volume

are added upwards. Sideways nothing is: what counts whole adds up to nothing in water at rest, planes do not (a turned
box, 10 cells across: a side force of 3e-5 of its weight, 2e-3 by planes). m comes from the shares of the faces (the
difference of opposite ones), alpha from the share of the volume, h from the liquid in the cell: so little of the wall
is concerned that its curvature and the slope of the water do not count. Without it the buoyancy of a sphere ten cells
across is wrong by 4e-3.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import Grid
from flowgmo.flow.surface.plic import plane_offset, stretched, volume_under
from flowgmo.kernel import inner, kernel

UPRIGHT = 0.999  # of gravity along one direction of the mesh: else levels are none of the mesh's, and nothing is added
HALVINGS = 40  # of a cell: a level to round-off of its square
NUDGE = 1e-4  # of the sum of |m|: a step of alpha for D, which is of second order in it
POINTS = (0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263)  # Gauss-Legendre, on 0 .. 1
WEIGHTS = (0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269)


@inner
def _covered_below(m, alpha, d, z):
    """Share of the cell that is covered and below z along d."""
    return z * volume_under(stretched(m, d, z), alpha)


@inner
def _level(m, alpha, d, opened):
    """Height below which `opened` of the cell is open."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        z = 0.5 * (low + high)
        if z - _covered_below(m, alpha, d, z) < opened:
            low = z
        else:
            high = z
    return 0.5 * (low + high)


@inner
def _wall_below(m, alpha, d, z, step):
    """D(z)."""
    return 0.5 * (_covered_below(m, alpha + step, d, z) - _covered_below(m, alpha - step, d, z)) / step


@kernel
def _find(cells, F, faces, covered, d, up, too_much, missing):
    """too_much, missing (m,): - m_d times the integrals of above, 0 in cells that no surface crosses."""
    for c in range(len(cells)):
        share = F[cells[c]]
        too_much[c] = missing[c] = 0.0
        if not (0.0 < share < 1.0 and 0.0 < covered[c] < 1.0):
            continue
        m = (
            faces[c, 0] - faces[c, 1],
            faces[c, 2] - faces[c, 3],
            faces[c, 4] - faces[c, 5],
        )
        size = abs(m[0]) + abs(m[1]) + abs(m[2])
        if not size > 0.0:
            continue
        mirrored = stretched(m, d, -1.0) if up < 0 else m
        alpha, step = plane_offset(mirrored, covered[c]), NUDGE * size
        h = _level(mirrored, alpha, d, share * (1.0 - covered[c]))
        above, below, whole = 0.0, 0.0, _wall_below(mirrored, alpha, d, 1.0, step)
        for n in range(4):
            z = h + (1.0 - h) * POINTS[n]
            above += WEIGHTS[n] * (1.0 - h) * (whole - _wall_below(mirrored, alpha, d, z, step))
            below += WEIGHTS[n] * h * _wall_below(mirrored, alpha, d, h * POINTS[n], step)
        too_much[c] = -m[d] * above
        missing[c] = -m[d] * below


def waterline(
    cells: np.ndarray, at: np.ndarray, faces: np.ndarray, covered: np.ndarray, F: np.ndarray, gravity: np.ndarray,
    grid: Grid,
) -> np.ndarray | None:  # fmt: skip
    """(m, 2, 3) [length4/time2] what is to be added, per density, to the force of a body's cells: where their centre is
    in the liquid, and where it is not. None without gravity along the mesh.

    cells (m,) flat index, at (m, 3), faces (m, 6) and covered (m,) shares of the body, F (mesh).
    """
    size = float(np.linalg.norm(gravity))
    d = int(np.abs(gravity).argmax())
    if not abs(gravity[d]) > UPRIGHT * size:
        return None
    found = np.empty((2, len(cells)))
    _find(cells, F.reshape(-1), faces, covered, d, -np.sign(gravity[d]), *found)
    out = np.zeros((len(cells), 2, 3))
    out[:, :, d] = found.T * (size * np.prod([w[at[:, e]] for e, w in enumerate(grid[:3])], axis=0))[:, None]
    return out
