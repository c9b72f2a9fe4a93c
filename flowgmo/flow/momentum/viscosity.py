"""Viscous acceleration, explicit: nu laplacian(u) for constant viscosity, with open areas and walls.

div(mu (grad u + grad u^T)) / rho = nu laplacian(u), since div u = 0. For the velocity q on a face, over its six
neighbours n of the same component, with the open volume V of the face's cell (half of each of the two it lies between):

    V dq/dt = nu [ sum c_n (q_n - q) + s (q_wall - q) ],      c_n = A_n / (distance to n * width of the face's cell)

A_n is the open area between the two. Where one of the faces has no liquid on either side, there is no stress (the
air's is none). s is the wall's part (wall_shear.py), nothing with free slip. Far from solids all A and V are 1 and c_n
depends on the mesh alone.

Faces near solids are listed apart (cut_faces.py) and done by cut_viscosity.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cut_faces import ONE, STEPS, U64, CutFaces, wet_face
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.momentum.cut_viscosity import CutViscosity, conduct_cut, diffuse_cut
from flowgmo.flow.momentum.wall_shear import SideWalls, shear_sides, solid_shear
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel

Array = np.ndarray
Velocity = tuple[Array | None, Array | None, Array | None]


class Conduct(NamedTuple):
    """lower, upper [1/length2] (n + 4,) of one direction: c_n with all open, towards the faces below and above."""

    lower: Array
    upper: Array


class Viscosity(NamedTuple):
    """The operator of one component; plain and bit as in cut_faces.py, cut and sides None where there are none."""

    conducts: tuple[Conduct | None, Conduct | None, Conduct | None]
    plain: Array | None
    bit: np.uint8
    cut: CutViscosity | None
    sides: SideWalls | None


@flow_kernel
def diffuse(columns, first, last, ci, cj, ck, q, F, x, y, z, plain, bit, factor, out, change):
    """out and change (None: not wanted) += factor laplacian(q) on plain faces; x, y, z: Conduct, None where absent."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            q0 = q[i, j, k]
            total = 0.0
            if x is not None:
                a = x.lower[i] * (q[i - ONE, j, k] - q0)
                b = x.upper[i] * (q[i + ONE, j, k] - q0)
                if F is not None:
                    a = a if wet_face(F, i - ONE, j, k, ci, cj, ck) else 0.0
                    b = b if wet_face(F, i + ONE, j, k, ci, cj, ck) else 0.0
                total += a + b
            if y is not None:
                a = y.lower[j] * (q[i, j - ONE, k] - q0)
                b = y.upper[j] * (q[i, j + ONE, k] - q0)
                if F is not None:
                    a = a if wet_face(F, i, j - ONE, k, ci, cj, ck) else 0.0
                    b = b if wet_face(F, i, j + ONE, k, ci, cj, ck) else 0.0
                total += a + b
            if z is not None:
                a = z.lower[k] * (q[i, j, k - ONE] - q0)
                b = z.upper[k] * (q[i, j, k + ONE] - q0)
                if F is not None:
                    a = a if wet_face(F, i, j, k - ONE, ci, cj, ck) else 0.0
                    b = b if wet_face(F, i, j, k + ONE, ci, cj, ck) else 0.0
                total += a + b
            if F is not None:
                total = total if wet_face(F, i, j, k, ci, cj, ck) else 0.0
            if plain is not None:
                total = total if (plain[i, j, k] & bit) != 0 else 0.0
            out[i, j, k] += factor * total
            if change is not None:
                change[i, j, k] += factor * total


def _conduct(d: Array, h: Array, *, own: bool) -> Conduct:
    """d (n + 4,) widths, h distances of centres; own: nodes on faces."""
    above, before = np.append(d[1:], d[-1]), np.append(h[0], h[:-1])
    return Conduct(1.0 / (d * h), 1.0 / (above * h)) if own else Conduct(1.0 / (before * d), 1.0 / (h * d))


def make_viscosity(
    team: Team,
    grid: Grid,
    open: Open,
    cut: CutFaces,
    present: tuple[bool, bool, bool],
    no_slip: bool,
    sides: tuple[SideWalls | None, SideWalls | None, SideWalls | None],
    before: tuple[Viscosity | None, ...] = (None, None, None),
    sources: tuple[Array | None, ...] = (None, None, None),
) -> tuple[Viscosity | None, Viscosity | None, Viscosity | None]:
    """The operator for u, v, w (None where absent).

    present (3,): directions that are not absent. no_slip: of solids (`IWSH`); sides: wall_shear.find_side_walls.
    before, sources: operators of the step before, and where each cut row was in them (cut_faces.sort_again); what holds
    of rows that were there already is taken over.
    """
    operators = []
    for c in range(3):
        if not present[c]:
            operators.append(None)
            continue
        conducts = tuple(_conduct(grid[d], grid[3 + d], own=d == c) if present[d] else None for d in range(3))
        rows, near = cut.rows[c], None
        if rows is not None and len(rows):
            old = None if before[c] is None else before[c].cut
            near = _at_solids(team, rows, c, grid, open, no_slip, old, sources[c])
        operators.append(Viscosity(conducts, cut.plain, np.uint8(1 << c), near, sides[c]))
    return tuple(operators)


