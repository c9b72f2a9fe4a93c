"""Impact of one pair: Stronge's energetic restitution with Coulomb friction, exact to round-off.

Collision system: n from b to a, v the velocity of a's contact point relative to b's, J the impulse on a.
The inverse mass K couples them, dv = K dJ; the normal impulse p only grows, W is the work of its velocity.

Frictionless      J = -(1 + e) v3 / K33 n.       W(p) = v3 p + K33 p²/2: the energetic e is then Newton's.
Ball-like K       K = diag(kt, kt, kn): a ball whose mass centre is its middle turns freely, so the normal part does not
                  feel the friction: p = (1 + e)|v3| / kn; slip keeps its direction and ends when |vt| = kt μ p':
                  Jt = -min(|vt| / kt, μ p) vt / |vt|.
In general        slip runs along a curve in the plane of v1, v2 (hodograph.py) or, where it starts on an invariant ray
                  or has come to one, straight (straight.py). If it halts, friction either holds it (stick) or it starts
                  again along the one ray that leads away from rest (reversal); either is straight to the end.
                  A plane problem starts on a ray, and so does a ball: they never see the curve.

The loss follows without the energies: ΔE = ½ (v⁻ + v⁺)·J. Source: Stronge 2000, ch. 3-4; report eqs. (5)-(28).
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.hodograph import ENDED, FAR, GAVE_UP, HALTED, ON_RAY, turning_slip
from flowgmo.collision.straight import EPS, along_slip, at_rest, straight
from flowgmo.kernel import inner
from flowgmo.records import JAM, REVERSAL, SLIP, STICK
from flowgmo.vectors import add, along, dot, norm, scale

# status of an impact
RESOLVED = 0  # the work law ended it
RIGID = 1  # K33 = 0: neither side can give way along the normal; no impulse
HELD = 2  # it locks or wedges while it still approaches: a driven partner presses on a side that cannot give way
UNFINISHED = 3  # the hodograph took too many steps; what was found so far, closed as if it ran straight


@inner
def ball_impact(v, n, e, mu, kn, kt):
    """Impulse on a (triple), regime, energy lost of one impact with approach v·n < 0.

    v [length/time], n unit: triples; e, mu [-]; kn, kt [1/mass] normal and tangential inverse mass. kt is not used
    where mu = 0.
    """
    vn = dot(v, n)
    p = -(1.0 + e) * vn / kn
    vt = along(v, -vn, n)
    slip = norm(vt)
    impulse = scale(p, n)
    loss = -0.5 * (1.0 - e) * vn * p
    if mu == 0.0 or slip == 0.0:
        return impulse, SLIP, loss
    drag = slip / kt
    regime = STICK
    if drag > mu * p:
        drag = mu * p
        regime = SLIP
    # ½ (v⁻ + v⁺)·J, part by part: normal ½ (1 - e) vn p, tangential (slip - ½ kt drag) drag
    return along(impulse, -drag / slip, vt), regime, loss + (slip - 0.5 * kt * drag) * drag


@inner
def moved(k, j):
    """K J, the change of velocity (triple) by the impulse j (triple); k: entries 11 22 33 12 13 23."""
    return (
        k[0] * j[0] + k[3] * j[1] + k[4] * j[2],
        k[3] * j[0] + k[1] * j[1] + k[5] * j[2],
        k[4] * j[0] + k[5] * j[1] + k[2] * j[2],
    )


@inner
def impact(k, v, e, mu):
    """One impact in the collision system: impulse on a (triple), regime (records.REGIMES), energy lost, status.

    k [1/mass] inverse mass, entries 11 22 33 12 13 23, positive semidefinite; v [length/time] triple, index 3 normal,
    approaching where v3 < 0 (else there is no impulse); 0 <= e <= 1, mu >= 0.
    Regime: JAM if v3 fell during compression; else REVERSAL or STICK if slip halted; else SLIP.
    On return |Jt| <= μ J3, ½ (v⁻ + v⁺)·J = -loss <= 0, v3 >= 0 unless the status is another than RESOLVED. HELD: the
    impulse until it locked, or of size FAR |v|/K; what remains of the approach would take an infinite one.
    """
    none = (0.0, 0.0, 0.0)
    if not v[2] < 0.0:
        return none, SLIP, 0.0, RESOLVED
    size = max(k[0], k[1], k[2])
    if not k[2] > (16.0 * EPS) ** 2 * size:  # K33 = |a × r · n|²/J ...: the square of a length's round-off
        return none, SLIP, 0.0, RIGID
    if mu == 0.0:
        p = -(1.0 + e) * v[2] / k[2]
        return (0.0, 0.0, p), SLIP, -0.5 * (1.0 - e) * v[2] * p, RESOLVED
    speed = max(abs(v[0]), abs(v[1]), -v[2])
    scaled = (k[0] / size, k[1] / size, k[2] / size, k[3] / size, k[4] / size, k[5] / size)
    v_scaled = (v[0] / speed, v[1] / speed, v[2] / speed)
    # beyond 1e15 a halt takes less than the last digit of p
    impulse, regime, status = rough_impact(scaled, v_scaled, e * e, min(mu, 1e15))
    impulse = scale(speed / size, impulse)
    return impulse, regime, -dot(along(v, 0.5, moved(k, impulse)), impulse), status


@inner
def rough_impact(k, v, ee, mu):
    """Impulse, regime, status with friction; k and v scaled to 1, ee = e²."""
    impulse, due, end, jammed = (0.0, 0.0, 0.0), 0.0, HALTED, False
    status = RESOLVED
    s = np.hypot(v[0], v[1])
    moving = s > EPS / 16.0  # of the largest velocity: less than its round-off
    if moving:
        _, h, r = along_slip(k, v[0] / s, v[1] / s, mu)
        jammed = r < 0.0
        end = ON_RAY
        # on a ray, but for round-off of h: arms have that of places, 90 EPS for balls 10 radii from the origin
        if abs(h) > 256.0 * EPS * (mu * (k[0] + k[1]) + np.hypot(k[4], k[5])):
            v, impulse, due, end, jammed, _ = turning_slip(k, v, ee, mu)
    gave_up = end == GAVE_UP
    if end == ON_RAY or gave_up:
        v, impulse, due, end = run_ray(k, v, impulse, due, ee, mu)
    regime = SLIP
    if end == HALTED:
        f1, f2, r, sticks = at_rest(k, mu)
        if sticks:
            regime = STICK
        elif moving:
            regime = REVERSAL
        p = np.inf
        if r > 0.0:
            p, _, _, _ = straight(v[2], r, due, ee, np.inf)
        if p <= FAR:
            impulse = add(impulse, (f1 * p, f2 * p, p))
        elif v[2] < -1e-9:  # of the largest velocity: far above round-off, far below what a driven partner brings
            status = HELD
    elif end != ENDED:
        status = HELD if v[2] < 0.0 else RESOLVED
    elif moving and np.hypot(v[0], v[1]) <= 64.0 * EPS:  # locked: halt and end come together, but for round-off
        regime = STICK
    return impulse, JAM if jammed else regime, UNFINISHED if gave_up else status


@inner
def run_ray(k, v, impulse, due, ee, mu):
    """Slip in the direction of v stays on its ray: v, impulse, due after it, and how it ended (ON_RAY: it is held)."""
    s = np.hypot(v[0], v[1])
    d1, d2 = v[0] / s, v[1] / s
    g, _, r = along_slip(k, d1, d2, mu)
    limit = -s / g if g < 0.0 else np.inf
    if limit == np.inf and not r > 0.0:
        return v, impulse, due, ON_RAY
    p, v3, due, done = straight(v[2], r, due, ee, limit)
    if p > FAR:
        return v, impulse, due, ON_RAY
    impulse = add(impulse, (-mu * d1 * p, -mu * d2 * p, p))
    left = max(s + g * p, 0.0)
    return (left * d1, left * d2, v3), impulse, due, ENDED if done else HALTED
