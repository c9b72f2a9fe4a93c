"""Load of the liquid on bodies that move, and what of them is wet.

    force, torque = J^T p  +  lift        over the cells of the pressure equation (immersed/body_fluxes.py), about B

p is that of the step, which makes the velocities of its end: the load is the mean over the step, and for a body that
the pressure moves it is what changed its velocity, M (U_new - U*) / dt and the lift, which is in U*. The liquid gets
the opposite to rounding. On a face of its open part A S the pressure makes

    rho A S h du = - dt A S (p_upper - p_lower)        whose sum is  dt sum of p (A_upper - A_lower) S  =  - dt J^T p

in the cells of a body (A + sum of S_b = 1), and gravity acts on the halves of faces, (A_upper + A_lower) / 2 of each
cell, in place of the volume V: the difference is - lift.

    wetted area = sum of |a| F        a: area of the wall in a cell, F its liquid
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import Flow, Grid
from flowgmo.flow.immersed.body_fluxes import BodyFluxes, body_fluxes, weight_of_displaced
from flowgmo.flow.immersed.waterline import Surface
from flowgmo.kernel import kernel


class BodyLoads(NamedTuple):
    """Of the liquid on k bodies: force and torque about B (k, 6) [force, torque] by pressure, by shear, and of films
    that the mesh does not see (film.py); None where there is no such."""

    pressure: np.ndarray
    shear: np.ndarray | None
    film: np.ndarray | None = None

    @property
    def total(self) -> np.ndarray:
        """(k, 6)."""
        total = self.pressure if self.shear is None else self.pressure + self.shear
        return total if self.film is None else total + self.film


def pressure_loads(
    fluxes: list[BodyFluxes], liquid: np.ndarray, p: np.ndarray, rho: float, g: np.ndarray
) -> np.ndarray:
    """(k, 6) of each body's fluxes; liquid (mesh): not 0 in cells of the equation, p (mesh) [mass/length/time2]."""
    out = np.zeros((len(fluxes), 6))
    flat, pressure = liquid.reshape(-1), p.reshape(-1)
    for load, one in zip(out, fluxes, strict=True):
        wet = flat[one.cells] != 0.0
        # a sum of rows in a fixed order: what BLAS takes depends on its threads
        load[:] = (one.J[wet] * pressure[one.cells[wet], None]).sum(axis=0) + weight_of_displaced(one, wet, rho, g)
    return out


def resting_fluxes(
    cover: BodyCover,
    grid: Grid,
    centres: list[np.ndarray],
    place: np.ndarray,
    surface: Surface | None = None,
    middle: np.ndarray | None = None,
    open_sides: Sequence[int] = (),
) -> BodyFluxes:
    """The fluxes of a body that stays where it is, B at place (3,); surface, middle, open_sides: as in body_fluxes."""
    cells = np.column_stack(np.unravel_index(cover.numbers, [len(c) for c in centres])).astype(np.int32)
    faces, covered = cover.shares[:, :6], cover.shares[:, 6]
    return body_fluxes(Shares(cells, faces), covered, grid, centres, place, middle, surface, cover, open_sides)


def wetted_area(cover: BodyCover, flow: Flow, V: np.ndarray, grid: Grid) -> float:
    """[length2] of the wall of a body that liquid touches."""
    F = 1.0 if flow.F is None else flow.F.reshape(-1)[cover.numbers].clip(0.0, 1.0)
    return float((wall_sizes(cover, V, grid) * F).sum())


def wall_sizes(cover: BodyCover, V: np.ndarray, grid: Grid) -> np.ndarray:
    """(n,) [length2] of the wall in each of the cover's cells, 0 in those that are closed; V (mesh)."""
    sizes = np.empty(len(cover.numbers))
    _find_sizes(cover.numbers, cover.shares, grid, V, sizes)
    return sizes


@kernel
def _find_sizes(numbers, shares, grid, V, sizes):
    """sizes (n,) as of wall_sizes."""
    nx, ny, nz = V.shape
    for c in range(len(numbers)):
        i, j, k = numbers[c] // (ny * nz), numbers[c] // nz % ny, numbers[c] % nz
        s, dx, dy, dz = shares[c], grid.dx[i], grid.dy[j], grid.dz[k]
        x, y, z = (s[1] - s[0]) * (dy * dz), (s[3] - s[2]) * (dz * dx), (s[5] - s[4]) * (dx * dy)
        sizes[c] = np.sqrt(x * x + y * y + z * z) if V[i, j, k] > 0.0 else 0.0
