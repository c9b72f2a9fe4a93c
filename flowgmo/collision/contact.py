"""What every part of the collision model shares: how a party answers an impulse, one contact, and the numbers of both.

Parties are numbered as in Model.contacts: bodies 0 .. n-1, domain sides n .. n+5. Every party has a centre c, about
which turning and translation do not mix, a twist (velocity of c, angular velocity), and a response:

    an impulse J at the point x changes   v_c by W_t J   and   ω by W_r ((x - c) × J)

| party                    | c                   | W_t            | W_r                                          |
|--------------------------|---------------------|----------------|----------------------------------------------|
| free, six degrees        | mass centre         | 1/m            | I⁻¹                                          |
| on a fixed point         | the point           | 0              | inverse of the inertia about the point       |
| on a fixed axis a        | a point of the axis | 0              | a aᵀ / J_a                                   |
| some components driven   | mass centre         | 1/m where free | inverse of the free-free block, zero elsewhere|
| driven, at rest, a wall  | any                 | 0              | 0                                            |

Source: report eqs. (7)-(14) with the errata.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner
from flowgmo.vectors import add, cross, dot, sub, triple

#: One party's answer to impulses in space axes; wt [1/mass], wr [1/(mass length²)]: entries xx yy zz xy xz yz.
RESPONSE = np.dtype([("centre", "f8", 3), ("wt", "f8", 6), ("wr", "f8", 6)], align=True)
#: One party's motion: velocity of RESPONSE.centre [length/time] and angular velocity [rad/time], space axes.
TWIST = np.dtype([("v", "f8", 3), ("w", "f8", 3)], align=True)
#: One contact point. a, b: parties; normal: unit, from b to a; gap [length] along it, negative where they overlap;
#: impulse on a, space axes, of contacts that wait for their next leg the force; regime: records.REGIMES; loss: energy;
#: feature: which parts of the two surfaces touch, the same number as long as the same parts do; age [time] since it
#: closed; fresh: 1 until its impact is resolved.
CONTACT = np.dtype(
    [
        ("a", "i8"),
        ("b", "i8"),
        ("point", "f8", 3),
        ("normal", "f8", 3),
        ("gap", "f8"),
        ("e", "f8"),
        ("mu", "f8"),
        ("impulse", "f8", 3),
        ("regime", "i8"),
        ("loss", "f8"),
        ("feature", "i8"),
        ("age", "f8"),
        ("fresh", "i8"),
    ],
    align=True,
)


@inner
def symmetric_times(s, x):
    """Symmetric tensor (six entries xx yy zz xy xz yz) times triple."""
    return (
        s[0] * x[0] + s[3] * x[1] + s[4] * x[2],
        s[3] * x[0] + s[1] * x[1] + s[5] * x[2],
        s[4] * x[0] + s[5] * x[1] + s[2] * x[2],
    )


@inner
def point_velocity(response, twist, x):
    """Velocity (triple) of the material point of a party at x (triple)."""
    return add(triple(twist.v), cross(triple(twist.w), sub(x, triple(response.centre))))


@inner
def relative_velocity(contact, responses, twists):
    """Velocity (triple) of a's contact point relative to b's."""
    x = triple(contact.point)
    one = point_velocity(responses[contact.a], twists[contact.a], x)
    return sub(one, point_velocity(responses[contact.b], twists[contact.b], x))


@inner
def push(response, twist, x, impulse):
    """Change a party's twist by an impulse (triple) at the point x (triple)."""
    dv = symmetric_times(response.wt, impulse)
    dw = symmetric_times(response.wr, cross(sub(x, triple(response.centre)), impulse))
    for k in range(3):
        twist.v[k] += dv[k]
        twist.w[k] += dw[k]


@inner
def answer(response, x, y, impulse):
    """Change of velocity (triple) at the point x of a party by an impulse (triple) at its point y."""
    c = triple(response.centre)
    dv = symmetric_times(response.wt, impulse)
    dw = symmetric_times(response.wr, cross(sub(y, c), impulse))
    return add(dv, cross(dw, sub(x, c)))


@inner
def approach(contact, responses, twists):
    """Normal relative velocity of a contact, negative where its sides approach."""
    return dot(relative_velocity(contact, responses, twists), contact.normal)
