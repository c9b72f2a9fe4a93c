"""All impacts inside one step, each at its own time.

    predict the next event of every ball            (search.py, ends of legs)
    until the step is over: take the earliest event, resolve it (resolve.py), start new legs for the balls it
    concerned (legs.py), and predict again for them and for those that had them as partner

Events of equal time: the ball that had the fewest of them first, then the lower number; so touching clusters are
resolved pair after pair in sweeps, until nobody approaches. A ball that would rest on something else than a flat's
face ends the run with a reason.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.balls.legs import RESTS, SERIES, copy_row, run_leg, start_leg
from flowgmo.collision.balls.resolve import (
    DONE,
    FAILED,
    RESTS_ON_ROUND,
    TOO_MANY,
    add_support,
    end_series,
    hit_ball,
    hit_flat,
    leg_over,
)
from flowgmo.collision.balls.resting import series_time
from flowgmo.collision.balls.search import NEVER, bound_path, meets_ball, meets_flat
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import along, dot, norm, put, triple

# what an event is; NEAR: look again from here
NOTHING, WITH_BALL, WITH_FLAT, END_OF_LEG, NEAR_BALL, NEAR_FLAT = 0, 1, 2, 3, 4, 5
COLLAPSED = 200  # events of one ball in a row at one time after which its impacts are plastic (inelastic collapse)
MOST_EVENTS = 1_000_000  # in one step: a record takes 136 bytes, and an interrupt waits for the step to end
STALLED = 2000  # events of one ball in a row at one time or place: it comes to rest where no closed form exists
IN_PLACE = 1e-6  # of its radius that a ball moves between two such events: STALLED of them are 1/500 of it together

#: The next event of a ball: when, what, and with whom (ball or flat); stalls, rattles: in a row at one time, at one
#: place (friction of one flat throws a ball that slides along a groove against the other, in ever new tiny hops).
EVENT = np.dtype(
    [("at", "f8"), ("what", "i8"), ("whom", "i8"), ("stalls", "i8"), ("rattles", "i8"), ("changed", "i8")], align=True
)


@inner
def _predict_pairs(i, first, sc, A, laws, M, L, T, now, end, events, boxes, hits):
    """Meetings of ball i with balls first, first + 1, …; boxes tell apart those that cannot meet."""
    a0, a1, a2, a3, a4, a5 = boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3], boxes[i, 4], boxes[i, 5]
    for j in range(first, boxes.shape[0]):
        if a0 > boxes[j, 3] or boxes[j, 0] > a3 or a1 > boxes[j, 4] or boxes[j, 1] > a4:
            continue
        if a2 > boxes[j, 5] or boxes[j, 2] > a5 or i == j or not sc.pairs[sc.balls[i].body, sc.balls[j].body].allowed:
            continue
        at, sure = meets_ball(i, j, sc, A, laws, M, L, T, now, end, hits)
        what = WITH_BALL if sure else NEAR_BALL
        if at < events[i].at:
            events[i].at, events[i].what, events[i].whom = at, what, j
        if at < events[j].at:
            events[j].at, events[j].what, events[j].whom = at, what, i


@inner
def _predict_alone(i, sc, A, laws, M, L, T, now, end, events, boxes, hits):
    """Ball i's end of leg, its bounding box, and its meetings with flats; forgets what was predicted before."""
    bound_path(i, sc, A, laws, M, L, T, now, end, boxes, hits)
    event = events[i]
    leg = L[i]
    event.at, event.what, event.whom = NEVER, NOTHING, -1
    if leg.until < end:
        event.at, event.what = leg.until, END_OF_LEG
    b = sc.balls[i].body
    if A[b].motion == 0:
        return
    support = M[b].support
    for f in range(sc.flats.size):
        flat = sc.flats[f]
        beyond = False
        for k in range(3):
            beyond = beyond or boxes[i, k] > flat.box[3 + k] or flat.box[k] > boxes[i, 3 + k]
        if beyond or not sc.pairs[b, flat.party].allowed:
            continue
        if f == support[0] or f == support[1] or f == support[2] or leg.mode == SERIES and leg.flat == f:
            continue
        at, sure = meets_flat(i, flat, sc, A, laws, M, L, T, now, end, hits)
        if at < event.at:
            event.at, event.what, event.whom = at, (WITH_FLAT if sure else NEAR_FLAT), f


