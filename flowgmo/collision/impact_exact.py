"""Impact of one pair in closed form: what stays of Stronge's theory where it can be solved by hand.

Collision system: n from b to a, v the velocity of a's contact point relative to b's, J the impulse on a.
The inverse mass K couples them, dv = K dJ.

Frictionless      J = -(1 + e) v3 / K33 n.       W(p) = v3 p + K33 p²/2: the energetic e is then Newton's.
Ball-like K       K = diag(kt, kt, kn): a ball whose mass centre is its middle turns freely, so the normal part does not
                  feel the friction: p = (1 + e)|v3| / kn; slip keeps its direction and ends when |vt| = kt μ p':
                  Jt = -min(|vt| / kt, μ p) vt / |vt|.

The work law's loss follows without the energies: ΔE = ½ (v⁻ + v⁺)·J. Source: Stronge 2000, ch. 3; report eqs. (5)-(8).
"""

from __future__ import annotations

from flowgmo.kernel import inner
from flowgmo.records import SLIP, STICK
from flowgmo.vectors import along, dot, norm, scale


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
