"""Where two faces overlap, seen along the contact normal: polygon against polygon, edge against edge, in the plane.

Points are rows (u, v, w, number): two coordinates across the normal, the height along it, the corner's number. A face
is clipped by one side of the other after the other (Sutherland & Hodgman 1974). Every corner of the result is a corner
of one inside the other or a crossing of two sides, and that is its feature number: 15 bits for each piece,

    face + sum of its corners' numbers  |  CORNER + number  |  SIDE + number made of its two ends
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner

PART = 8192  # numbers of faces, corners, and sides are below it: 13 bits
CORNER = PART
SIDE = 2 * PART
PIECE_BITS = 32768  # 15 bits a piece: both together are below 2^30
OTHER = 64  # added to a side's place: it is the clipping polygon's. Beyond any place of the clipped one


@inner
def face_part(face, count):
    """Number of a face of `count` corners; a single corner, a single edge have their own."""
    if count == 1:
        return CORNER + np.int64(face[0, 3]) % PART
    if count == 2:
        return side_part(face, count, 0)
    total = np.int64(0)
    for k in range(count):
        total += np.int64(face[k, 3])
    return total % PART


@inner
def side_part(face, count, k):
    """Number of the side from corner k to the next."""
    a, b = np.int64(face[k, 3]), np.int64(face[(k + 1) % count, 3])
    return SIDE + (min(a, b) * 97 + max(a, b)) % PART  # 97: sides of up to 97 corners keep different numbers


@inner
def clip(face, count, other, others, slack, work):
    """Corners of the convex polygon face (count rows; an edge, a point too) that lie in the polygon other (3 or more).

    Points within slack [length] of a side count as inside, so that sides that lie on each other make no extra corners.
    work (2, 24, 4). Returns k and the number of rows of work[k], which hold u, v, and both parts in one number, face's
    times PIECE_BITS.
    """
    area = 0.0
    for k in range(others):
        m = (k + 1) % others
        area += (other[k, 0] - other[0, 0]) * (other[m, 1] - other[0, 1])
        area -= (other[k, 1] - other[0, 1]) * (other[m, 0] - other[0, 0])
    sense = 1.0 if area >= 0.0 else -1.0
    here, there = face_part(face, count), face_part(other, others)
    now = np.int64(0)
    total = count
    for k in range(count):
        # u, v, both parts in one number, the side that follows
        part = CORNER + np.int64(face[k, 3]) % PART
        _put(work, 0, k, face[k, 0], face[k, 1], part * PIECE_BITS + there, k)
    for m in range(others):
        q = (m + 1) % others
        pu, pv = other[m, 0], other[m, 1]
        du, dv = sense * (other[q, 0] - pu), sense * (other[q, 1] - pv)
        length = np.sqrt(du * du + dv * dv)
        if length <= slack:
            continue
        du, dv = du / length, dv / length
        kept = np.int64(0)
        yu, yv, y_part, y_side = work[now, 0, 0], work[now, 0, 1], work[now, 0, 2], work[now, 0, 3]
        dy = du * (yv - pv) - dv * (yu - pu)
        for k in range(count):
            xu, xv, x_part, x_side, dx = yu, yv, y_part, y_side, dy
            q = (k + 1) % count
            yu, yv, y_part, y_side = work[now, q, 0], work[now, q, 1], work[now, q, 2], work[now, q, 3]
            dy = du * (yv - pv) - dv * (yu - pu)
            if dx >= -slack:
                leaves = dy < -slack and dx <= slack  # on the side itself: what follows is the side
                kept = _put(work, 1 - now, kept, xu, xv, x_part, OTHER + m if leaves else x_side)
            if (dx > slack and dy < -slack) or (dx < -slack and dy > slack):
                t = dx / (dx - dy)
                edge = np.int64(x_side)
                if edge < OTHER:
                    part = side_part(face, total, edge) * PIECE_BITS + side_part(other, others, m)
                else:
                    # where two of the other's sides meet is its corner
                    corner = m if (edge - OTHER + 1) % others == m else (m + 1) % others
                    part = here * PIECE_BITS + CORNER + np.int64(other[corner, 3]) % PART
                side = OTHER + m if dx > 0.0 else x_side
                kept = _put(work, 1 - now, kept, xu + t * (yu - xu), xv + t * (yv - xv), part, side)
        count = kept
        now = 1 - now
        if count == 0:
            break
    return now, count


@inner
def _put(work, now, k, u, v, part, side):
    work[now, k, 0], work[now, k, 1], work[now, k, 2], work[now, k, 3] = u, v, part, side
    return k + 1


@inner
def overlap(face, other, aside, slack, work):
    """Two edges (two rows each): the ends of their overlap if they are parallel, else where they cross.

    Parallel: they part by no more than aside [length] over the longer one. Returns the number of rows of work[0] (u, v,
    parts) set, 0 if they miss each other.
    """
    au, av, bu, bv = face[0, 0], face[0, 1], other[0, 0], other[0, 1]
    lu, lv, mu, mv = face[1, 0] - au, face[1, 1] - av, other[1, 0] - bu, other[1, 1] - bv
    la, lb = np.sqrt(lu * lu + lv * lv), np.sqrt(mu * mu + mv * mv)
    if la <= slack or lb <= slack:
        return np.int64(0)
    here, there = side_part(face, 2, 0), side_part(other, 2, 0)
    area = lu * mv - lv * mu
    if abs(area) > aside * min(la, lb):
        x, y = ((bu - au) * mv - (bv - av) * mu) / area, ((bu - au) * lv - (bv - av) * lu) / area
        if max(-x, x - 1.0) * la > slack or max(-y, y - 1.0) * lb > slack:
            return np.int64(0)
        return _put(work, 0, 0, au + x * lu, av + x * lv, here * PIECE_BITS + there, 0)
    # along their common direction, in lengths from the first end of each
    sense = 1.0 if lu * mu + lv * mv >= 0.0 else -1.0
    du, dv = lu / la + sense * mu / lb, lv / la + sense * mv / lb
    d = np.sqrt(du * du + dv * dv)
    du, dv = du / d, dv / d
    shift = (bu - au) * du + (bv - av) * dv
    pa, pb = lu * du + lv * dv, mu * du + mv * dv
    lo, hi = max(0.0, min(shift, shift + pb)), min(pa, max(shift, shift + pb))
    if hi < lo - slack:
        return np.int64(0)
    count = np.int64(0)
    for k in range(2 if hi - lo > slack else 1):
        at = lo if k == 0 else hi
        x, y = at / pa, (at - shift) / pb
        if at == 0.0 or at == pa:
            part = (CORNER + np.int64(face[0 if at == 0.0 else 1, 3]) % PART) * PIECE_BITS + there
        else:
            part = here * PIECE_BITS + CORNER + np.int64(other[1 if y > 0.5 else 0, 3]) % PART
        u, v = 0.5 * (au + x * lu + bu + y * mu), 0.5 * (av + x * lv + bv + y * mv)
        count = _put(work, 0, count, u, v, part, 0)
    return count


@inner
def nearest(faces, counts, work):
    """The middle between the nearest points of two outlines (faces[0], faces[1]) that do not overlap: corner to side.

    Written to work[0, 0]; returns 1.
    """
    least = np.inf
    for k in range(counts[0] + counts[1]):
        # a corner of one, each side of the other
        a = 0 if k < counts[0] else 1
        c = k if a == 0 else k - counts[0]
        sides = counts[1] if a == 0 else counts[0]
        xu, xv = faces[a, c, 0], faces[a, c, 1]
        for m in range(sides):
            q = (m + 1) % sides
            pu, pv = faces[1 - a, m, 0], faces[1 - a, m, 1]
            du, dv = faces[1 - a, q, 0] - pu, faces[1 - a, q, 1] - pv
            dd = du * du + dv * dv
            t = min(max(((xu - pu) * du + (xv - pv) * dv) / dd, 0.0), 1.0) if dd > 0.0 else 0.0
            gu, gv = xu - pu - t * du, xv - pv - t * dv
            if gu * gu + gv * gv < least:
                least = gu * gu + gv * gv
                corner = CORNER + np.int64(faces[a, c, 3]) % PART
                side = side_part(faces[1 - a], sides, m)
                part = corner * PIECE_BITS + side if a == 0 else side * PIECE_BITS + corner
                _put(work, 0, 0, xu - 0.5 * gu, xv - 0.5 * gv, part, 0)
    return np.int64(1)
