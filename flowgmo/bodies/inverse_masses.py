"""Inverse masses of bodies as matrices (6, 6): what an impulse and its moment about B change, zero where it cannot."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import HINGED
from flowgmo.bodies.energy import rotation_matrices


def inverse_masses(bodies: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """(b, 6, 6): changes of velocity of B and spin (space axes) by an impulse and its moment about B; zero for what is
    prescribed, or held at a stop."""
    out = np.zeros((len(bodies), 6, 6))
    R = rotation_matrices(rows["q"])
    turns = (bodies["motion"] != HINGED) & (bodies["hinge"] != 2) & bodies["coupled"][:, 3:].astype(bool).all(axis=1)
    some = np.flatnonzero(turns)  # those that turn freely, all at once
    moves = bodies["coupled"][some, :3].astype(bool) & (rows["hold"][some, :3] == 0)
    out[some[:, None], np.arange(3), np.arange(3)] = moves / bodies["mass"][some, None]
    spins = np.zeros((len(bodies), 3, 3))
    spins[some] = np.linalg.inv(bodies["inertia"][some])
    out[:, 3:, 3:] = R @ spins @ R.swapaxes(1, 2)
    others = np.flatnonzero(~turns)
    for n, body, row, turn in zip(others, bodies[others], rows[others], R[others], strict=True):
        M = out[n]
        arm = turn @ body["arm"]
        if body["motion"] == HINGED:
            if not row["hold"][3]:
                g = np.concatenate([np.cross(body["axis"], arm), body["axis"]])
                M[...] = np.outer(g, g) / body["hinge_moment"]
            continue
        free = body["coupled"].astype(bool) & ~np.concatenate([row["hold"][:3] != 0, np.zeros(3, bool)])
        inertia = body["inertia"]
        if body["hinge"] == 2:
            a = body["arm"]
            inertia = inertia + body["mass"] * (a @ a * np.eye(3) - np.outer(a, a))
        spin = np.zeros((3, 3))
        F = np.flatnonzero(free[3:])
        if len(F):
            spin[np.ix_(F, F)] = np.linalg.inv(inertia[np.ix_(F, F)])
        spin = turn @ spin @ turn.T
        if body["hinge"] == 2:
            G = np.vstack([_times(arm), np.eye(3)])  # v = w x arm = - arm x w
            M[...] = G @ spin @ G.T
        else:
            M[:3, :3] = np.diag(free[:3] / body["mass"])
            M[3:, 3:] = spin
    return out


def _times(arm: np.ndarray) -> np.ndarray:
    """The matrix of w -> w x arm."""
    x, y, z = arm
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def block_diagonal(blocks: np.ndarray) -> np.ndarray:
    """(6 n, 6 n) of blocks (n, 6, 6)."""
    n = len(blocks)
    out = np.zeros((n, 6, n, 6))
    out[np.arange(n), :, np.arange(n)] = blocks
    return out.reshape(6 * n, 6 * n)


def turned(q: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """q (4,) turned by the rotation vector angle (3,) in space axes."""
    size = float(np.linalg.norm(angle))
    s = 0.5 * np.sinc(0.5 * size / np.pi)  # sin(size / 2) / size
    a, (b, c, d) = np.cos(0.5 * size), s * angle
    w, x, y, z = q
    new = np.array([
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ])  # fmt: skip
    return new / np.linalg.norm(new)
