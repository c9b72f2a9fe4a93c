"""What happens at an event: impacts of balls with flats and with each other, and the ends of legs."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import DRIVEN, HINGED
from flowgmo.collision.balls.distance import box_distance
from flowgmo.collision.balls.legs import LEAVES, ROLLS, speed_tolerance
from flowgmo.collision.balls.resting import rolling_spin, series_time
from flowgmo.collision.impact_exact import ball_impact
from flowgmo.kernel import inner
from flowgmo.records import REST
from flowgmo.vectors import add, along, cross, dot, norm, put, quad, rotate, scale, sub, triple

# how a step can end
DONE, SEVERAL_ROUGH, FAILED, RESTS_ON_ROUND, LOCKED, TOO_MANY = 0, 1, 2, 3, 4, 5
# columns of a record
TIME, PARTY_A, PARTY_B, POINT, NORMAL, IMPULSE, REST_E, REST_MU, REGIME, LOSS, COUNT, WIDTH = (
    0, 1, 2, 3, 6, 9, 12, 13, 14, 15, 16, 17,
)  # fmt: skip
IN_IMPACTS, FROM_PRESCRIBED = 0, 2  # State.books
RIM = 1e-9  # a contact point this near to the rim of a face, in radii, counts as beyond it


@inner
def _record(records, count, t, a, b, point, n, impulse, e, mu, regime, loss, bounces):
    """Append a row to the table and count it (count (1,)); the table doubles when it is full. Returns it."""
    filled = count[0]
    if filled == records.shape[0]:
        larger = np.zeros((2 * filled, WIDTH))
        for i in range(filled):
            for k in range(WIDTH):
                larger[i, k] = records[i, k]
        records = larger
    count[0] = filled + 1
    row = records[filled]
    row[TIME], row[PARTY_A], row[PARTY_B] = t, a, b
    for k in range(3):
        row[POINT + k] = point[k]
        row[NORMAL + k] = n[k]
        row[IMPULSE + k] = impulse[k]
    row[REST_E], row[REST_MU], row[REGIME], row[LOSS], row[COUNT] = e, mu, regime, loss, bounces
    return records


@inner
def end_series(ball, row, leg, sc, t, records, count):
    """Write the bounces of a series that is over, or interrupted, as one record."""
    if leg.bounces > 0:
        n = triple(leg.normal)
        point = along(triple(row.p), -ball.radius, n)
        records = _record(
            records, count, t, float(ball.body), float(sc.flats[leg.flat].party), point, n, triple(leg.impulse),
            leg.e, leg.mu, float(REST), leg.loss, float(leg.bounces),
        )  # fmt: skip
    leg.bounces = 0
    leg.flat = -1
    return records


@inner
def add_support(row, f):
    """Note that a ball rests on flat f."""
    for k in range(3):
        if row.support[k] < 0:
            row.support[k] = f
            return


@inner
def _surface_arm(ball, row, n, side):
    """From B to the ball's surface point that lies at -side·R n from its middle."""
    return along(rotate(quad(row.q), ball.centre), -side * ball.radius, n)


@inner
def _surface_velocity(ball, row, n, side):
    return add(triple(row.v), cross(triple(row.w), _surface_arm(ball, row, n, side)))


@inner
def _inverse_masses(ball, body, row, n, side):
    """A ball's share of kn and kt [1/mass]; of a hinged ball only kn counts (its pairs are frictionless)."""
    if body.motion == HINGED:
        arm = add(sub(triple(row.p), triple(body.point)), _surface_arm(ball, row, n, side))
        lever = dot(body.axis, cross(arm, n))
        kn = lever * lever / body.hinge_moment
        return kn, kn
    kn = ball.inverse_mass
    return kn, kn + ball.radius * ball.radius * ball.inverse_inertia


@inner
def _push(ball, body, row, n, side, impulse):
    """Change a ball's velocities by the impulse at its surface point -side·R n."""
    if body.motion == HINGED:
        from_axis = sub(triple(row.p), triple(body.point))
        arm = add(from_axis, _surface_arm(ball, row, n, side))
        gain = dot(body.axis, cross(arm, impulse)) / body.hinge_moment
        w = along(triple(row.w), gain, body.axis)
        put(row.w, w)
        put(row.v, cross(w, from_axis))
        return
    put(row.v, along(triple(row.v), ball.inverse_mass, impulse))
    put(row.w, along(triple(row.w), -side * ball.radius * ball.inverse_inertia, cross(n, impulse)))


