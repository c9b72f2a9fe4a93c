"""Overlaps removed with the least motion.

Find displacements d of all movable parties (translation of the centre, small rotation) with

    min ½ dᵀ M d     so that     n·(δ_a - δ_b) >= depth     at every contact

δ = translation + rotation × (x - c) at the contact, M the masses: light parties give way to heavy ones, immovable ones
stay. A contact with depth zero takes part: what separates one pair must not push another together. The conditions of
the minimum (Karush, Kuhn, Tucker)

    M d = sum Jᵀ λ      0 <= λ ⟂ n·(δ_a - δ_b) - depth >= 0

are those of persistent contacts without friction, at rest, and with the bias -depth: the same solver does both.
The result is a displacement, no velocity: nothing of it enters kinetic energy. It is exact for translations, of first
order in rotations; the caller measures gaps again.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.persistent import solve


def separate(
    contacts: np.ndarray, depths: np.ndarray, responses: np.ndarray, shifts: np.ndarray, tolerance: float, most: int
) -> tuple[int, float, int]:
    """Displacements that remove overlaps.

    contacts (m,) CONTACT: read only; depths (m,) [length] > 0 to remove, 0 not to
    approach; responses (n,) RESPONSE; shifts (n,) TWIST: on return v the translation of each centre [length], w the
    rotation [rad] in space axes, zero for immovable parties; most: bounds the sweeps of each group.
    Returns sweeps and Newton steps, residual relative to the largest depth of its group, status as solve does;
    where parties that cannot move leave no room (a crusher): IMPOSSIBLE, the overlap that stays is shared.
    No kernel: one around `solve` would compile all of it once more.
    """
    rows = contacts.copy()
    rows["mu"] = 0.0
    rows["impulse"] = 0.0
    shifts["v"] = 0.0
    shifts["w"] = 0.0
    return solve(rows, -depths[:, None] * rows["normal"], responses, shifts, tolerance, most)
