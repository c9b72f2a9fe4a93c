"""Kinetic and potential energy of bodies (dtype BODY), from rows of their states."""

from __future__ import annotations

import numpy as np


def rotation_matrices(q: np.ndarray) -> np.ndarray:
    """R_WB (..., 3, 3) of quaternions (..., 4) w x y z."""
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    rows = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    return rows.transpose(*range(2, rows.ndim), 0, 1)


def kinetic_energy(arrays: np.ndarray, q: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """½ m v² + ½ w·I w of every body (k, n) [energy] from rows q (k, n, 4), v, w (k, n, 3); ½ J θ'² on a fixed axis."""
    w_B = np.einsum("knij,kni->knj", rotation_matrices(q), w)
    turning = np.einsum("kni,nij,knj->kn", w_B, arrays["inertia"], w_B)
    moving = arrays["mass"] * np.einsum("kni,kni->kn", v, v)
    hinged = arrays["hinge_moment"] * np.einsum("kni,kni->kn", w, w)
    return 0.5 * np.where(arrays["hinge"] == 1, hinged, moving + turning)


def potential_energy(arrays: np.ndarray, p: np.ndarray) -> np.ndarray:
    """-m g·(p - p(0)) of every body (k, n) [energy]: zero at the start, p (k, n, 3)."""
    return -arrays["mass"] * np.einsum("kni,ni->kn", p - arrays["origin"], arrays["gravity"])
