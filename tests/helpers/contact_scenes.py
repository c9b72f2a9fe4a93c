"""Scenes of touching bodies as arrays of the contact solver: contacts, biases, responses, free twists.

Party 0 is a floor at rest unless a scene moves it; gravity times the step is .01 downwards.
"""

import numpy as np

from flowgmo.collision.contact import CONTACT, RESPONSE, TWIST

FALL = 0.01  # g h
STEEP = 0.35  # rad from upright


def tensor(s):
    """Matrix (3, 3) of six entries."""
    return np.array([[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]])


def six(m):
    return [m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]]


def party(centre, mass=0.0, inertia=None):
    """A free body with the inertia (3, 3) or (3,), or without mass one that answers nothing."""
    r = np.zeros((), RESPONSE)
    r["centre"] = centre
    if mass > 0:
        r["wt"][:3] = 1 / mass
        r["wr"] = six(np.linalg.inv(inertia if np.ndim(inertia) == 2 else np.diag(inertia)))
    return r


def box(centre, size, mass=1.0, turn=None):
    a, b, c = size
    inertia = mass / 12 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    return party(centre, mass, inertia if turn is None else turn @ inertia @ turn.T)


def contact(a, b, x, n=(0, 0, 1), mu=0.5):
    c = np.zeros((), CONTACT)
    c["a"], c["b"], c["point"], c["normal"], c["mu"] = a, b, x, n, mu
    return c


def scene(parties, contacts, fall=(0, 0, -FALL)):
    responses, twists = np.array(parties, RESPONSE), np.zeros(len(parties), TWIST)
    twists["v"][responses["wt"][:, 0] > 0] = fall
    return np.array(contacts, CONTACT), np.zeros((len(contacts), 3)), responses, twists


