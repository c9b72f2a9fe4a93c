"""Impacts for tests: kernels that Python can call, random bodies, and an independent integration of dv/dp = K f."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from flowgmo.collision import impact_euler, impact_exact
from flowgmo.kernel import kernel

SLIP, STICK, REVERSAL, JAM = range(4)


def near(a, b, bound):
    """Assert |a - b| <= bound, absolutely."""
    np.testing.assert_allclose(a, b, rtol=0.0, atol=bound)


@kernel
def exact(k, v, e, mu):
    return impact_exact.impact(k, v, e, mu)


@kernel
def euler(k, v, e, mu, dpfrac):
    return impact_euler.impact(k, v, e, mu, dpfrac)


@kernel
def exact_many(k, v, e, mu, out):
    """out (n, 6): impulse, regime, loss, status of n impacts; k (n, 6), v (n, 3)."""
    for i in range(len(k)):
        six = (k[i, 0], k[i, 1], k[i, 2], k[i, 3], k[i, 4], k[i, 5])
        j, regime, loss, status = impact_exact.impact(six, (v[i, 0], v[i, 1], v[i, 2]), e[i], mu[i])
        out[i, 0], out[i, 1], out[i, 2] = j
        out[i, 3], out[i, 4], out[i, 5] = regime, loss, status


@kernel
def euler_many(k, v, e, mu, dpfrac, out):
    """As exact_many, in steps."""
    for i in range(len(k)):
        six = (k[i, 0], k[i, 1], k[i, 2], k[i, 3], k[i, 4], k[i, 5])
        j, regime, loss, status = impact_euler.impact(six, (v[i, 0], v[i, 1], v[i, 2]), e[i], mu[i], dpfrac)
        out[i, 0], out[i, 1], out[i, 2] = j
        out[i, 3], out[i, 4], out[i, 5] = regime, loss, status


def six(K):
    """Entries 11 22 33 12 13 23 of K (..., 3, 3)."""
    K = np.asarray(K, dtype=float)
    return np.stack([K[..., i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], axis=-1)


def collide(K, v, e, mu, law=exact, *more):
    """One impact with K (3, 3): velocity after it, impulse, regime, loss, status."""
    v = np.asarray(v, dtype=float)
    j, regime, loss, status = law(tuple(six(K).tolist()), tuple(v.tolist()), float(e), float(mu), *more)
    return v + K @ np.array(j), np.array(j), regime, loss, status


def collide_many(K, v, e, mu, dpfrac=None):
    """Velocities after, impulses, regimes, losses, status of n impacts; in steps where dpfrac is given."""
    out = np.empty((len(K), 6))
    if dpfrac is None:
        exact_many(six(K), v, e, mu, out)
    else:
        euler_many(six(K), v, e, mu, dpfrac, out)
    j = out[:, :3]
    return v + np.einsum("nij,nj->ni", K, j), j, out[:, 3].astype(int), out[:, 4], out[:, 5].astype(int)


def skew(r):
    """[r] with [r] x = r × x; r (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(r, dtype=float), -1, 0)
    o = np.zeros_like(x)
    return np.stack([np.stack(row, -1) for row in ((o, -z, y), (z, o, -x), (-y, x, o))], -2)


def random_frames(rng, n):
    """Rotation matrices (n, 3, 3)."""
    q = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    return q * np.sign(np.linalg.det(q))[:, None, None]


def box_corners(rng, n, bond="free", spread=0.5):
    """K (n, 3, 3) of random boxes of mass 1 hit at a corner; bond: free, point (fixed at another corner), axis (there).

    spread: standard deviation of the logarithm of the edges.
    """
    d = np.exp(spread * rng.normal(size=(n, 3)))
    R = random_frames(rng, n)
    signs = rng.choice([-1.0, 1.0], size=(n, 3))
    inertia = (np.sum(d * d, 1)[:, None] - d * d) / 12
    arm = d / 2 * signs
    if bond != "free":
        pivot = d / 2 * signs * np.where(np.arange(3) == rng.integers(3, size=(n, 1)), -1, 1)
        inertia = np.einsum("ni,ij->nij", inertia, np.eye(3)) - skew(pivot) @ skew(pivot)
        arm = arm - pivot
    else:
        inertia = np.einsum("ni,ij->nij", inertia, np.eye(3))
    X = skew(np.einsum("nij,nj->ni", R, arm))
    if bond == "axis":
        a = random_frames(rng, n)[:, :, 0]
        moment = np.einsum("ni,nij,nj->n", a, R @ inertia @ R.transpose(0, 2, 1), a)
        c = np.einsum("nij,nj->ni", X, a)
        return c[:, :, None] * c[:, None, :] / moment[:, None, None]
    return (np.eye(3) if bond == "free" else 0.0) - X @ R @ np.linalg.inv(inertia) @ R.transpose(0, 2, 1) @ X


