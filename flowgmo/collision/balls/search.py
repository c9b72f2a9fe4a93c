"""When two surfaces meet: time of impact by conservative advancement, which cannot pass a contact at any step.

A ball against a convex partner: along any path x(t) of its centre relative to the partner the distance obeys

    d(t + τ) >= d + d' τ - A τ²/2        d' = n·u now,  A >= |d²x/dt²|      (the distance to a convex set is convex)

so the first root of the right side is a safe step; near a contact it converges like Newton's method. Two balls whose
paths have the same acceleration, and a ball above a face that fills a half-space, are solved at once.
Source: Mirtich 1996, §2.3 (conservative advancement); the convexity bound in place of his speed bound is ours.

A search returns the time (NEVER if there is none before `end`) and whether it is sure: unsure means that it came near
and gave up there, and the pair is to be looked at again from that time.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.stops import first_crossing
from flowgmo.collision.balls.distance import box_distance
from flowgmo.collision.balls.legs import AT_REST, FLIGHT, SEPARATING, SERIES, middle, speed_tolerance
from flowgmo.kernel import inner
from flowgmo.vectors import dot, norm, sub, triple

NEVER = np.inf
CLOSE = 1e-14  # gap that counts as contact, in radii (plus four units in the last place of the coordinates)
LAST_PLACE = 1e-15
MAX_ADVANCES = 500  # then the pair is looked at again from the time reached
PRESSING = 1e-12  # relative acceleration below this part of both accelerations is round-off
LEVEL = 1e-12  # one minus the cosine of two normals up to which faces count as level: a step of 1e-12 radii
GRAZE = 1e-4  # how far a contact without normal speed is followed to see where it goes, in radii


@inner
def _acceleration_bound(i, sc, M, L, span):
    """Bound on |acceleration| of ball i's centre over the coming span [time]."""
    leg = L[i]
    if leg.mode == FLIGHT:
        return norm(leg.acc)
    if leg.mode == AT_REST:
        return 0.0
    ball = sc.balls[i]
    rate = norm(M[ball.body].w) + ball.turn_gain * span
    return ball.gain + ball.swing * (ball.turn_gain + rate * rate)


@inner
def _series_speed(i, sc, A, M, L):
    """Bound on the speed of a ball in a bounce series."""
    ball = sc.balls[i]
    row = M[ball.body]
    span = max(L[i].until - L[i].t, 0.0)
    return norm(row.v) + ball.radius * norm(row.w) + norm(A[ball.body].gravity) * span


@inner
def bound_path(i, sc, A, laws, M, L, T, now, end, boxes, hits):
    """boxes[i] (6): lowest and highest corner of all that ball i may touch from now to end, if no event comes.

    With it two balls that cannot meet are told apart by six comparisons.
    """
    leg = L[i]
    radius = sc.balls[i].radius * (1.0 + 1e-9)  # a touch is not to be lost by rounding
    x, u = middle(i, sc, A, laws, M, L, T, now, hits)
    span = end - now
    far = 0.0
    if leg.mode == SERIES:
        far = _series_speed(i, sc, A, M, L) * span
    elif leg.mode != FLIGHT:
        far = (norm(u) + 0.5 * _acceleration_bound(i, sc, M, L, span) * span) * span
    for k in range(3):
        lo, hi = x[k] - far, x[k] + far
        if leg.mode == FLIGHT:
            a = leg.acc[k]
            at_end = x[k] + (u[k] + 0.5 * a * span) * span
            lo, hi = min(lo, at_end), max(hi, at_end)
            if u[k] * a < 0.0 and abs(u[k]) < abs(a) * span:  # turns on the way
                turn = x[k] - 0.5 * u[k] * u[k] / a
                lo, hi = min(lo, turn), max(hi, turn)
        rounding = 1e-14 * (abs(lo) + abs(hi))
        boxes[i, k] = lo - radius - rounding
        boxes[i, 3 + k] = hi + radius + rounding