@inner
def _predict(i, sc, A, laws, M, L, T, now, end, events, boxes, others, hits):
    _predict_alone(i, sc, A, laws, M, L, T, now, end, events, boxes, hits)
    if others is not None:
        _predict_pairs(i, 0, sc, A, laws, M, L, T, now, end, events, boxes, hits)


@inner
def _start(i, sc, A, M, L, t, end):
    """Start ball i's next leg at t; a bounce series if the last impact found that it ends within the step."""
    leg = L[i]
    if leg.flat < 0:
        return start_leg(i, sc, A, M, L, t, end)
    b = sc.balls[i].body
    leg.t = t
    leg.mode = SERIES
    put(leg.force, (0.0, 0.0, 0.0))
    leg.until = t + series_time(dot(M[b].v, leg.normal), dot(A[b].gravity, leg.normal), leg.e)
    leg.why = RESTS
    return DONE


@inner
def _bring(i, sc, A, laws, M, L, books, now, at_its_end, records, count, hits):
    """Bring ball i to now; a series is over then, and if at its end the ball stands on its flat."""
    ball = sc.balls[i]
    leg = L[i]
    row = M[ball.body]
    ok = run_leg(ball, A[ball.body], row, leg, laws, sc.rough, books, now, hits)
    leg.t = now
    if leg.mode == SERIES:
        if at_its_end:
            n = triple(leg.normal)
            put(row.v, along(triple(row.v), -dot(row.v, n), n))
            add_support(row, leg.flat)
        records = end_series(ball, row, leg, sc, now, records, count)
    return ok, records


@inner
def _stays(i, sc, A, M, L, now):
    """Whether ball i has hardly moved on its leg so far: M stands at the start of it."""
    ball = sc.balls[i]
    dt = now - L[i].t
    return (norm(M[ball.body].v) + 0.5 * norm(A[ball.body].gravity) * dt) * dt <= IN_PLACE * ball.radius