def about_normal(angle):
    """Turn of the tangents about the normal (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rod(degrees):
    """K of a rod of mass and length 1, hit at its end, `degrees` from the plane."""
    t = np.radians(degrees)
    b2 = 3 * np.sin(t) * np.cos(t)
    return np.array([[1 + 3 * np.sin(t) ** 2, 0, -b2], [0, 4, 0], [-b2, 0, 1 + 3 * np.cos(t) ** 2]])


def reference(K, v, e, mu):
    """Independent: dv/dp by scipy (DOP853, 1e-12) between events, closed only below a slip of 1e-9 |v|.

    Returns impulse, the sequence of phases "-" v3 < 0 and "+" v3 > 0, and "stick", "reversal" or "slip".
    """
    size = np.linalg.norm(v)
    y = np.concatenate([v, np.zeros(4)])  # velocity, impulse, energy due to restitution
    mode, phases, f = "slip", "-", None
    if np.hypot(v[0], v[1]) <= 1e-9 * size:
        mode, f = at_rest_reference(K, mu)
    for _ in range(20):
        y, event = _to_next_event(K, mu, y, f, phases[-1] == "-", e * e, size)
        if event == "turn":
            y[2] = 0.0
            phases += "+" if phases[-1] == "-" else "-"
        if event == "paid" or (phases[-1] == "+" and y[6] <= 0.0):
            return y[3:6], phases, mode
        if event == "halt":
            mode, f = at_rest_reference(K, mu)
    raise AssertionError("the reference found no end")


def _to_next_event(K, mu, y, f, compressing, ee, size):
    """State at the next event and its name; f: the fixed force by normal impulse, None where the sides slip."""
    share = ee if compressing else 1.0  # not by the sign of v3: smooth beyond the event

    def rates(p, y):
        s = np.hypot(y[0], y[1])
        force = np.array([-mu * y[0] / s, -mu * y[1] / s, 1.0]) if f is None else f
        return np.concatenate([K @ force, force, [-share * y[2]]])

    def turn(p, y):
        return y[2] if compressing else -y[2]

    def paid(p, y):
        return 1.0 if compressing else -y[6]

    def halt(p, y):
        return 1e-9 * size - np.hypot(y[0], y[1]) if f is None else -1.0

    events = [turn, paid, halt]
    for event in events:
        event.terminal, event.direction = True, 1.0
    span = 1e4 * size / K[2, 2]
    found = solve_ivp(rates, (0.0, span), y, "DOP853", rtol=1e-12, atol=1e-14 * size, events=events)
    names = [event.__name__ for event, t in zip(events, found.t_events, strict=True) if len(t)]
    return found.y[:, -1].copy(), names[0]


def at_rest_reference(K, mu):
    """Stick, or the ray with h = 0, g > 0, found by a scan of all directions."""
    f = -np.linalg.solve(K[:2, :2], K[:2, 2])
    if np.hypot(*f) <= mu:
        return "stick", np.array([*f, 1.0])

    def across(phi):
        t = K[:2] @ np.array([-mu * np.cos(phi), -mu * np.sin(phi), 1.0])
        return t[1] * np.cos(phi) - t[0] * np.sin(phi)

    angles = np.linspace(0.0, 2 * np.pi, 2001) + 1e-4
    values = [across(a) for a in angles]
    for lo, hi, x, y in zip(angles[:-1], angles[1:], values[:-1], values[1:], strict=True):
        if x * y <= 0.0:
            phi = brentq(across, lo, hi, xtol=1e-15)
            d = np.array([np.cos(phi), np.sin(phi)])
            if (K[:2] @ np.array([*(-mu * d), 1.0])) @ d > 0.0:
                return "reversal", np.array([*(-mu * d), 1.0])
    raise AssertionError("no ray leads away from rest")
