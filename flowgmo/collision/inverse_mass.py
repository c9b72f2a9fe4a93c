"""How a body answers an impulse: its RESPONSE from its mass, its bonds, and its pose; the inverse mass K of a contact.

An impulse J at x changes v_c by W_t J and ω by W_r ((x - c) × J) (table in contact.py), so the point x answers with

    dv = W_t J + (W_r (r × J)) × r,   r = x - c
    K_ij = n_i · W_t n_j + (r × n_i) · W_r (r × n_j)      summed over the two parties

The second form is symmetric and positive by its shape. On a fixed axis a it is rank one, (a×r)(a×r)ᵀ/J_a: along any
direction, as eqs. (12)-(14) are along the axes. Some components driven: translations are driven along space axes,
rotations about body axes (bodies/equations.py); what is driven does not answer, and the free rotations answer with the
inverse of their block of I, because the bonds' own impulses turn the body about the driven axes only.

Source: report eqs. (8)-(14) with the errata.
"""

from __future__ import annotations

from flowgmo.bodies.arrays import DRIVEN, STILL
from flowgmo.bodies.equations import inertia_about
from flowgmo.collision.frame import tensor_components
from flowgmo.kernel import inner
from flowgmo.vectors import add, cross, dot, put, quad, scale, sub, triple, unrotate


@inner
def respond(body, row, response):
    """Fill a RESPONSE from a body of dtype BODY at its POSE row."""
    for k in range(6):
        response.wt[k] = 0.0
        response.wr[k] = 0.0
    put(response.centre, body.point if body.hinge != 0 else row.p)
    if body.motion == STILL or body.motion == DRIVEN:
        return
    if body.hinge == 1:
        a = triple(body.axis)
        j = 1.0 / body.hinge_moment
        put(response.wr[:3], (j * a[0] * a[0], j * a[1] * a[1], j * a[2] * a[2]))
        put(response.wr[3:], (j * a[0] * a[1], j * a[0] * a[2], j * a[1] * a[2]))
        return
    if body.hinge == 0:
        for k in range(3):
            response.wt[k] = 1.0 / body.mass if body.coupled[k] != 0 else 0.0
    if body.coupled[3] == 0 and body.coupled[4] == 0 and body.coupled[5] == 0:
        return  # it may have no inertia
    q = quad(row.q)
    x, y, z = unrotate(q, (1.0, 0.0, 0.0)), unrotate(q, (0.0, 1.0, 0.0)), unrotate(q, (0.0, 0.0, 1.0))
    wr = tensor_components(x, y, z, free_inverse(inertia_about(body), body.coupled))
    for k in range(6):
        response.wr[k] = wr[k]


@inner
def free_inverse(i, coupled):
    """Inverse of the block of the free rotations of a symmetric tensor, zero elsewhere; entries xx yy zz xy xz yz.

    coupled (6,): nonzero where a component is free, rotations in places 3 to 5. By cofactors of the tensor whose
    other rows and columns are those of the unit tensor.
    """
    f0, f1, f2 = coupled[3] != 0, coupled[4] != 0, coupled[5] != 0
    a, b, c = (i[0] if f0 else 1.0), (i[1] if f1 else 1.0), (i[2] if f2 else 1.0)
    d = i[3] if f0 and f1 else 0.0
    e = i[4] if f0 and f2 else 0.0
    f = i[5] if f1 and f2 else 0.0
    m00, m01, m02 = b * c - f * f, e * f - d * c, d * f - b * e
    s = 1.0 / (a * m00 + d * m01 + e * m02)
    return (
        s * m00 if f0 else 0.0,
        s * (a * c - e * e) if f1 else 0.0,
        s * (a * b - d * d) if f2 else 0.0,
        s * m01,
        s * m02,
        s * (d * e - a * f),
    )


@inner
def twist_of(body, row, response, twist):
    """Fill a TWIST, motion about the response's centre, from the POSE row: v of B, ω in space axes."""
    w = triple(row.w)
    put(twist.w, w)
    if body.hinge != 0:
        put(twist.v, (0.0, 0.0, 0.0))
        return
    put(twist.v, add(triple(row.v), cross(w, sub(triple(response.centre), triple(row.p)))))


@inner
def set_velocities(body, row, response, twist):
    """Write v of B and ω of the POSE row from a TWIST: inverse of twist_of. A body that does not answer keeps its own.

    About a fixed axis ω is put back on the axis, about a fixed point v of B is ω × arm: the bonds hold to the last bit.
    """
    if body.motion == STILL or body.motion == DRIVEN:
        return
    w = triple(twist.w)
    v = triple(twist.v)
    if body.hinge == 1:
        w = scale(dot(w, body.axis), triple(body.axis))
    if body.hinge != 0:
        v = (0.0, 0.0, 0.0)
    put(row.w, w)
    put(row.v, add(v, cross(w, sub(triple(row.p), triple(response.centre)))))


@inner
def contact_matrix(response_a, response_b, point, n1, n2, n3):
    """K [1/mass], entries 11 22 33 12 13 23 in the collision system: relative velocity at `point` by impulse on a."""
    a = _mobility(response_a, point, n1, n2, n3)
    b = _mobility(response_b, point, n1, n2, n3)
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@inner
def _mobility(response, point, n1, n2, n3):
    """One party's part of K."""
    r = sub(point, triple(response.centre))
    t = tensor_components(n1, n2, n3, response.wt)
    m = tensor_components(cross(r, n1), cross(r, n2), cross(r, n3), response.wr)
    return (t[0] + m[0], t[1] + m[1], t[2] + m[2], t[3] + m[3], t[4] + m[4], t[5] + m[5])
