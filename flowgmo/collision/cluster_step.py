"""One step of a cluster of springs: implicit, of second order, exact in energy. The law stands in clusters.py.

Known at the start: velocities v, energies E of the springs, depths δ = ((1 + η) E)^(1/(1+η)) and forces f = δ^η (the
scaled, equal stiffness is 1). Wanted: impulses Δ of all contacts, with the end velocities v' = v + K Δ. Every contact
goes straight from v to v', so its mean work per impulse is known by hand, with 1/e² on the part where it opens:

    taken(v, v') = ½ (v + v')            both closing
                   ½ (v + v') / e²       both opening
                   (v'²/e² - v²) / (2 (v' - v))   from closing to opening, and alike from opening to closing

    depth   δ' = δ - h taken,     normal impulse  Δn = h × mean of δ^η over the straight way from δ to δ' (Simpson)
    energy  E' = E - taken Δn;    a spring that would end below zero gives Δn = E / taken instead: it ends

Where friction lets the sweeps stop early, `taken` still moves after Δn was found, and a spring that ended keeps
some 1e-8 of its energy. The next step ends it again, and so on: left alone, E would fall by that factor a step, for as
long as the others push, down to numbers that have no digits and divide to infinity. So a spring that opens is over when
its energy could move no contact by more than round-off: K_nn <= 1, so that is E <= ½ ROUND_OFF².

The bodies' kinetic energy changes by ½ (v + v')·Δ, the same quadratic form: nothing is created by the size of the step.
The tangential parts of Δ come from friction.coulomb. All together are found by sweeps over the active contacts, each
seeing the latest end velocities; the normal part contracts by (h ω)²/4 a sweep.

The first sweep of a step is a guess, with acceleration and tilts as in the last step: good to third order where the
step is smooth, so that two sweeps do where there is no event. They stop when the next one, by the ratio of the last
two, would change less than is wanted. Contacts that an active one pushes without being active feel it in `accept`.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.friction import coulomb
from flowgmo.kernel import inner

ROUND_OFF = 1e-13  # change of a velocity, in v_ref, that a sweep may leave; sums of some hundred contacts round to it
SLOWEST = 0.1  # e below it does not shorten the steps further: its whole release carries less than 1 % of the energy

SPENT = 0.5 * ROUND_OFF * ROUND_OFF  # energy [v_ref²/K_ref] that moves no contact by more than ROUND_OFF: K_nn <= 1

COARSEST = 0.3  # h ω that is never exceeded: ten steps a swing, sweeps contract by 0.02


@inner
def power(depth, eta):
    """Force of a spring, depth^eta."""
    if eta == 1.5:
        return depth * np.sqrt(depth)
    if eta == 1.0:
        return depth
    return depth**eta


@inner
def taken(v, w, rate):
    """Energy that a spring loses per impulse while its velocity goes from v to w; rate = 1/e² where it opens."""
    if v <= 0.0:
        if w <= 0.0:
            return 0.5 * (v + w)
        return 0.5 * (rate * w * w - v * v) / (w - v)
    if w >= 0.0:
        return 0.5 * rate * (v + w)
    return 0.5 * (rate * v * v - w * w) / (v - w)


@inner
def _release(s, p):
    """Impulse that uses up what a spring stores: taken(v, w) p = E, w = b + K p, b the end velocity without it.

    Found for itself, because it decides its own end velocity: as one of the sweeps, p = E / taken(v, w) swings about
    its root for ever. p: the answer where the spring closes again within the step.
    """
    v, k = s.v[2], s.own[2, 2]
    b = s.end[2] - k * s.dp[2]
    gain = 2.0 * k * s.stored
    if v >= 0.0:  # (v + b + u) u = gain / rate,  u = K p
        root = np.sqrt((v + b) * (v + b) + 4.0 * gain / s.rate)
        u = 2.0 * gain / s.rate / (v + b + root) if v + b > 0.0 else 0.5 * (root - v - b)
        return u / k if b + u > 0.0 else p
    u = max(np.sqrt((gain + v * v) / s.rate) - b, 0.0)  # the answer where b = v, that is with no other impulse
    for _ in range(20):  # Newton on (rate w² - v²) u = gain (w - v), convex at the root and beyond; three or four
        w = b + u
        slope = s.rate * w * w - v * v + 2.0 * s.rate * w * u - gain
        step = ((s.rate * w * w - v * v) * u - gain * (w - v)) / slope
        if not slope > 0.0 or step >= u:
            return p
        u -= step
        if abs(step) <= 1e-9 * u:  # the next would be round-off
            break
    return u / k


@inner
def _normal_impulse(s, h, eta, w):
    """Normal impulse of a spring in the step h, if it ends with the velocity w, and whether it ends the spring."""
    work = taken(s.v[2], w, s.rate)
    depth = s.depth - h * work
    if depth <= 0.0:
        return (s.stored / work if work > 0.0 else 0.0), True
    p = h * (s.force + 4.0 * power(0.5 * (s.depth + depth), eta) + power(depth, eta)) / 6.0
    if work * p > s.stored:
        return s.stored / work, True
    return p, False


@inner
def _give(springs, links, j, x, y, z, rough):
    """Add the impulse (x, y, z) of contact j to its dp and to the end velocities of all active ones that it reaches."""
    s = springs[j]
    if not rough:
        s.dp[2] += z
        s.end[2] += s.own[2, 2] * z
        for i in range(s.first, s.middle):
            springs[links[i].to].end[2] += links[i].k[2, 2] * z
        return
    s.dp[0] += x
    s.dp[1] += y
    s.dp[2] += z
    for r in range(3):
        s.end[r] += s.own[r, 0] * x + s.own[r, 1] * y + s.own[r, 2] * z
    for i in range(s.first, s.middle):
        k = links[i].k
        other = springs[links[i].to]
        for r in range(3):
            other.end[r] += k[r, 0] * x + k[r, 1] * y + k[r, 2] * z


@inner
def _wanted(s, h, eta):
    """The impulse that one contact wants in the step h, all others as they are."""
    z, ends = _normal_impulse(s, h, eta, s.end[2])
    if ends and z > 0.0:
        z = _release(s, z)
    if s.mu == 0.0:
        return 0.0, 0.0, z
    dz = z - s.dp[2]
    bx = s.end[0] - s.own[0, 0] * s.dp[0] - s.own[0, 1] * s.dp[1] + s.own[0, 2] * dz
    by = s.end[1] - s.own[1, 0] * s.dp[0] - s.own[1, 1] * s.dp[1] + s.own[1, 2] * dz
    x, y, s.slide = coulomb(s.own[0, 0], s.own[1, 1], s.own[0, 1], s.v[0], s.v[1], bx, by, s.mu * z, s.slide)
    return x, y, z


@inner
def _guess(s, h, eta):
    """Impulse of a step to begin with: acceleration, and tilt of the impulse, as in the last step; clears dp."""
    z, _ = _normal_impulse(s, h, eta, s.v[2] + h * s.rise)
    x, y = 0.0, 0.0
    if s.tilt[2] > 0.0:
        x, y = z * (s.tilt[0] / s.tilt[2]), z * (s.tilt[1] / s.tilt[2])  # the cone bounds these ratios, not z / p
    s.dp[0], s.dp[1], s.dp[2] = 0.0, 0.0, 0.0
    return x, y, z


@inner
def sweep(springs, links, active, count, h, eta, rough, most, enough):
    """Improve dp and end of a step of length h by at most so many sweeps; most = 0: guess them, to begin with.

    active[:count]: contacts that act; enough: change of a velocity that the next sweep would make, at which they stop.
    Returns what the last one changed, or by its ratio to the one before would leave [v_ref].
    """
    if most == 0:
        for i in range(count):
            s = springs[active[i]]
            for r in range(3):
                s.end[r] = s.v[r]
    before = 0.0
    left = 0.0
    for _ in range(max(most, 1)):
        change = 0.0
        for i in range(count):
            s = springs[active[i]]
            if most == 0:
                x, y, z = _guess(s, h, eta)
            else:
                x, y, z = _wanted(s, h, eta)
                x -= s.dp[0]
                y -= s.dp[1]
                z -= s.dp[2]
                slip = 0.5 * (s.own[0, 0] + s.own[1, 1]) * np.sqrt(x * x + y * y)  # alike for any choice of tangents
                change = max(change, max(s.own[2, 2] * abs(z), slip))
            _give(springs, links, active[i], x, y, z, rough)
        left = change * min(change / before, 1.0) if before > 0.0 else change
        if left <= enough:
            break
        before = change
    return left


@inner
def _swap(links, i, j):
    """Exchange two links."""
    links[i].to, links[j].to = links[j].to, links[i].to
    for r in range(3):
        for c in range(3):
            links[i].k[r, c], links[j].k[r, c] = links[j].k[r, c], links[i].k[r, c]


@inner
def regroup(springs, links, active, count, near, number):
    """Bring everything in line with a new set of active contacts; near[:number]: what was near the last one.

    Their links to active contacts come first, up to `middle`; reach = Σ |K_nn| over those bounds how fast a common
    swing of the springs can be; near: the active ones, and those that feel them. Returns the new number.
    """
    for i in range(number):
        springs[near[i]].near = 0
    for i in range(count):
        near[i] = active[i]
        springs[active[i]].near = 1
    number = count
    for i in range(count):
        s = springs[active[i]]
        s.reach = abs(s.own[2, 2])
        s.middle = s.first
        end = s.last
        while s.middle < end:
            other = springs[links[s.middle].to]
            if other.active == 1:
                s.reach += abs(links[s.middle].k[2, 2])
                s.middle += 1
                continue
            if other.near == 0:
                other.near = 1
                near[number] = links[s.middle].to
                number += 1
            end -= 1
            _swap(links, s.middle, end)
    return number


@inner
def step_length(springs, active, count, last, eta, fraction):
    """The step h with h ω <= x, ω² <= max of reach × force gradient / e² (Gershgorin on the columns of K f').

    x = fraction at first, and more when what is still going on is slow: an error of x² counts by the speed that it
    changes. last: the step before, 0 at the start, where all depths are zero: then h = depth / |v| of each alone.
    """
    fastest = 0.0
    speed = 0.0
    for i in range(count):
        s = springs[active[i]]
        v = s.v[2]
        speed = max(speed, max(v * v, 2.0 * s.own[2, 2] * s.stored))
        if last == 0.0:
            if v < 0.0:
                h = (fraction * fraction / (s.reach * eta * (-v) ** (eta - 1.0))) ** (1.0 / (1.0 + eta))
                fastest = max(fastest, 1.0 / (h * h))
            continue
        depth = s.depth + max(-v, 0.0) * last
        rate = min(s.rate, 1.0 / (SLOWEST * SLOWEST)) if v > 0.0 else 1.0
        if depth > 0.0:
            fastest = max(fastest, rate * s.reach * eta * power(depth, eta) / depth)
    if last == 0.0:
        return 1.0 / np.sqrt(fastest)
    h = 2.0 * last  # the estimate above assumes a depth of the last step's size: grow gently
    if fastest == 0.0:
        return h
    x = max(fraction, min(fraction / np.sqrt(np.sqrt(speed)), COARSEST))
    return min(h, x / np.sqrt(fastest))


@inner
def accept(springs, links, active, count, h, eta, turn):
    """Make the tried step of length h real: impulses, energies, velocities, losses.

    turn [v_ref]: approach that is none for a contact with e = 0: all that it stores is lost.
    """
    for i in range(count):
        s = springs[active[i]]
        v, w = s.v[2], s.end[2]
        work = taken(v, w, s.rate)
        left = max(s.stored - work * s.dp[2], 0.0)
        if s.rate == 0.0 and w >= -turn:
            left = 0.0
        if work > 0.0 and left <= max(1e-12 * s.stored, SPENT):  # an ended spring, within round-off
            left = 0.0
        s.loss += s.stored - left
        s.stored = left
        for r in range(3):
            s.loss -= 0.5 * (s.v[r] + s.end[r]) * s.dp[r]
            s.p[r] += s.dp[r]
            s.v[r] = s.end[r]
            s.tilt[r] = s.dp[r]
        s.depth = ((1.0 + eta) * left) ** (1.0 / (1.0 + eta))
        s.force = power(s.depth, eta)
        s.rise = (w - v) / h
        for k in range(s.middle, s.last):
            push = links[k].k
            other = springs[links[k].to]
            for r in range(3):
                other.v[r] += push[r, 0] * s.dp[0] + push[r, 1] * s.dp[1] + push[r, 2] * s.dp[2]