@inner
def safe_step(d, speed, bound):
    """First root of d + speed τ - bound τ²/2 for d >= 0; infinity if there is none."""
    if bound > 0.0:
        root = np.sqrt(speed * speed + 2.0 * bound * d)
        if speed < 0.0:
            return 2.0 * d / (root - speed)
        return (speed + root) / bound
    return d / -speed if speed < 0.0 else NEVER


@inner
def meets_flat(i, flat, sc, A, laws, M, L, T, now, end, hits):
    """Time in [now, end) at which ball i touches a flat and approaches or presses it."""
    ball = sc.balls[i]
    leg = L[i]
    body = A[ball.body]
    x, u = middle(i, sc, A, laws, M, L, T, now, hits)
    if leg.mode == FLIGHT and flat.face >= 0:
        return _meets_half_space(ball, leg, body, flat, x, u, now, end), True
    in_series = leg.mode == SERIES
    fastest = _series_speed(i, sc, A, M, L) if in_series else 0.0
    bound = _acceleration_bound(i, sc, M, L, end - now)
    t = now
    for _ in range(MAX_ADVANCES):
        d, n, place = box_distance(x, flat)
        d -= ball.radius
        speed = dot(n, u)
        if d <= CLOSE * ball.radius + LAST_PLACE * norm(x):
            if in_series:
                return t, False
            if leg.mode == FLIGHT and dot(leg.force, leg.ground) > 0.0 and dot(n, leg.ground) > 1.0 - LEVEL:
                return NEVER, True  # the joint of two level faces is no obstacle to a ball that one of them carries
            tolerance = speed_tolerance(ball, body, u)
            if speed < -tolerance:
                return t, True
            if speed <= tolerance:
                if leg.mode == FLIGHT and place == 1:
                    presses = dot(n, leg.acc) < -PRESSING * norm(body.gravity)
                    return (t if presses else NEVER), True
                if _turns_in(i, flat, sc, A, laws, M, L, T, t, d, bound, u, hits):
                    return t, True
                speed = max(speed, GRAZE * np.sqrt(bound * ball.radius))  # grazes past: go on a little
        gap = max(d, 0.0)
        step = gap / fastest if in_series else safe_step(gap, speed, bound)
        if not t + step < end:
            return NEVER, True
        t += step
        x, u = middle(i, sc, A, laws, M, L, T, t, hits)
    return t, False


@inner
def _turns_in(i, flat, sc, A, laws, M, L, T, t, d, bound, u, hits):
    """Whether a ball that touches without normal speed is nearer a little later."""
    if bound == 0.0:
        return False
    radius = sc.balls[i].radius
    h = np.sqrt(2.0 * GRAZE * radius / bound)
    speed = norm(u)
    if speed > 0.0:
        h = min(h, GRAZE * radius / speed)
    x, _ = middle(i, sc, A, laws, M, L, T, t + h, hits)
    later, _, _ = box_distance(x, flat)
    return later - radius < d - 1e-3 * bound * h * h  # 1e-3: well above round-off, well below free fall's half


@inner
def _meets_half_space(ball, leg, body, flat, x, u, now, end):
    """Closed form for constant acceleration above one face."""
    axis = flat.face
    upper = np.isfinite(flat.hi[axis])
    side = 1.0 if upper else -1.0
    a = triple(flat.axes[axis])
    level = flat.hi[axis] if upper else flat.lo[axis]
    d = side * (dot(a, sub(x, triple(flat.origin))) - level) - ball.radius
    speed = side * dot(a, u)
    pull = side * dot(a, leg.acc)
    if d <= CLOSE * ball.radius + LAST_PLACE * norm(x):
        tolerance = speed_tolerance(ball, body, u)
        if speed < -tolerance or (speed <= tolerance and pull < -PRESSING * norm(body.gravity)):
            return now
        if speed <= tolerance or pull >= 0.0:
            return NEVER
        at = now + 2.0 * speed / -pull  # rises from the face and comes back
    else:
        at = now + first_crossing(d, -speed, -pull)
    return at if at < end else NEVER


