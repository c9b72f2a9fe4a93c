"""Contacts, responses, twists of clusters that tests and the bench resolve: balls, boxes, rods, random bodies."""

import numpy as np

from flowgmo.collision.clusters import DONE, resolve
from flowgmo.collision.contact import CONTACT, RESPONSE, TWIST
from flowgmo.collision.plastic import MANY

FRACTION = 0.03


def after(scene, eta=1.5, fraction=FRACTION, status=DONE):
    """The scene's contacts and twists after its impacts; the scene itself stays."""
    contacts, responses, twists = (part.copy() for part in scene)
    got, left = resolve(contacts, responses, twists, eta, fraction)
    assert got == status
    close = 1e-11 if len(contacts) <= MANY else 1e-9
    assert left <= close * max(np.abs(velocities(*scene)).max(), 1e-300) or status != DONE
    return contacts, twists


def parties(n):
    """n parties that answer nothing and rest."""
    return np.zeros(n, RESPONSE), np.zeros(n, TWIST)


def contact(a, b, point, normal, e, mu):
    c = np.zeros(1, CONTACT)
    c["a"], c["b"], c["point"], c["normal"], c["e"], c["mu"] = a, b, point, normal, e, mu
    return c


def six(m):
    """Entries xx yy zz xy xz yz of a symmetric matrix."""
    return [m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]]


def balls(places, speeds, e=1.0, mu=0.0, mass=1.0, radius=0.5):
    """Equal balls; every pair that touches is a contact."""
    places = np.array(places, float)
    responses, twists = parties(len(places))
    responses["centre"], twists["v"] = places, speeds
    responses["wt"][:, :3], responses["wr"][:, :3] = 1 / mass, 2.5 / (mass * radius**2)
    contacts = []
    for i in range(len(places)):
        for j in range(i + 1, len(places)):
            d = places[i] - places[j]
            if np.linalg.norm(d) < 2 * radius * (1 + 1e-9):
                contacts.append(contact(i, j, (places[i] + places[j]) / 2, d / np.linalg.norm(d), e, mu))
    return np.concatenate(contacts), responses, twists


def row(n, e=1.0):
    """n touching balls in a row, the first comes with 1."""
    return balls([(k, 0, 0) for k in range(n)], [(float(k == 0), 0, 0) for k in range(n)], e)


def rack(order=range(16)):
    """Cue ball with 10 along the axis of 15 racked balls. Corner balls 11 and 15, middle of the last row 13."""
    places = [(-1.0, 0, 0)] + [(k * np.sqrt(3) / 2, i - k / 2, 0) for k in range(5) for i in range(k + 1)]
    speeds = np.zeros((16, 3))
    speeds[0, 0] = 10
    order = list(order)
    return balls(np.array(places)[order], speeds[order])


def box(e, mu=0.0, v=(0, 0, -1.0), w=(0, 0, 0), order=range(4), half=(0.5, 0.4, 0.1)):
    """A box that hits the floor (party 1) with four corners; mass 1."""
    responses, twists = parties(2)
    a, b, h = half
    responses["wt"][0, :3] = 1
    responses["wr"][0, :3] = 3 / np.array([b * b + h * h, a * a + h * h, a * a + b * b])
    twists["v"][0], twists["w"][0] = v, w
    corners = [(a, b, -h), (a, -b, -h), (-a, b, -h), (-a, -b, -h)]
    return np.concatenate([contact(0, 1, corners[k], (0, 0, 1), e, mu) for k in order]), responses, twists


def rod(angle, mu, e, v1):
    """The rod of VALIDATION B, M = L = 1; hits with its end, v = (v1, 0, -1)."""
    responses, twists = parties(2)
    responses["wt"][0, :3], responses["wr"][0, :3] = 1, 12
    twists["v"][0] = (v1, 0, -1)
    t = np.radians(angle)
    return contact(0, 1, (0.5 * np.cos(t), 0, 0.5 * np.sin(t)), (0, 0, 1), e, mu), responses, twists


def box_corner(mu):
    """The box corner of VALIDATION B, mass 1."""
    responses, twists = parties(2)
    (c, s), (d, t) = ((np.cos(np.radians(x)), np.sin(np.radians(x))) for x in (25, 35))
    turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ np.array([[d, 0, t], [0, 1, 0], [-t, 0, d]])
    edges = np.array([0.758, 2.19, 4.178])
    moments = ((edges**2).sum() - edges**2) / 12
    responses["wt"][0, :3], responses["wr"][0] = 1, six(turn @ np.diag(1 / moments) @ turn.T)
    twists["v"][0] = (30, 10, -100)
    signs = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T
    corners = signs * edges @ turn.T
    return contact(0, 1, corners[np.argmin(corners[:, 2])], (0, 0, 1), 0.846, mu), responses, twists


def domino(e=0.846, mu=0.176, speed=10.0):
    """A block (party 0) that tips about its front edge hits the next (1); both stand on the floor (2). 8 contacts."""
    a, b, c, gap = 0.758, 2.19, 4.178, 2.191
    t = np.arcsin(gap / c)
    turn = np.array([[np.cos(t), 0, np.sin(t)], [0, 1, 0], [-np.sin(t), 0, np.cos(t)]])
    moments = np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / 12
    responses, twists = parties(3)
    responses["wt"][:2, :3] = 1
    responses["wr"][0], responses["wr"][1, :3] = six(turn @ np.diag(1 / moments) @ turn.T), 1 / moments
    responses["centre"][0], responses["centre"][1] = turn @ (-a / 2, 0, c / 2), (gap + a / 2, 0, c / 2)
    twists["w"][0] = (0, speed, 0)
    twists["v"][0] = np.cross(twists["w"][0], responses["centre"][0])
    contacts = []
    for y in (-b / 2, b / 2):
        contacts.append(contact(1, 0, (gap, y, np.sqrt(c * c - gap * gap)), (1, 0, 0), e, mu))
        contacts.append(contact(0, 2, (0, y, 0), (0, 0, 1), e, mu))
        contacts += [contact(1, 2, (x, y, 0), (0, 0, 1), e, mu) for x in (gap, gap + a)]
    return np.concatenate(contacts), responses, twists


