"""When two parties touch next: no event is passed, whatever the step.

Apart: conservative advancement along the separating normal n. With the speeds now and bounds on what may be gained
(paths.motion_bounds), the gap along a fixed n obeys

    s(t + τ) >= s - (n·(v_j - v_i) + ω_i ρ_i + ω_j ρ_j) τ - (a_i + a_j) τ²/2

ρ: the farthest point of a piece's core from B. The first root of the right side is safe to step to; there the gap
along the same n is looked at again (two supports), and once it has shrunk to a part, n itself (Mirtich 1996, ch. 2;
bilateral advancement: Catto 2013). Convergence is that of Newton's method without rotation, linear with it.

Touching: the gap of the pair as a whole is zero and tells nothing about a further corner that comes down. Then the
contact points of the pair are looked at, in steps that turn and move the bodies little, for one that is new - not near
to a contact that is held - and overlaps; the time at which its gap closes is found by a bracketing secant.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.contact import CONTACT
from flowgmo.collision.convex import separation, support_gap
from flowgmo.collision.paths import drift, motion_bounds, pose_at
from flowgmo.collision.shapes import POINT, POLYTOPE, place
from flowgmo.collision.touching import FEATURES, MOST_POINTS, NEAR, PIECES, is_same, touching_points
from flowgmo.collision.tree import near_pairs
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import dot, norm, quad, sub, triple

NEVER = np.inf
MOST_NORMALS = 60  # new normals in one search; then the pair is looked at again from the time reached
MOST_ADVANCES = 40  # steps along one normal
SHRUNK = 0.1  # part of the gap after which the normal is taken anew
KEPT = 1e-4  # of the reach: a step turns a held body by 0.05 rad at most, its error is a part of 0.05³
TRAVEL = 0.02  # part of a piece's reach that the bodies of a touching pair move between two looks
MOST_LOOKS = 64


@inner
def safe_step(d, closing, gain):
    """First root of d - closing τ - gain τ²/2 for d >= 0; infinity if there is none."""
    if gain > 0.0:
        root = np.sqrt(closing * closing + 2.0 * gain * d)
        if closing > 0.0:
            return 2.0 * d / (root + closing)
        return (root - closing) / gain
    return d / closing if closing > 0.0 else NEVER


@inner
def _spin(piece, rate):
    """Bound on the speed that turning at |ω| <= rate gives to a piece's core; none to a ball about B."""
    if rate == 0.0:
        return 0.0  # an endless piece at rest
    return rate * (norm(triple(piece.centre)) + max(piece.reach - piece.radius, 0.0))


@inner
def look(sh, i, j, A, laws, M, P, T, t, hits):
    """Frames of pieces i, j at time t; their bodies' rows then stand in T."""
    a, b = sh.pieces[i].body, sh.pieces[j].body
    pose_at(A[a], M[a], P[a], laws, t, T[a], hits)
    pose_at(A[b], M[b], P[b], laws, t, T[b], hits)
    return place(sh.pieces[i], triple(T[a].p), quad(T[a].q)), place(sh.pieces[j], triple(T[b].p), quad(T[b].q))


@inner
def first_touch(sh, i, j, A, laws, M, P, bounds, T, now, end, target, s, n, hits):
    """Time in [now, end) at which the gap of two pieces that are apart falls to `target`, and whether it is sure.

    s [length], n: gap and normal now; T: rows at `now`.
    """
    a, b = sh.pieces[i].body, sh.pieces[j].body
    wa, _, ga = motion_bounds(A[a], M[a], P[a], bounds[a], end - P[a].t)
    wb, _, gb = motion_bounds(A[b], M[b], P[b], bounds[b], end - P[b].t)
    spin = _spin(sh.pieces[i], wa) + _spin(sh.pieces[j], wb) + drift(P[a])[0] + drift(P[b])[0]
    t = now
    for _ in range(MOST_NORMALS):
        if s <= target:
            return t, True
        small = SHRUNK * s
        for _ in range(MOST_ADVANCES):
            closing = dot(n, sub(triple(T[b].v), triple(T[a].v))) + spin
            step = safe_step(s - 0.5 * target, closing, ga + gb)
            if not t + step < end:
                return NEVER, True
            t += step
            fi, fj = look(sh, i, j, A, laws, M, P, T, t, hits)
            s = support_gap(sh.pieces, sh.vertices, i, fi, j, fj, n)
            if s <= small or s <= target:
                break
        s, n, _, _, _ = separation(sh.pieces, sh.vertices, i, fi, j, fj, n)
    return t, False


