"""The collision system n1, n2, n3: the space axes turned by the shortest way that brings z to the contact's normal.

    n3 = n = (cosβ sinθ, sinβ sinθ, cosθ)
    n1 = (sin²β + cos²β cosθ, -sinβ cosβ (1 - cosθ), -cosβ sinθ)
    n2 = (-sinβ cosβ (1 - cosθ), cos²β + sin²β cosθ, -sinβ sinθ)

In components of n, k = (1 - cosθ)/sin²θ = 1/(1 + nz): n1 = (1 - k nx², -k nx ny, -nx), n2 = (-k nx ny, 1 - k ny², -ny).
At n = z these are x, y. Where n points down (nz < 0, next to -z every turn is as short) we take the mirror image of the
system of (nx, ny, -nz), n1 reversed so that it stays right-handed: n1 = (k nx² - 1, k nx ny, -nx), n2 = (-k nx ny,
1 - k ny², ny), k = 1/(1 - nz). A scene mirrored across x, y or z then has mirrored tangents, but for their signs, and
the mirrored result to the last bit.

Where n lies in the plane x z or y z, one of the two is the axis across that plane, to the last bit: a problem in that
plane stays in it. For a plane x y the formula gives two tangents askew to it; there we take n1 = -z, n2 = z × n,
which is the formula's own choice at n = x. The physics does not depend on the choice of tangents.

Source: report 2.4, eqs. (33), (35), (37) with the errata.
"""

from __future__ import annotations

from flowgmo.collision.contact import symmetric_times
from flowgmo.kernel import inner
from flowgmo.vectors import dot


@inner
def tangents(n):
    """Two unit triples n1, n2 such that n1, n2, n (unit) is a right-handed orthogonal system."""
    x, y, z = n
    if z == 0.0 and x != 0.0 and y != 0.0:
        return (0.0, 0.0, -1.0), (-y, x, 0.0)
    if z >= 0.0:
        k = 1.0 / (1.0 + z)
        return (1.0 - k * x * x, -k * x * y, -x), (-k * x * y, 1.0 - k * y * y, -y)
    k = 1.0 / (1.0 - z)
    return (k * x * x - 1.0, k * x * y, -x), (-k * x * y, 1.0 - k * y * y, y)


@inner
def components(n1, n2, n3, x):
    """Components along the orthogonal unit triples n1, n2, n3 of a vector x given in their axes."""
    return (dot(n1, x), dot(n2, x), dot(n3, x))


@inner
def assembled(n1, n2, n3, y):
    """The vector whose components along n1, n2, n3 are y: inverse of `components`."""
    return (
        y[0] * n1[0] + y[1] * n2[0] + y[2] * n3[0],
        y[0] * n1[1] + y[1] * n2[1] + y[2] * n3[1],
        y[0] * n1[2] + y[1] * n2[2] + y[2] * n3[2],
    )


@inner
def tensor_components(n1, n2, n3, s):
    """Entries 11 22 33 12 13 23 along n1, n2, n3 of a symmetric tensor s: entries xx yy zz xy xz yz in their axes.

    Any three triples will do: entry ij is n_i · s n_j.
    """
    t1, t2, t3 = symmetric_times(s, n1), symmetric_times(s, n2), symmetric_times(s, n3)
    return (dot(n1, t1), dot(n2, t2), dot(n3, t3), dot(n1, t2), dot(n1, t3), dot(n2, t3))


@inner
def tensor_assembled(n1, n2, n3, s):
    """Inverse of `tensor_components`: the rows of the turn back are the columns of n1, n2, n3."""
    x, y, z = (n1[0], n2[0], n3[0]), (n1[1], n2[1], n3[1]), (n1[2], n2[2], n3[2])
    return tensor_components(x, y, z, s)
