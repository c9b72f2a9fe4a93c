"""What a ball covers of a cell, exactly: its six faces and its volume.

With x from the ball's centre, a face n . x = p of the cell (n outward) cuts the ball in a disc, r^2 = R^2 - p^2, of
which the face keeps the area A; of the disc's rim the angle Phi lies in the face. A side of the face, another face
n' . x = p' meets it there, keeps the length L of the disc. The divergence theorem in the face and in the cell says

    2 A = r^2 Phi + sum over sides of p' L                3 V = R^3 W + sum over faces of p A

W the solid angle of the ball's surface in the cell. Both angles follow from how much their boundaries turn (Gauss and
Bonnet): a boundary turns by 2 pi less what the surface that it encloses is curved,

    Phi = 2 pi - pi / 2 (corners in the disc) - sum over crossings of sides of atan2(sqrt t, p')
    W   = 2 pi - sum over crossings of edges of atan2(R sqrt t, - p p') + sum over faces of (p / R) Phi      (mod 2 pi)

with t = R^2 - p^2 - p'^2, where the ball's surface crosses the edge of two faces at +-sqrt t along it. An edge is
crossed once where one of its ends lies in the ball, twice or not at all where none does. Each angle needs one face or
one edge only, so that nothing has to be told apart of how the surface lies in the cell. A ball whose radius is more
than half a cell's diagonal has W well below 2 pi in it.

A smaller one may lie in a cell as a whole, W = 4 pi, or reach out of it on all sides, so that what is left is known no
more. The planes through its centre then divide the cell in up to eight parts, to which the centre is a corner, or lies
beyond a side of them: no part holds more than an eighth of the ball's surface, W <= pi / 2, and no face of one more
than a quarter of a disc. A face of the cell is the sum of those of its parts, the same from both sides.

Errors are those of rounding, R^3 1e-15 of a cell with R in cells: 1e-11 with 48 cells across. What is found of a face
depends on its own corners only: both its cells agree, and so do mirror images.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.kernel import inner, kernel

LARGEST = 100.0  # radius in cells: R^3 1e-15 is then 1e-9, what is asked of volumes
TURN = 2.0 * np.pi
NO_PATCH = 1.0  # W is less than 2 pi - 1: what seems more is 0 but for rounding


class Ball(NamedTuple):
    """q (3, 2) [length]: lower and upper faces of a cell, from the ball's centre. Scratch: inside (8,) of its corners;
    turns, crossed, sums, fourth, area, polar (3, 2) of its faces; of the whole cell where q is of a part: cell (3, 2),
    whole (2, 3, 2) areas and polar moments."""

    q: np.ndarray
    inside: np.ndarray
    turns: np.ndarray
    crossed: np.ndarray
    sums: np.ndarray
    fourth: np.ndarray
    area: np.ndarray
    polar: np.ndarray
    cell: np.ndarray
    whole: np.ndarray


def fits(radius: float, widths: tuple[np.ndarray, ...]) -> bool:
    """Whether a ball of this radius [length] is cut exactly in cells of these widths [length] along each direction."""
    return 0.0 < radius <= LARGEST * min(float(w.min()) for w in widths)


def in_parts(radius: float, widths: tuple[np.ndarray, ...]) -> bool:
    """Whether cells are divided for a ball of this radius: it may be within one. One answer for all cells of a body, so
    that both cells of a face agree to the bit."""
    return radius < 0.5 * sum(float(w.max()) ** 2 for w in widths) ** 0.5


@inner
def _corner(d, side, a, b):
    """Number 4 i + 2 j + k of the corner at (a, b) of the face on a side across d: a along the next axis."""
    if d == 0:
        return 4 * side + 2 * a + b
    if d == 1:
        return 4 * b + 2 * side + a
    return 4 * a + 2 * b + side


@inner
def _add_edges(ball, R):
    """Edges: angles at their crossings, p' L and p' (integral of rho^2) into turns, crossed, sums and fourth of the
    faces; returns the angles of W."""
    q, total = ball.q, 0.0
    for g in range(3):
        a, b = (g + 1) % 3, (g + 2) % 3
        for sa in range(2):
            for sb in range(2):
                first, last = ball.inside[_corner(g, 0, sa, sb)], ball.inside[_corner(g, 1, sa, sb)]
                t = R * R - q[a, sa] * q[a, sa] - q[b, sb] * q[b, sb]
                if not (first or last or (t > 0.0 and q[g, 0] < 0.0 < q[g, 1])):
                    continue
                pa = q[a, sa] if sa == 1 else -q[a, sa]
                pb = q[b, sb] if sb == 1 else -q[b, sb]
                root = np.sqrt(max(t, 0.0))
                up, down = (q[g, 1] if last else root), (-q[g, 0] if first else root)
                length, cubes = up + down, (up * up * up + down * down * down) / 3.0
                ball.sums[a, sa] += pb * length
                ball.sums[b, sb] += pa * length
                ball.fourth[a, sa] += pb * (pb * pb * length + cubes)
                ball.fourth[b, sb] += pa * (pa * pa * length + cubes)
                times = 2.0 - first - last
                if times > 0.0:
                    ball.crossed[a, sa] = ball.crossed[b, sb] = True
                    ball.turns[a, sa] += times * np.arctan2(root, pb)
                    ball.turns[b, sb] += times * np.arctan2(root, pa)
                    total += times * np.arctan2(R * root, -pa * pb)
    return total


@inner
def _face(ball, R, d, side):
    """Phi and A of a face."""
    a, b = (d + 1) % 3, (d + 2) % 3
    q, crossed = ball.q, ball.crossed[d, side]
    corners = np.int64(0)
    for v in range(4):
        corners += ball.inside[_corner(d, side, v // 2, v % 2)]
    if not crossed and corners == 4:
        return 0.0, (q[a, 1] - q[a, 0]) * (q[b, 1] - q[b, 0])
    rr = R * R - q[d, side] * q[d, side]
    if not crossed and not (rr > 0.0 and q[a, 0] < 0.0 < q[a, 1] and q[b, 0] < 0.0 < q[b, 1]):
        return 0.0, 0.0
    rim = max(TURN - 0.25 * TURN * corners - ball.turns[d, side], 0.0)
    return rim, 0.5 * (rr * rim + ball.sums[d, side])


@inner
def scratch():
    """A Ball to be filled in."""
    return Ball(
        np.empty((3, 2)), np.empty(8, np.bool_), np.empty((3, 2)), np.empty((3, 2), np.bool_), np.empty((3, 2)),
        np.empty((3, 2)), np.empty((3, 2)), np.empty((3, 2)), np.empty((3, 2)), np.empty((2, 3, 2)),
    )  # fmt: skip


@inner
def _measure(ball, R):
    """Three times the volume that a ball of radius R covers of ball.q, and the number of corners in it; ball.area and
    ball.polar."""
    q, corners = ball.q, np.int64(0)
    for c in range(8):
        x, y, z = q[0, c // 4], q[1, c // 2 % 2], q[2, c % 2]
        ball.inside[c] = x * x + y * y + z * z < R * R
        corners += ball.inside[c]
    ball.turns[:], ball.sums[:], ball.fourth[:], ball.crossed[:] = 0.0, 0.0, 0.0, False
    angle, volume = -_add_edges(ball, R), 0.0
    for d in range(3):
        for side in range(2):
            rim, area = _face(ball, R, d, side)
            p = q[d, side] if side == 1 else -q[d, side]
            angle += p / R * rim
            volume += p * area
            ball.area[d, side] = area
            rr = R * R - p * p
            ball.polar[d, side] = 0.25 * (rr * rr * rim + ball.fourth[d, side]) if area > 0.0 else 0.0
    angle -= TURN * np.floor(angle / TURN)
    angle -= TURN if angle > TURN - NO_PATCH else 0.0
    return R * R * R * angle + volume, corners


@inner
def _take_part(ball, part, R):
    """ball.q becomes one of the eight parts, numbered by sides, of ball.cell; whether there is one that R reaches."""
    apart = 0.0
    for d in range(3):
        low, high = ball.cell[d, 0], ball.cell[d, 1]
        upper = (part >> d) & 1
        if low < 0.0 < high:
            ball.q[d, 0], ball.q[d, 1] = (0.0, high) if upper else (low, 0.0)
        elif upper:
            return False
        else:
            ball.q[d, 0], ball.q[d, 1] = low, high
            near = min(abs(low), abs(high))
            apart += near * near
    return apart < R * R


@inner
def _measure_parts(ball, R):
    """As _measure, of any ball: the parts of ball.q that its centre's planes make, one by one."""
    ball.cell[:], ball.whole[:], total = ball.q, 0.0, 0.0
    for part in range(8):
        if not _take_part(ball, part, R):
            continue
        volume, _ = _measure(ball, R)
        total += volume
        for d in range(3):
            for side in range(2):
                if ball.q[d, side] == ball.cell[d, side]:  # not a side within the cell
                    ball.whole[0, d, side] += ball.area[d, side]
                    ball.whole[1, d, side] += ball.polar[d, side]
    ball.q[:], ball.area[:], ball.polar[:] = ball.cell, ball.whole[0], ball.whole[1]
    corners = np.int64(0)
    for c in range(8):
        x, y, z = ball.q[0, c // 4], ball.q[1, c // 2 % 2], ball.q[2, c % 2]
        corners += x * x + y * y + z * z < R * R
    return total, corners


@inner
def cover_by_ball(ball, R, parts, least, out):
    """out (7,): shares of the faces and the volume of the cell ball.q that a ball of radius R [length] covers.

    parts: of in_parts; least [length]: discs that lie less deep in the ball are none.
    """
    q, whole = ball.q, 1.0
    volume, corners = _measure_parts(ball, R) if parts else _measure(ball, R)
    for d in range(3):
        a, b = (d + 1) % 3, (d + 2) % 3
        whole *= q[d, 1] - q[d, 0]
        section = (q[a, 1] - q[a, 0]) * (q[b, 1] - q[b, 0])
        for side in range(2):
            share = min(max(ball.area[d, side] / section, 0.0), 1.0)
            out[2 * d + side] = share if R - abs(q[d, side]) > least else 0.0
    out[6] = 1.0 if corners == 8 else min(max(volume / (3.0 * whole), 0.0), 1.0)


@inner
def moment_of_ball(ball, R, d):
    """Integral [length4] of x_d, from the ball's centre, over what a ball covers of ball.q; after cover_by_ball."""
    total = 0.0
    for side in range(2):
        p = ball.q[d, side]
        lost = (R * R - p * p) * ball.area[d, side] - ball.polar[d, side]
        total += -0.5 * lost if side == 1 else 0.5 * lost
    return total


@inner
def cover_cell(ball, sheet, parts, x, y, z, cell, least, out):
    """cover_by_ball of a cell (3,) among planes of half cells x, y, z; sheet: centre (3), 0 (3), radius [length]."""
    for side in range(2):
        ball.q[0, side] = x[2 * (cell[0] + side)] - sheet[0]
        ball.q[1, side] = y[2 * (cell[1] + side)] - sheet[1]
        ball.q[2, side] = z[2 * (cell[2] + side)] - sheet[2]
    cover_by_ball(ball, sheet[6], parts, least, out)


@kernel
def cover_cells(cells, x, y, z, sheet, parts, least, covered):
    """covered (n, 7) of cells (n, 3) [without ghosts] by one ball, as of cover_cell."""
    ball = scratch()
    for c in range(len(cells)):
        cover_cell(ball, sheet, parts, x, y, z, cells[c], least, covered[c])