def _at_solids(
    team: Team, rows: Array, c: int, grid: Grid, open: Open, no_slip: bool, old: CutViscosity | None,
    source: Array | None,
) -> CutViscosity:  # fmt: skip
    """Of component c on cut faces rows (n, 4); source (n,): where they are in `old`, -1: not at all; None: none is."""
    n = len(rows)
    out = CutViscosity(rows, np.empty((n, 6)), np.empty(n), np.zeros(n), None)
    new = slice(None)
    if old is not None and source is not None:
        new, kept = np.flatnonzero(source < 0), np.flatnonzero(source >= 0)
        for a, b in zip(out[1:4], old[1:4], strict=True):
            a[kept] = b[source[kept]]
    some = rows[new]
    found, volume, shear = np.empty((len(some), 6)), np.empty(len(some)), np.zeros(len(some))
    team.run(conduct_cut, some, *STEPS[c], open[1 + c], *open, *grid[:3], found, volume)
    if no_slip:
        team.run(solid_shear, some, *STEPS[c], *open, *grid[:3], shear)
    out.c[new], out.V[new], out.s[new] = found, volume, shear
    return out


def apply(
    team: Team,
    columns: Array,
    c: int,
    operator: Viscosity,
    q: Array,
    F: Array | None,
    factor: float,
    out: Array,
    limit: float,
    moving: bool = True,
    gradient: Array | None = None,
    change: Array | None = None,
) -> None:
    """out += factor (laplacian q + wall terms) of component c; moving False: as if all walls were at rest.

    limit, gradient: cut_viscosity.diffuse_cut; change: gets the same added as out.
    """
    steps = STEPS[c]
    _, plain, bit, cut, sides = operator
    team.run(diffuse, columns, *steps, q, F, *operator.conducts, plain, bit, factor, out, change)
    if cut is not None:
        team.run(
            diffuse_cut, cut.rows, *steps, q, F, cut.c, cut.V, cut.s, cut.speed if moving else None, factor, limit,
            gradient, out, change,
        )  # fmt: skip
    if sides is not None:
        speed = sides.speed if moving else None
        team.run(shear_sides, sides.rows, *steps, q, F, sides.s, speed, factor, out, change)


def add_viscosity(
    team: Team,
    columns: Array,
    operators: tuple[Viscosity | None, ...],
    velocity: Velocity,
    F: Array | None,
    acceleration: Velocity,
    nu: float,
    dt: float,
    gradients: tuple[Array | None, ...] = (None, None, None),
    changes: tuple[Array | None, ...] = (None, None, None),
) -> None:
    """Add nu laplacian(u) and the walls' shear [length/time2] to the acceleration of the columns' upper faces.

    velocity (u, v, w) on faces, both ghost layers as without shear (mirrored at walls); F [-] None without a free
    surface; dt the step, for which slivers are kept stable; gradients: grad p / rho of the last step on the cut faces
    of each component (projection.Projector.gradients); changes: get
    the same added as the acceleration. Closed faces and faces in air keep their acceleration.
    """
    for c, (operator, q, out) in enumerate(zip(operators, velocity, acceleration, strict=True)):
        if operator is not None:
            apply(team, columns, c, operator, q, F, nu, out, nu * dt, gradient=gradients[c], change=changes[c])


def viscous_limit(grid: Grid, nu: float, present: tuple[bool, bool, bool] = (True, True, True)) -> float:
    """The longest explicit step [time]: dt nu sum c_n <= 1 on plain faces and beside walls; inf without viscosity.

    The operator's eigenvalues lie within twice the sum (Gershgorin), explicit Euler's and Heun's bound is 2 / dt.
    """
    total = 0.0
    for d in range(3):
        if present[d]:
            pairs = [_conduct(grid[d], grid[3 + d], own=own) for own in (True, False)]
            total += max(float((p.lower + p.upper)[G - 1 : -G].max()) for p in pairs)
    return 1.0 / (nu * total) if nu > 0.0 else np.inf