@inner
def hit_flat(i, f, sc, A, M, L, books, t, end, plastic, records, count):
    """Resolve the contact of ball i, its row at t, with flat f; plastic: whatever e < 1. Returns records, status."""
    ball = sc.balls[i]
    body = A[ball.body]
    row = M[ball.body]
    flat = sc.flats[f]
    pair = sc.pairs[ball.body, flat.party]
    e = 0.0 if plastic and pair.e < 1.0 else pair.e
    x = add(triple(row.p), rotate(quad(row.q), ball.centre))
    d, n, place = box_distance(x, flat)
    if body.motion != HINGED:
        put(row.p, along(triple(row.p), ball.radius - d, n))  # on the surface, to the last bit
    v = _surface_velocity(ball, row, n, 1.0)
    vn = dot(v, n)
    tolerance = speed_tolerance(ball, body, row.v)
    rebound = 0.0
    if vn < -tolerance:
        kn, kt = _inverse_masses(ball, body, row, n, 1.0)
        if kn == 0.0:
            return records, LOCKED
        impulse, regime, loss = ball_impact(v, n, e, pair.mu, kn, kt)
        _push(ball, body, row, n, 1.0, impulse)
        books[IN_IMPACTS] += loss
        records = _record(
            records, count, t, float(ball.body), float(flat.party), along(x, -d, n), n, impulse, e, pair.mu,
            float(regime), loss, 1.0,
        )  # fmt: skip
        rebound = e * -vn
        if body.motion != HINGED:
            put(row.v, along(triple(row.v), rebound - dot(row.v, n), n))  # e |v|, to the last bit
    pull = dot(body.gravity, n)
    if not ball.parabolic or place != 1 or pull >= 0.0:
        return records, DONE  # bounces on; where it would rest without a closed form it stalls and is reported
    free = row.support[0] < 0 and row.support[1] < 0 and row.support[2] < 0
    if rebound <= tolerance:
        add_support(row, f)
    elif e < 1.0 and free and t + series_time(rebound, pull, e) < end:
        leg = L[i]
        leg.flat = f
        leg.e = e
        leg.mu = pair.mu
        put(leg.normal, n)
    return records, DONE


@inner
def hit_ball(i, j, sc, A, M, books, t, plastic, records, count):
    """Resolve the contact of balls i and j, both rows at t; plastic: whatever e < 1. Returns records, status."""
    one, two = sc.balls[i], sc.balls[j]
    body, other = A[one.body], A[two.body]
    row, row2 = M[one.body], M[two.body]
    pair = sc.pairs[one.body, two.body]
    e = 0.0 if plastic and pair.e < 1.0 else pair.e
    x = add(triple(row.p), rotate(quad(row.q), one.centre))
    y = add(triple(row2.p), rotate(quad(row2.q), two.centre))
    gap = sub(x, y)
    n = scale(1.0 / norm(gap), gap)
    u, w = _surface_velocity(one, row, n, 1.0), _surface_velocity(two, row2, n, -1.0)
    v = sub(u, w)
    if dot(v, n) >= 0.0:
        return records, RESTS_ON_ROUND
    kn, kt = _inverse_masses(one, body, row, n, 1.0)
    kn2, kt2 = _inverse_masses(two, other, row2, n, -1.0)
    if kn + kn2 == 0.0:
        return records, LOCKED
    impulse, regime, loss = ball_impact(v, n, e, pair.mu, kn + kn2, kt + kt2)
    if body.motion == DRIVEN:  # what a driven body gives to the others
        books[FROM_PRESCRIBED] -= dot(impulse, u)
    if other.motion == DRIVEN:
        books[FROM_PRESCRIBED] += dot(impulse, w)
    _push(one, body, row, n, 1.0, impulse)
    _push(two, other, row2, n, -1.0, scale(-1.0, impulse))
    books[IN_IMPACTS] += loss
    records = _record(
        records, count, t, float(one.body), float(two.body), along(y, two.radius, n), n, impulse, e, pair.mu,
        float(regime), loss, 1.0,
    )  # fmt: skip
    return records, DONE


@inner
def leg_over(i, sc, M, L):
    """What the end of ball i's leg means for its row, which stands at that time: it rolls, or leaves a face."""
    ball = sc.balls[i]
    row = M[ball.body]
    leg = L[i]
    if leg.why == ROLLS:
        put(row.w, rolling_spin(triple(row.v), triple(row.w), triple(leg.ground), ball.radius))
        return
    if leg.why != LEAVES:
        return
    rim = RIM * ball.radius
    for k in range(3):
        if row.support[k] < 0:
            continue
        flat = sc.flats[row.support[k]]
        _, n, _ = box_distance(triple(row.p), flat)
        for axis in range(3):
            a = triple(flat.axes[axis])
            if abs(dot(a, n)) > 0.5:
                continue
            y = dot(a, sub(triple(row.p), triple(flat.origin)))
            if y > flat.hi[axis] - rim:
                put(row.p, along(triple(row.p), 2.0 * rim, a))
                row.support[k] = -1
                break
            if y < flat.lo[axis] + rim:
                put(row.p, along(triple(row.p), -2.0 * rim, a))
                row.support[k] = -1
                break
