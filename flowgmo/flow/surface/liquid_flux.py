"""The liquid that crosses a face in dt: A u dt times the liquid's share of the slab it comes from.

                 <- u dt ->
       +---------+---------+          share: liquid in the slab beside the face, u dt thick, of the cell upwind, in
       |         |#########| face     shares of the slab (of its open part where a solid cuts the cell): from the
       |  .  ' - |####     |   -> u   plane of surface_normals.py, F itself where the cell is full or empty.
       | '       |         |
       +---------+---------+

The slab of a cell that is not cut holds at most |u| dt, so that no face takes out more than there is.
"""

from __future__ import annotations

from flowgmo.flow.surface.carriers import across_column, columns_of_faces, travel, upwind, upwind_cell
from flowgmo.flow.surface.plic import is_mixed, is_plane, share_of_slab
from flowgmo.flow.surface.surface_at_solids import share_in_cut_cell
from flowgmo.flow.surface.surface_normals import near_solids, plane_at
from flowgmo.kernel import flow_kernel, inner

DROP = 1e-2  # [-] F of a cell below which it may be a drop in the air, see is_drop: of a surface cell's F, one in 100


@flow_kernel
def plic_flux(columns, first, last, own, dt, F, V, opened, planes, lines, flux):
    """flux [length] of the upper faces of the columns, and of the domain's lower sides beside them.

    own Carrier, F [-] with ghosts, V opened.V, opened Open, planes (mesh, 4) of F and lines as of
    solid_lines.py, flux (mesh) on faces.
    """
    d, q, A, across, along = own.way.d, own.q, own.A, own.way.across, own.way.along
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        for back in range(columns_of_faces(d, i, j)):
            a, b = i - (back if d == 0 else 0), j - (back if d == 1 else 0)
            bottom = k0 - 1 if d == 2 else k0
            upwind(d, q, A, dt, F, a, b, bottom, k1, flux)
            for k in range(bottom, k1):
                e, f, g = upwind_cell(q[a, b, k], d, a, b, k)
                if not is_mixed(F[e, f, g]) or flux[a, b, k] == 0.0:
                    continue
                thick = min(abs(q[a, b, k]) * dt * along[g] * across_column(d, across, e, f), 1.0)
                low, high = (1.0 - thick, 1.0) if q[a, b, k] > 0.0 else (0.0, thick)
                solid, drop, share = False, is_drop(F, e, f, g), F[e, f, g]
                if V is not None:
                    if lines[e, f] != 0 and near_solids(V, e, f, g):
                        solid = True
                        share = share_beside_solids(F, V, opened, planes, e, f, g, d, low, high, A[a, b, k] * thick)
                if not solid and not drop:
                    m, alpha = plane_at(planes, e, f, g)
                    share = share_of_slab(m, alpha, d, low, high) if is_plane(m) else F[e, f, g]
                flux[a, b, k] = travel(q, A, dt, a, b, k) * share


@inner
def share_beside_solids(F, V, opened, planes, i, j, k, d, low, high, passed):
    """Liquid share of what passes [cells] of a slab in a mixed cell that is cut or has cut or closed neighbours."""
    share = F[i, j, k]
    if not is_drop(F, i, j, k):
        share = _share_at_solids(F, V, opened, planes, i, j, k, d, low, high)
    return _at_hand(share, F[i, j, k], V[i, j, k], passed)


@inner
def _at_hand(share, F, V, passed):
    """The share of what passes [cells], with no more void in it, and no more liquid, than the cell has.

    Planes in cut cells are levels (surface_at_solids.py): a void of 1e-5 of a cell made a tenth of a slab void.
    """
    share = max(share, 1.0 - (1.0 - F) * V / passed)
    return max(min(share, F * V / passed), 0.0)


@inner
def is_drop(F, i, j, k):
    """Whether a cell holds little, and no neighbour more: these do not say where in the cell it lies.

    A plane on the far side would never let it across the face below it: it hung in the air while the speed of that
    face grew by g t, and bounded the step. It leaves as if spread evenly.
    """
    here = F[i, j, k]
    if here > DROP:
        return False
    around = max(max(F[i - 1, j, k], F[i + 1, j, k]), max(F[i, j - 1, k], F[i, j + 1, k]))
    return here >= max(around, max(F[i, j, k - 1], F[i, j, k + 1]))


@inner
def _share_at_solids(F, V, opened, planes, i, j, k, d, low, high):
    """Liquid share of the open part of a slab in a mixed cell that is cut or has cut or closed neighbours."""
    m, alpha = plane_at(planes, i, j, k)
    if not is_plane(m):
        return F[i, j, k]
    if V[i, j, k] < 1.0:
        return share_in_cut_cell(m, alpha, opened, i, j, k, F[i, j, k], d, low, high)
    return share_of_slab(m, alpha, d, low, high)