@inner
def stays_one(sh, i, j, held, first, last):
    """Whether two pieces have one contact point at most, and it is among the held contacts first .. last - 1.

    Then none can come to them. So it is with balls on all but polytopes.
    """
    one, two = sh.pieces[i].kind, sh.pieces[j].kind
    if min(one, two) != POINT or max(one, two) == POLYTOPE:
        return False
    for c in range(first, last):
        if held[c].feature // FEATURES == i * PIECES + j:
            return True
    return False


@inner
def is_held(point, held, first, last, near):
    """Whether a contact point is one of the held contacts first .. last - 1."""
    for c in range(first, last):
        if held[c].feature == point.feature:
            return True
        if is_same(triple(point.point), triple(point.normal), held[c], near):
            return True
    return False


@inner
def _new_gap(sh, i, j, A, laws, M, P, T, t, n, within, held, first, last, points, hits):
    """Smallest gap at time t of a contact point of the two pieces that is not held; infinity: none within; and n."""
    look(sh, i, j, A, laws, M, P, T, t, hits)
    count, s, n = touching_points(sh, i, T[sh.pieces[i].body], j, T[sh.pieces[j].body], n, within, points)
    if s > within:
        return s, n
    near = NEAR * min(sh.pieces[i].reach, sh.pieces[j].reach)
    least = NEVER
    for k in range(count):
        if points[k].gap < least and not is_held(points[k], held, first, last, near):
            least = points[k].gap
    return least, n


@inner
def next_arrival(sh, i, j, A, laws, M, P, bounds, T, now, end, target, held, first, last, points, hits):
    """Time in (now, end) at which a contact point that is not held closes, for pieces that touch already."""
    a, b = sh.pieces[i].body, sh.pieces[j].body
    span = end - now
    wa, _, ga = motion_bounds(A[a], M[a], P[a], bounds[a], end - P[a].t)
    wb, _, gb = motion_bounds(A[b], M[b], P[b], bounds[b], end - P[b].t)
    size = min(sh.pieces[i].reach, sh.pieces[j].reach)
    way = norm(sub(triple(T[a].v), triple(T[b].v))) + (ga + gb) * span  # T: rows at `now`
    way += _spin(sh.pieces[i], wa) + _spin(sh.pieces[j], wb) + drift(P[a])[0] + drift(P[b])[0]
    looks = int(min(max(np.ceil(way * span / (TRAVEL * size)), 1.0), 1.0 * MOST_LOOKS))
    gap, n = _new_gap(sh, i, j, A, laws, M, P, T, now, (0.0, 0.0, 0.0), target, held, first, last, points, hits)
    level = min(gap, 0.0)  # where a point that drift has left overlapping is opening, it counts from there
    before, gap_before = now, gap
    for k in range(1, looks + 1):
        t = end if k == looks else now + span * k / looks
        gap, n = _new_gap(sh, i, j, A, laws, M, P, T, t, n, target, held, first, last, points, hits)
        if gap < level - target:
            return _closing_time(
                sh, i, j, A, laws, M, P, T, before, gap_before, t, gap, n, target, level, held, first, last, points,
                hits,
            )  # fmt: skip
        before, gap_before = t, gap
    return NEVER


