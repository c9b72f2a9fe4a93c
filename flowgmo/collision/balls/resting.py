"""A ball on a flat: resting, sliding, rolling in closed form, and the end of a bounce series.

On a plane with normal n under constant acceleration g the ball is pressed by N = -m g·n > 0. With slip s of the
contact point (s = v + ω × (-R n), tangential) and kt = 1/m + R²/J:

    sliding   f = -μ N s/|s|                ds/dt = g_t + kt f
    rolling   f = -g_t / kt, |f| <= μ N     s = 0:   a = (5/7) g sin θ for a solid sphere, holds iff μ >= (2/7) tan θ
    both      a = g_t + f / m               α = R (f × n) / J        (from (-R n) × f / J)

f is constant unless the ball slides across the slope; then the leg is cut so that s turns little, and f is its mean
over the leg: velocities are of fourth order in the cut, places of second.

Bounce series. A ball thrown up at v from a flat under a = -g·n flies 2 v/a, comes back at v, leaves at e v, …: the
whole series ends after T = (2 v / a) / (1 - e), with slip and spin changed by each impact like ball_impact says. What
happens along the plane is summed bounce by bounce (37 / (1 - e) terms reach round-off); T itself is the closed form.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.impact_exact import ball_impact
from flowgmo.kernel import inner
from flowgmo.vectors import add, along, cross, dot, norm, scale, sub, turned, without

ROLLING_SLIP = 1e-12  # slip below this part of the speeds it is the difference of counts as none: round-off of v, ω
TURN = 0.01  # rad by which the slip may turn in one leg
MAX_BOUNCES = 20_000_000  # terms of a series: e up to 1 - 2e-6


@inner
def plane_leg(v, w, n, g, mu, radius, mass, inertia, most):
    """Constant accelerations of a ball pressed on a plane, g·n < 0.

    v, w, n (unit), g (acceleration without the plane): triples, space axes; inertia about any axis through the middle;
    most [time] bounds how long they are taken to hold.
    Returns acceleration, angular acceleration, force of the plane on the ball, how long they hold [time], whether it
    slides, and whether rolling is what comes next.
    """
    gn = dot(g, n)
    press = -mass * gn
    kt = 1.0 / mass + radius * radius / inertia
    gt = along(g, -gn, n)
    f = (0.0, 0.0, 0.0)
    lasts = np.inf
    slides = False
    rolls_next = False
    if mu > 0.0:
        slip = slip_velocity(v, w, n, radius)
        speed = norm(slip)
        if speed <= ROLLING_SLIP * (norm(v) + radius * norm(w)):
            f = scale(-1.0 / kt, gt)
            most = mu * press
            if norm(f) > most:
                f = scale(-most / norm(gt), gt)
                slides = True
        else:
            slides = True
            f = scale(-mu * press / speed, slip)
            ds = along(gt, kt, f)
            closing = -dot(ds, slip) / speed
            across = norm(along(ds, closing / speed, slip))
            if across > 1e-14 * norm(ds):  # slides across the slope
                lasts = TURN * speed / across
                lasts = min(lasts, most)
                f = _mean_friction(slip, gt, mu * press, kt, lasts)
            elif closing > 0.0:
                lasts = speed / closing
                rolls_next = True
    force = along(f, press, n)
    return along(gt, 1.0 / mass, f), scale(radius / inertia, cross(f, n)), force, lasts, slides, rolls_next


@inner
def _mean_friction(slip, gt, most, kt, h):
    """Mean over h of f = -most s/|s| along ds/dt = g_t + kt f, so that the slip at h is right (Runge-Kutta)."""
    f1 = scale(-most / norm(slip), slip)
    s2 = along(slip, 0.5 * h, along(gt, kt, f1))
    f2 = scale(-most / norm(s2), s2)
    s3 = along(slip, 0.5 * h, along(gt, kt, f2))
    f3 = scale(-most / norm(s3), s3)
    s4 = along(slip, h, along(gt, kt, f3))
    f4 = scale(-most / norm(s4), s4)
    return scale(1.0 / 6.0, add(add(f1, scale(2.0, f2)), add(scale(2.0, f3), f4)))


@inner
def slip_velocity(v, w, n, radius):
    """Velocity along the plane of the ball's lowest point, triple."""
    return sub(without(v, n), scale(radius, cross(w, n)))


@inner
def friction_loss(v, w, n, acc, alp, force, radius, dt):
    """Energy lost to sliding in dt of one leg: -∫ f·s with s linear in time. All triples but radius, dt."""
    slip = slip_velocity(v, w, n, radius)
    ds = slip_velocity(acc, alp, n, radius)
    f = without(force, n)
    return -(dot(f, slip) * dt + 0.5 * dot(f, ds) * dt * dt)


@inner
def rolling_spin(v, w, n, radius):
    """w with the part along the plane that rolling without slip asks for; the spin about n stays."""
    return along(scale(1.0 / radius, cross(n, v)), dot(w, n), n)


@inner
def series_time(vn, an, e):
    """Duration [time] of all flights of a series that starts upwards at vn under an < 0."""
    return 2.0 * vn / (-an) / (1.0 - e)


@inner
def series_state(p, q, v, w, n, g, e, mu, radius, inverse_mass, inverse_inertia, dt):
    """Pose and velocity dt after the start of a series with v·n > 0; p, q, v, w, n, g are tuples.

    Returns p, q, v, w, the impulse so far, the energy lost, and the number of bounces.
    """
    gn = dot(g, n)
    gt = along(g, -gn, n)
    kt = inverse_mass + radius * radius * inverse_inertia
    left = dt
    up = dot(v, n)
    least = 1e-17 * up  # a bounce below round-off of the first
    vt = along(v, -up, n)
    total = (0.0, 0.0, 0.0)
    lost = 0.0
    bounces = 0
    while bounces < MAX_BOUNCES:
        hop = 2.0 * up / -gn
        if hop >= left or up <= least:
            break
        p = along(along(p, hop, vt), 0.5 * hop * hop, gt)
        q = turned(q, scale(hop, w))
        vt = along(vt, hop, gt)
        contact = sub(along(vt, -up, n), scale(radius, cross(w, n)))
        impulse, _, loss = ball_impact(contact, n, e, mu, inverse_mass, kt)
        vt = along(vt, inverse_mass, without(impulse, n))
        w = along(w, -radius * inverse_inertia, cross(n, impulse))
        total = add(total, impulse)
        lost += loss
        bounces += 1
        up = e * up
        left -= hop
    p = along(along(p, left, vt), 0.5 * left * left, gt)
    q = turned(q, scale(left, w))
    v = along(vt, left, gt)
    if up > least:
        p = along(p, max((up + 0.5 * gn * left) * left, 0.0), n)
        v = along(v, max(up + gn * left, -up), n)
    return p, q, v, w, total, lost, bounces