@kernel
def run_events(
    sc, A, laws, M, L, T, books, t0, t1, asked, rows, rows_force, rows_books, records, count, events, others
):
    """Move all balls from t0 to t1 [time] through their impacts.

    A (n,) BODY, M (n,) POSE (changed), L (m,) LEG, T (n,) POSE for scratch, books (4,); asked (k,): times in (t0, t1]
    whose states of the balls go to rows (k, n) POSE, rows_force (k, n, 3), rows_books (k, 4). Impacts go to
    records, their number to count (1,). Returns records (grown if needed), status, time, and the two parties of a
    status that is not DONE. others: None where there is but one ball, and no code for pairs of balls.
    """
    m = sc.balls.size
    boxes = np.empty((m, 6))
    hits = np.zeros((0, 7))
    now = t0
    count[0] = 0
    met = 0
    for i in range(m):
        L[i].flat = -1
        L[i].bounces = 0
        events[i].stalls = 0
        events[i].rattles = 0
        events[i].changed = 0
        status = start_leg(i, sc, A, M, L, t0, t1)
        if status != DONE:
            return records, status, t0, sc.balls[i].body, -1
    for i in range(m):
        _predict_alone(i, sc, A, laws, M, L, T, t0, t1, events, boxes, hits)
    for i in range(m):
        if others is not None:
            _predict_pairs(i, i + 1, sc, A, laws, M, L, T, t0, t1, events, boxes, hits)
    row = np.int64(0)
    while True:
        first = np.int64(-1)  # typed, or functions compile twice
        at = NEVER
        for i in range(m):
            soonest = events[i].at
            if soonest < at or soonest == at and soonest < NEVER and events[i].stalls < events[first].stalls:
                first, at = i, soonest
        while row < asked.size and asked[row] < min(at, t1):
            _fill_row(row, sc, A, laws, M, L, books, asked[row], rows, rows_force, rows_books, hits)
            row += 1
        if first < 0 or at >= t1:
            break
        if at > now:
            now = at
            for i in range(m):
                events[i].stalls = 0
        events[first].stalls += 1
        met += 1
        what, whom = events[first].what, events[first].whom
        with_ball = what == WITH_BALL or what == NEAR_BALL
        partner = -1
        if with_ball:
            partner = sc.balls[whom].body
        elif what == WITH_FLAT or what == NEAR_FLAT:
            partner = sc.flats[whom].party
        if met > MOST_EVENTS:
            return records, TOO_MANY, now, sc.balls[first].body, partner
        # impacts without end in no time: what is left of the speeds is below rounding, and is taken away
        collapsed = events[first].stalls > COLLAPSED
        stays = _stays(first, sc, A, M, L, now) and (not with_ball or _stays(whom, sc, A, M, L, now))
        events[first].rattles = events[first].rattles + 1 if stays else 0
        if events[first].stalls > STALLED or events[first].rattles > STALLED:
            return records, RESTS_ON_ROUND, now, sc.balls[first].body, partner
        events[first].changed = 1
        if with_ball:
            events[whom].changed = 1
        for k in range(m):
            if events[k].changed:
                ends = what == END_OF_LEG and L[k].why == RESTS
                ok, records = _bring(k, sc, A, laws, M, L, books, now, ends, records, count, hits)
                if not ok:
                    return records, FAILED, now, sc.balls[k].body, -1
        status = DONE
        if what == WITH_FLAT:
            records, status = hit_flat(first, whom, sc, A, M, L, books, now, t1, collapsed, records, count)
        elif what == END_OF_LEG:
            leg_over(first, sc, M, L)
        if others is not None:
            if what == WITH_BALL:
                records, status = hit_ball(first, whom, sc, A, M, books, now, collapsed, records, count)
        for k in range(m):
            if status == DONE and events[k].changed:
                status = _start(k, sc, A, M, L, now, t1)
        if status != DONE:
            return records, status, now, sc.balls[first].body, partner
        for k in range(m):
            if events[k].changed:
                _predict(k, sc, A, laws, M, L, T, now, t1, events, boxes, others, hits)
        for k in range(m):
            kind = events[k].what
            if not events[k].changed and (kind == WITH_BALL or kind == NEAR_BALL) and events[events[k].whom].changed:
                _predict(k, sc, A, laws, M, L, T, now, t1, events, boxes, others, hits)
        events[first].changed = 0
        if with_ball:
            events[whom].changed = 0
    for i in range(m):
        ok, records = _bring(i, sc, A, laws, M, L, books, t1, t1 < t0, records, count, hits)
        if not ok:
            return records, FAILED, t1, sc.balls[i].body, -1
    while row < asked.size:
        _fill_row(row, sc, A, laws, M, L, books, asked[row], rows, rows_force, rows_books, hits)
        row += 1
    return records, DONE, t1, -1, -1


@inner
def _fill_row(r, sc, A, laws, M, L, books, t, rows, rows_force, rows_books, hits):
    """State of all balls at time t, and the books with what the legs in progress have lost by then."""
    for k in range(books.size):
        rows_books[r, k] += books[k]
    for i in range(sc.balls.size):
        ball = sc.balls[i]
        copy_row(rows[r, ball.body], M[ball.body])
        run_leg(ball, A[ball.body], rows[r, ball.body], L[i], laws, sc.rough, rows_books[r], t, hits)
        put(rows_force[r, ball.body], L[i].force)