def tower(n, e, mu):
    """n cubes (parties 1 .. n) on each other and on the floor (0), four contacts a face; a ball hits a middle one."""
    responses, twists = parties(n + 2)
    responses["wt"][1:, :3], responses["wr"][1:, :3] = 1, 6
    responses["centre"][1 : n + 1, 2] = 0.5 + np.arange(n)
    contacts = [
        contact(1 + i, i, (x, y, i), (0, 0, 1), e, mu) for i in range(n) for x in (-0.5, 0.5) for y in (-0.5, 0.5)
    ]
    high = n // 2 - 0.3
    responses["centre"][-1], twists["v"][-1] = (-1, 0.1, high), (1, 0.1, -0.3)
    contacts.append(contact(n + 1, n // 2, (-0.5, 0.1, high), (-1, 0, 0), e, mu))
    return np.concatenate(contacts), responses, twists


def mirrored(contacts, responses, twists, axis):
    """The scene seen in a mirror across one axis."""
    contacts, responses, twists = contacts.copy(), responses.copy(), twists.copy()
    for part in (contacts["point"], contacts["normal"], responses["centre"], twists["v"]):
        part[:, axis] *= -1
    spin = -np.ones(3)
    spin[axis] = 1
    twists["w"] *= spin
    mixed = [k for k, pair in enumerate(((0, 1), (0, 2), (1, 2))) if axis in pair]
    for tensor in (responses["wt"], responses["wr"]):
        tensor[:, [3 + k for k in mixed]] *= -1
    return contacts, responses, twists


def plate(m, e, mu):
    """A plate that falls on the floor with m (a square) points, tilting."""
    responses, twists = parties(2)
    responses["wt"][0, :3], responses["wr"][0, :3] = 1, (12, 12, 6)
    twists["v"][0], twists["w"][0] = (0.3, 0.1, -1), (0.1, 0.2, 0)
    g = np.linspace(-0.5, 0.5, round(m**0.5))
    return np.concatenate([contact(0, 1, (x, y, -0.05), (0, 0, 1), e, mu) for x in g for y in g]), responses, twists


def pile(n, e, mu):
    """n³ balls in a touching lattice fall on the floor, with a little noise."""
    places = np.array([(i, j, k) for i in range(n) for j in range(n) for k in range(n)], float)
    noise = 0.1 * np.random.default_rng(0).normal(size=places.shape)
    contacts, responses, twists = balls(places, noise - (0, 0, 1), e, mu)
    floor = [contact(i, len(places), x - (0, 0, 0.5), (0, 0, 1), e, mu) for i, x in enumerate(places) if x[2] == 0]
    wall, rest = parties(1)
    return np.concatenate([contacts, *floor]), np.concatenate([responses, wall]), np.concatenate([twists, rest])


def random_cluster(seed, e=None, mu=None):
    """1-6 contacts between up to four bodies, free, on a point, or on an axis, and a wall; moments 10 : 1."""
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 5), rng.integers(1, 7)
    responses, twists = parties(n + 1)
    for b in range(n):
        responses["centre"][b] = rng.normal(size=3)
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        spin = rng.normal(size=3)
        bond = rng.integers(0, 6)
        if bond == 0:
            axis = turn[0]
            responses["wr"][b], twists["w"][b] = six(np.outer(axis, axis)), (axis @ spin) * axis
            continue
        responses["wr"][b] = six(turn @ np.diag(10.0 ** rng.uniform(-0.5, 0.5, 3)) @ turn.T)
        twists["w"][b] = spin
        if bond > 1:
            responses["wt"][b, :3], twists["v"][b] = 10.0 ** rng.uniform(-1, 1), rng.normal(size=3)
    contacts = []
    for _ in range(m):
        a, b = rng.choice(n + 1, 2, replace=False)
        normal = rng.normal(size=3)
        own_e = rng.choice([0.0, 1.0, rng.uniform()]) if e is None else e
        own_mu = rng.choice([0.0, rng.uniform(), 5.0]) if mu is None else mu
        contacts.append(contact(a, b, rng.normal(size=3), normal / np.linalg.norm(normal), own_e, own_mu))
    return np.concatenate(contacts), responses, twists


def velocities(contacts, responses, twists):
    """Relative velocity (m, 3) at the contacts."""

    def of(party):
        arm = contacts["point"] - responses["centre"][party]
        return twists["v"][party] + np.cross(twists["w"][party], arm)

    return of(contacts["a"]) - of(contacts["b"])


def kinetic_energy(responses, twists):
    """Of parties with full inverse tensors only."""
    total = 0.0
    for r, t in zip(responses, twists, strict=True):
        for w, u in ((r["wt"], t["v"]), (r["wr"], t["w"])):
            m = np.array([[w[0], w[3], w[4]], [w[3], w[1], w[5]], [w[4], w[5], w[2]]])
            if m.any():
                total += 0.5 * u @ np.linalg.solve(m, u)
    return total
