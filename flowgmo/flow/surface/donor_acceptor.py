"""The cheaper flux (IFVOF 4): donor and acceptor instead of planes.

Of the liquid that crosses a face, thick = |u| dt / dx of the donor cell D (upwind), into the acceptor A (downwind):

    liquid = min(F_AD thick + CF, F_D)        CF = max((1 - F_AD) thick - (1 - F_D), 0)

F_AD is F_A where the surface moves across the face, so that a face is crossed only by what lies before it: liquid
first when A is fuller. Then CF adds what the donor's void cannot make up for. It is F_D, an evenly filled slab,
where the surface lies along the flow (its normal is nearer to another axis), unless A or the cell behind D is empty:
a front fills its cell before it enters the next. min: no more liquid than there is. Hirt and Nichols 1981 ("Volume of
Fluid (VOF) method for the dynamics of free boundaries", J. Comput. Phys. 39).

Both bounds of Weymouth and Yue hold, liquid <= min(F_D, thick) and liquid >= thick - (1 - F_D), so that sweeps with
this flux keep 0 <= F <= 1 where at most one face empties a cell. Less exact than planes: surfaces roughen into steps.
"""

from __future__ import annotations

from flowgmo.flow.surface.carriers import across_column, columns_of_faces, travel, upwind, upwind_cell
from flowgmo.flow.surface.plic import EMPTY, is_mixed
from flowgmo.kernel import flow_kernel, inner


@flow_kernel
def donor_acceptor_flux(columns, first, last, own, dt, F, V, opened, planes, lines, flux):
    """flux [length] of the upper faces of the columns and of the domain's lower sides beside them; see plic_flux."""
    d, q, A, across, along = own.way.d, own.q, own.A, own.way.across, own.way.along
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        for back in range(columns_of_faces(d, i, j)):
            a, b = i - (back if d == 0 else 0), j - (back if d == 1 else 0)
            bottom = k0 - 1 if d == 2 else k0
            upwind(d, q, A, dt, F, a, b, bottom, k1, flux)
            for k in range(bottom, k1):
                e, f, g = upwind_cell(q[a, b, k], d, a, b, k)
                if is_mixed(F[e, f, g]) and flux[a, b, k] != 0.0:
                    thick = min(abs(q[a, b, k]) * dt * along[g] * across_column(d, across, e, f), 1.0)
                    share = _share(F, V, e, f, g, d, 1 if q[a, b, k] > 0.0 else -1, thick)
                    flux[a, b, k] = travel(q, A, dt, a, b, k) * share


@inner
def _open_F(F, V, i, j, k, instead):
    """F of the cell, or `instead` where it is closed."""
    if V is not None:
        if V[i, j, k] <= 0.0:
            return instead
    return min(max(F[i, j, k], 0.0), 1.0)


@inner
def _slope(F, V, d, i, j, k, here):
    """|F+ - F-| over the neighbours of the cell along d."""
    a, b, c = (1 if d == 0 else 0), (1 if d == 1 else 0), (1 if d == 2 else 0)
    return abs(_open_F(F, V, i + a, j + b, k + c, here) - _open_F(F, V, i - a, j - b, k - c, here))


@inner
def _share(F, V, i, j, k, d, s, thick):
    """Liquid share of the slab that leaves the mixed donor cell along d, upwards (s = 1) or downwards (-1)."""
    donor = F[i, j, k]
    a, b, c = (s if d == 0 else 0), (s if d == 1 else 0), (s if d == 2 else 0)
    acceptor = _open_F(F, V, i + a, j + b, k + c, donor)
    behind = _open_F(F, V, i - a, j - b, k - c, donor)
    along = _slope(F, V, d, i, j, k, donor)
    aside = max(_slope(F, V, (d + 1) % 3, i, j, k, donor), _slope(F, V, (d + 2) % 3, i, j, k, donor))
    across = along >= aside or acceptor <= EMPTY or behind <= EMPTY
    chosen = acceptor if across else donor
    more = max((1.0 - chosen) * thick - (1.0 - donor), 0.0)
    return min(chosen * thick + more, donor) / thick