def stack(masses, mu=0.5):
    """Unit cubes on each other."""
    parties, contacts = [party((0, 0, 0))], []
    for k, mass in enumerate(masses):
        parties.append(box((0, 0, k + 0.5), (1, 1, 1), mass))
        contacts += [contact(k + 1, k, (x, y, k), mu=mu) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    return scene(parties, contacts)


def pyramid(rows, mu=0.5):
    """Boxes .96 wide, each on two; symmetric about x = 0."""
    parties, contacts, number = [party((0, 0, 0))], [], {}
    for k in range(rows):
        for j in range(rows - k):
            x = j + 0.5 * k - 0.5 * (rows - 1)
            number[k, j] = len(parties)
            parties.append(box((x, 0, k + 0.5), (0.96, 1, 1)))
            under = [(0, x - 0.48, x + 0.48)]
            if k > 0:
                under = [(number[k - 1, j], x - 0.48, x - 0.02), (number[k - 1, j + 1], x + 0.02, x + 0.48)]
            for b, lo, hi in under:
                contacts += [contact(number[k, j], b, (p, y, k), mu=mu) for p in (lo, hi) for y in (-0.5, 0.5)]
    return scene(parties, contacts)


def leaning_plates(mu=0.8, angle=STEEP):
    """Two plates of length 1 that lean on each other at the angle from upright: they stand iff mu >= tan(angle)/2."""
    parties, contacts = [party((0, 0, 0))], []
    c, s = np.cos(angle), np.sin(angle)
    for side in (-1, 1):
        turn = np.array([[c, 0, -side * s], [0, 1, 0], [side * s, 0, c]])
        parties.append(box((side * s / 2, 0, c / 2), (0.02, 1, 1), turn=turn))
    for side, number in ((-1, 1), (1, 2)):
        contacts += [contact(number, 0, (side * s, y, 0), mu=mu) for y in (-0.5, 0.5)]
    contacts += [contact(2, 1, (0, y, c), (1, 0, 0), mu) for y in (-0.5, 0.5)]
    return scene(parties, contacts)


def wedge(mu=0.2, angle=1.4):
    """A box between two walls of the floor, each inclined by the angle: it hangs iff mu >= 1/tan(angle)."""
    s, c = np.sin(angle), np.cos(angle)
    contacts = [
        contact(1, 0, (k / 2, y, z), (-k * s, 0, c), mu) for k in (-1, 1) for y in (-0.5, 0.5) for z in (0.5, 1.5)
    ]
    return scene([party((0, 0, 0)), box((0, 0, 1), (1, 1, 1))], contacts)


def belt(mu=0.3):
    s = stack([1.0], mu)
    s[3]["v"][0] = (1.0, 0.2, 0.0)
    return s


def arch(n=9, mu=0.6):
    """Stones between the radii 1 and 1.3 of a half circle."""
    parties, contacts, w = [party((0, 0, 0))], [], np.pi / n
    for k in range(n):
        a = w * (k + 0.5)
        parties.append(box((1.14 * np.cos(a), 0, 1.14 * np.sin(a)), (0.3, 0.5, 1.15 * w), mass=w))
    for k in range(n + 1):
        c, s = np.cos(w * k), np.sin(w * k)
        a, b = (k + 1, k) if k < n else (0, n)
        contacts += [contact(a, b, (r * c, y, r * s), (-s, 0, c), mu) for r in (1, 1.3) for y in (-0.25, 0.25)]
    return scene(parties, contacts)


def crusher(speed=1.0):
    """A driven plate presses a cube onto the floor."""
    s = stack([1.0])
    lid = [contact(2, 1, (x, y, 1)) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    contacts, bias, responses, twists = scene([*s[2], party((0, 0, 1))], [*s[0], *lid])
    twists["v"][2] = (0.3 * speed, 0, -speed)
    return contacts, bias, responses, twists


def random_pile(rng, n, m, mu, stirred=0.0, ratio=100.0):
    """n free bodies above each other, masses within ratio of 1, m contacts anywhere, no two of them face each other."""
    parties, contacts = [party((0, 0, 0))], []
    for k in range(n):
        shape, mass = rng.normal(size=(3, 3)), ratio ** rng.uniform(-1, 1)
        inertia = mass * (0.1 * shape @ shape.T + 0.05 * np.eye(3))
        parties.append(party((rng.normal(), rng.normal(), k + 1), mass, inertia))
    for _ in range(m):
        a = rng.integers(1, n + 1)
        b = rng.integers(0, a)
        normal = rng.normal(size=3)
        normal[2] = abs(normal[2]) + 0.3
        x = (parties[a]["centre"] + parties[b]["centre"]) / 2 + 0.4 * rng.normal(size=3)
        contacts.append(contact(a, b, x, normal / np.linalg.norm(normal), rng.uniform(0, mu)))
    s = scene(parties, contacts)
    s[3]["v"][1:] += stirred * rng.normal(size=(n, 3))
    s[3]["w"][1:] += stirred * rng.normal(size=(n, 3))
    return s


def energy(responses, twists):
    """Kinetic energy of all parties, directions that answer nothing left out."""
    total = 0.0
    for r, t in zip(responses, twists, strict=True):
        for w, v in ((r["wt"], t["v"]), (r["wr"], t["w"])):
            total += 0.5 * v @ np.linalg.pinv(tensor(w), rcond=1e-9, hermitian=True) @ v
    return total


def contact_velocities(contacts, responses, twists):
    """Relative velocities (m, 3)."""

    def at(party, x):
        return twists["v"][party] + np.cross(twists["w"][party], x - responses["centre"][party])

    x = contacts["point"]
    return at(contacts["a"], x) - at(contacts["b"], x)


def law_violation(contacts, bias, responses, twists):
    """Largest violations: approach [length/time], pull, cone [impulse], p_n u_n, u_t against p_t [energy]."""
    u = contact_velocities(contacts, responses, twists)
    n, p = contacts["normal"], contacts["impulse"]
    u = u + bias
    un, pn = np.sum(u * n, axis=1), np.sum(p * n, axis=1)
    ut, pt = u - np.sum(u * n, axis=1)[:, None] * n, p - pn[:, None] * n
    slip, grip = np.linalg.norm(ut, axis=1), np.linalg.norm(pt, axis=1)
    dissipation = np.abs(np.sum(ut * pt, axis=1) + contacts["mu"] * pn * slip)
    return -un.min(), -pn.min(), (grip - contacts["mu"] * pn).max(), np.abs(un * pn).max(), dissipation.max()