@inner
def _closing_time(
    sh, i, j, A, laws, M, P, T, lo, gap_lo, hi, gap_hi, n, target, level, held, first, last, points, hits
):
    """Time between lo (open) and hi (overlap) at which the gap is at most target above the level.

    Illinois' method (Dowell & Jarratt 1971): a secant that keeps the bracket.
    """
    aim = level + 0.5 * target
    side = 0
    above = gap_lo > level + target  # seen open: before, a point that has just parted may still be within the target
    f_lo, f_hi = gap_lo - aim, gap_hi - aim
    for k in range(100):
        t = 0.5 * (lo + hi)
        if (
            f_lo > 0.0 and f_lo < NEVER and k % 8 != 7
        ):  # Illinois' secant; a bisection in between, for corners of the gap
            t = lo + (hi - lo) * f_lo / (f_lo - f_hi)
        if not lo < t < hi:
            t = 0.5 * (lo + hi)
        if not lo < t < hi:
            break
        gap, _ = _new_gap(sh, i, j, A, laws, M, P, T, t, n, target, held, first, last, points, hits)
        if above and level < gap <= level + target:
            return t
        if gap > level:
            lo, f_lo = t, gap - aim
            above = above or gap > level + target
            f_hi = 0.5 * f_hi if side == 1 else f_hi
            side = 1
        else:
            hi, f_hi = t, gap - aim
            f_lo = 0.5 * f_lo if side == -1 else f_lo
            side = -1
    return hi


@kernel
def next_events(sh, pairs, count, A, laws, M, P, bounds, T, now, end, touch, held, first_held, times, sure, room, hits):
    """Times (count,) at which pairs (count, 2) of parties touch anew in (now, end); infinity: not.

    touch (n+6, n+6) [length]: gap that counts as touching; held: contacts sorted by pair, first_held (count, 2): those
    of each pair; sure (count,): 0 where the search gave up at that time and must be taken up again from there;
    room (k, 2): for pairs of pieces. Returns the largest number of pairs of pieces; if room is smaller, call again.
    """
    points = np.zeros(MOST_POINTS, CONTACT)
    most = np.int64(0)
    for k in range(count):
        a, b = pairs[k, 0], pairs[k, 1]
        pose_at(A[a], M[a], P[a], laws, now, T[a], hits)
        pose_at(A[b], M[b], P[b], laws, now, T[b], hits)
        within = _way(sh, a, b, A, T, P, bounds, now, end) + touch[a, b]
        many = near_pairs(sh, a, (triple(T[a].p), quad(T[a].q)), b, (triple(T[b].p), quad(T[b].q)), within, room)
        most = max(most, many)
        times[k] = NEVER
        sure[k] = 1
        best = end
        for m in range(min(many, room.shape[0])):
            i, j = room[m, 0], room[m, 1]
            if m > 0:  # another pair of pieces has left the rows T at another time
                look(sh, i, j, A, laws, M, P, T, now, hits)
            fi = place(sh.pieces[i], triple(T[a].p), quad(T[a].q))
            fj = place(sh.pieces[j], triple(T[b].p), quad(T[b].q))
            s, n, _, _, _ = separation(sh.pieces, sh.vertices, i, fi, j, fj, (0.0, 0.0, 0.0))
            good = True
            near = touch[a, b]
            if first_held[k, 1] > first_held[k, 0]:
                near += KEPT * min(sh.pieces[i].reach, sh.pieces[j].reach)  # held, with a gap that drift has left
            if s <= near:
                if stays_one(sh, i, j, held, first_held[k, 0], first_held[k, 1]):
                    continue
                t = next_arrival(
                    sh, i, j, A, laws, M, P, bounds, T, now, best, touch[a, b], held, first_held[k, 0],
                    first_held[k, 1], points, hits,
                )  # fmt: skip
            else:
                t, good = first_touch(sh, i, j, A, laws, M, P, bounds, T, now, best, touch[a, b], s, n, hits)
            if t < best:
                best = t
                times[k] = t
                sure[k] = 1 if good else 0
    return most


@inner
def _way(sh, a, b, A, T, P, bounds, now, end):
    """How far two parties, their rows at `now` in T, can come nearer until `end` [length], but for turning."""
    span = end - now
    _, _, ga = motion_bounds(A[a], T[a], P[a], bounds[a], span)
    _, _, gb = motion_bounds(A[b], T[b], P[b], bounds[b], span)
    speed = norm(sub(triple(T[a].v), triple(T[b].v))) + drift(P[a])[0] + drift(P[b])[0]
    return (speed + 0.5 * (ga + gb) * span) * span