@inner
def meets_ball(i, j, sc, A, laws, M, L, T, now, end, hits):
    """Time in [now, end) at which balls i and j touch and approach or press each other."""
    leg, other = L[i], L[j]
    if leg.mode == SERIES or other.mode == SERIES:
        return _meets_slowly(i, j, sc, A, laws, M, L, T, now, end, hits)
    reach = sc.balls[i].radius + sc.balls[j].radius
    x, u = middle(i, sc, A, laws, M, L, T, now, hits)
    y, w = middle(j, sc, A, laws, M, L, T, now, hits)
    flying = leg.mode == FLIGHT and other.mode == FLIGHT
    pull = sub(triple(leg.acc), triple(other.acc))
    if flying:
        bound = norm(pull)
        if bound <= PRESSING * (norm(leg.acc) + norm(other.acc)):
            return _meets_straight(sub(x, y), sub(u, w), norm(u) + norm(w), norm(x), reach, now, end), True
    else:
        bound = _acceleration_bound(i, sc, M, L, end - now) + _acceleration_bound(j, sc, M, L, end - now)
    t = now
    for _ in range(MAX_ADVANCES):
        gap = sub(x, y)
        relative = sub(u, w)
        distance = norm(gap)
        d = distance - reach
        speed = dot(gap, relative) / distance
        if d <= CLOSE * reach + LAST_PLACE * norm(x):
            tolerance = SEPARATING * (norm(u) + norm(w) + np.sqrt(bound * reach))
            if speed < -tolerance:
                return t, True
            if speed <= tolerance:
                turning = (dot(relative, relative) - speed * speed) / distance
                inward = dot(pull, gap) / distance if flying else -bound
                if turning + inward < -PRESSING * bound:
                    return t, True
                speed = max(speed, GRAZE * np.sqrt(bound * reach))
        step = safe_step(max(d, 0.0), speed, bound)
        if not t + step < end:
            return NEVER, True
        t += step
        x, u = middle(i, sc, A, laws, M, L, T, t, hits)
        y, w = middle(j, sc, A, laws, M, L, T, t, hits)
    return t, False


@inner
def _meets_straight(gap, relative, speeds, size, reach, now, end):
    """Two balls of equal acceleration: relative motion is straight, the contact a root of a quadratic."""
    half_b = dot(gap, relative)
    a = dot(relative, relative)
    if half_b >= 0.0 or a == 0.0:
        return NEVER
    distance = norm(gap)
    d = distance - reach
    if d <= CLOSE * reach + LAST_PLACE * size:
        # touching: a real approach is an impact, round-off of a separation is not
        return now if half_b < -SEPARATING * distance * speeds else NEVER
    c = d * (distance + reach)
    under = half_b * half_b - a * c
    if under <= 0.0:
        return NEVER
    at = now + c / (-half_b + np.sqrt(under))
    return at if at < end else NEVER


@inner
def _meets_slowly(i, j, sc, A, laws, M, L, T, now, end, hits):
    """A ball in a bounce series has bounded speed, but no bounded acceleration: advance by the gap over the speeds."""
    reach = sc.balls[i].radius + sc.balls[j].radius
    x, u = middle(i, sc, A, laws, M, L, T, now, hits)
    y, w = middle(j, sc, A, laws, M, L, T, now, hits)
    span = end - now
    fastest = 0.0
    fastest += (
        _series_speed(i, sc, A, M, L)
        if L[i].mode == SERIES
        else norm(u) + span * _acceleration_bound(i, sc, M, L, span)
    )
    fastest += (
        _series_speed(j, sc, A, M, L)
        if L[j].mode == SERIES
        else norm(w) + span * _acceleration_bound(j, sc, M, L, span)
    )
    t = now
    for _ in range(MAX_ADVANCES):
        d = norm(sub(x, y)) - reach
        if d <= 1e-9 * reach:
            return t, False  # near enough that the series is ended and the bounces are followed one by one
        t += d / fastest
        if not t < end:
            return NEVER, True
        x, u = middle(i, sc, A, laws, M, L, T, t, hits)
        y, w = middle(j, sc, A, laws, M, L, T, t, hits)
    return t, False
