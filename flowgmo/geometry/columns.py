"""Moments of any bounded body by columns: exact along the column, adaptive Lobatto rule across.

    M = ∫∫ ( Σ over the segments of a column inside the body ∫ ρ f dt ) du dv

Every surface gives the parameters t where a column crosses it; between neighbouring crossings membership is constant
and is asked at the middle, so a column is exact for any combination of pieces. The columns stand askew to the axes, so
that no wall of a usual body is parallel to them and the column integral is continuous in u and v. All cells in which it
bends are split alike: choosing among them by their change would keep those that are wrong by accident.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from flowgmo.geometry.combined import Common, Stretched
from flowgmo.geometry.mesh_solid import MeshSolid
from flowgmo.geometry.moments import Moments
from flowgmo.geometry.revolved import Revolved
from flowgmo.geometry.root_quadric import RootQuadricSolid
from flowgmo.geometry.shadow import ASKEW
from flowgmo.geometry.solid import Solid

START = 24  # cells per side at the beginning; a grazing rim between two nodes escapes with some h⁴, here 1e-7
TARGET = 2e-7  # relative error at which splitting stops
WORK = 10_000_000  # columns times their cost: about one second
QUARTIC, MESH = 6, 10  # cost of crossing a torus, a mesh; that of a plane or quadric is one (measured)
NODES = np.array(
    [-1.0, -np.sqrt(0.2), np.sqrt(0.2), 1.0]
)  # Lobatto: with nodes at the corners no rim slips between them
WEIGHTS = np.array([1.0, 5.0, 5.0, 1.0]) / 6

Owner = Callable[[np.ndarray], np.ndarray]  # number (n,) of the piece that fills points (n,3), -1 none


def integrate(solids: Sequence[Solid], owner: Owner, weights: np.ndarray) -> tuple[float, Moments, float]:
    """Volume, density-weighted moments, and an estimate of the relative error.

    owner(x): which piece fills a point; weights: the density of each piece.
    """
    axes = ASKEW.T
    low = -np.array([max(s.support(-e) for s in solids) for e in axes])
    high = np.array([max(s.support(e) for s in solids) for e in axes])
    centre, size = axes.T @ ((low + high) / 2), float((high - low).max())
    half = (high - low)[1:] / 2
    corner = np.stack(np.meshgrid(*(np.linspace(-h, h, START + 1)[:-1] for h in half), indexing="ij"), -1).reshape(
        -1, 2
    )
    cell = 2 * half / START

    def column(uv: np.ndarray) -> np.ndarray:
        return _columns(centre + uv @ axes[1:], uv, axes[0], solids, owner, weights, size)

    (value, bent), cost = _cells(corner, cell, column), _cost(solids)
    done, smooth_change, spent = np.zeros(11), 0.0, 0.0
    while True:
        finer, finer_bent = _cells(children := _split(corner, cell), cell / 2, column)
        spent += len(children) * NODES.size**2 * cost
        families = finer.reshape(-1, 4, 11)
        change = np.abs(families.sum(1) - value).max(1)  # sizes are one, so all moments compare
        total = done + finer.sum(0)
        scale = max(abs(total[0]), 1e-300)
        open_ = bent | finer_bent.reshape(-1, 4).any(1) | (change > TARGET * scale / len(change))
        smooth_change += change[~open_].sum()
        error = _error(smooth_change, change[open_]) / scale
        if error < TARGET or not open_.any() or spent * (1 + 4 * open_.mean()) > WORK:
            return _result(total, centre, axes, size, error)
        done = done + families[~open_].sum((0, 1))
        keep, cell = np.repeat(open_, 4), cell / 2
        corner, value, bent = children[keep], finer[keep], finer_bent[keep]


def _split(corner: np.ndarray, cell: np.ndarray) -> np.ndarray:
    """Lower corners (4n,2) of the quarters of cells."""
    return (corner[:, None] + cell / 2 * np.array([[0, 0], [0, 1], [1, 0], [1, 1]])).reshape(-1, 2)


def _error(smooth: float, bent: np.ndarray) -> float:
    """From the changes at the last split.

    All bent cells are of one size, so their errors are of both signs and add like noise. Closed forms show true errors
    of up to a third of the noise of the changes; 0.7 leaves a factor two.
    """
    return float(smooth + 0.7 * np.sqrt((bent**2).sum()))


def _cost(solids: Sequence[Solid]) -> float:
    """Of one column: crossings, between which membership is asked, and what the dear ones cost besides."""
    cost = 0.0
    for shape in (solid.shape for solid in solids):
        if isinstance(shape, (Common, Stretched, Solid)):
            cost += _cost(shape.parts if isinstance(shape, Common) else [getattr(shape, "solid", shape)])
            continue
        cost += shape.roots(np.zeros((1, 3)), ASKEW[:, 0]).shape[1]
        cost += MESH * isinstance(shape, MeshSolid) + QUARTIC * isinstance(shape, RootQuadricSolid)
        if isinstance(shape, Revolved):
            cost += QUARTIC * sum(bound.k != 0 != bound.a for bound in shape.bounds)
    return cost


def _cells(corner: np.ndarray, cell: np.ndarray, column: Callable) -> tuple[np.ndarray, np.ndarray]:
    """Lobatto sums (n,11) over cells with lower corners (n,2), and whether different surfaces bound their columns."""
    node = np.stack(np.meshgrid((NODES + 1) / 2, (NODES + 1) / 2, indexing="ij"), -1).reshape(-1, 2)
    weight = np.outer(WEIGHTS, WEIGHTS).ravel() / 4 * cell.prod()
    sums, bent = np.empty((len(corner), 11)), np.empty(len(corner), bool)
    for start in range(0, len(corner), 400):  # some 6 000 columns at once stay in the cache: four times faster
        part = slice(start, start + 400)
        table, key = column((corner[part, None] + node * cell).reshape(-1, 2))
        sums[part] = np.einsum("g,cgm->cm", weight, table.reshape(-1, len(weight), 11))
        bent[part] = np.ptp(key.reshape(-1, len(weight)), axis=1) != 0
    return sums, bent


def _columns(
    x: np.ndarray,
    uv: np.ndarray,
    d: np.ndarray,
    solids: Sequence[Solid],
    owner: Owner,
    weights: np.ndarray,
    size: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Per column (n,11): volume, then weighted 1, t, u, v, tt, tu, tv, uu, uv, vv, in units of size; and a key (n,)
    that tells which surfaces bound its segments."""
    t = np.hstack([solid.roots(x, d) for solid in solids])
    t = np.where(np.abs(t) <= size, t, np.nan)  # beyond the body no crossing matters; NaN sorts last
    order = np.argsort(t, axis=1)
    t = np.take_along_axis(t, order, 1)
    lo, hi = t[:, :-1], t[:, 1:]
    row, place = np.nonzero(hi > lo)
    t0, t1 = lo[row, place], hi[row, place]
    which = owner(x[row] + ((t0 + t1) / 2)[:, None] * d)
    full = which >= 0
    row, place, t0, t1, rho = row[full], place[full], t0[full] / size, t1[full] / size, weights[which[full]]
    key = np.bincount(row, np.sqrt(2 + order[row, place]) - np.sqrt(3 + order[row, place + 1]), len(x)).round(9)
    ones = np.stack([(t1 - t0), rho * (t1 - t0), rho * (t1**2 - t0**2) / 2, rho * (t1**3 - t0**3) / 3], 1)
    sums = np.stack([np.bincount(row, ones[:, k], len(x)) for k in range(4)], 1)
    u, v = (uv / size).T
    volume, w, wt, wtt = sums.T
    table = np.stack([volume, w, wt, w * u, w * v, wtt, wt * u, wt * v, w * u * u, w * u * v, w * v * v], 1)
    return table, key


def _result(
    total: np.ndarray, centre: np.ndarray, axes: np.ndarray, size: float, error: float
) -> tuple[float, Moments, float]:
    volume, m0, t, u, v, tt, tu, tv, uu, uv, vv = total * size
    first = size * axes.T @ np.array([t, u, v])
    second = size**2 * axes.T @ np.array([[tt, tu, tv], [tu, uu, uv], [tv, uv, vv]]) @ axes
    shift = np.outer(first, centre) + np.outer(centre, first) + m0 * np.outer(centre, centre)
    return float(volume), Moments(float(m0), first + m0 * centre, second + shift), error
