"""What a step reports besides the new State: rows of history asked for inside it, and impacts.

Rows are exact states at the asked times in a dry scene. n bodies (deck number minus one), k rows.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields

import numpy as np

REGIMES = ("slip", "stick", "reversal", "jam", "cluster", "rest", "limit")
SLIP, STICK, REVERSAL, JAM, CLUSTER, REST, LIMIT = range(len(REGIMES))

#: One impact. a, b: component numbers; -1 .. -6 domain sides Xmin .. Zmax; 0 a stop. normal: unit, from b to a.
#: impulse on a, fluid_impulse what the liquid around both gets of it, space axes. cluster: shared number of one
#: cluster. count: bounces that a closed series stands for.
IMPACT = np.dtype(
    [
        ("time", "f8"),
        ("a", "i4"),
        ("b", "i4"),
        ("point", "f8", 3),
        ("normal", "f8", 3),
        ("impulse", "f8", 3),
        ("fluid_impulse", "f8", 3),
        ("e", "f8"),
        ("mu", "f8"),
        ("regime", "i4"),
        ("energy_loss", "f8"),
        ("cluster", "i8"),
        ("count", "i8"),
    ]
)


@dataclass
class Rows:
    """History rows; per-body arrays hold stationary bodies too. None: the scene does not have the quantity.

    t (k,) [time]; p_WB, v_WB (k, n, 3); q_WB (k, n, 4) w x y z, sign continuous; w_WB (k, n, 3) space axes;
    contact_force (k, n, 3) [force] of persistent contacts; residual_force [force], residual_torque [torque] (k, n, 3):
    what keeps a prescribed motion, beyond gravity and control loads, the torque about B;
    kinetic_energy (k, n); energy: name -> (k,), names as in `/energy` of history.h5; liquid: name -> (k,) or (k, 3),
    names as in history.h5 (flow/observe/watch.py), empty in a dry scene.
    """

    t: np.ndarray
    p_WB: np.ndarray
    q_WB: np.ndarray
    v_WB: np.ndarray
    w_WB: np.ndarray
    contact_force: np.ndarray | None
    residual_force: np.ndarray | None
    residual_torque: np.ndarray | None
    kinetic_energy: np.ndarray | None
    energy: dict[str, np.ndarray]
    liquid: dict[str, np.ndarray] = field(default_factory=dict)

    def only(self, keep: np.ndarray) -> Rows:
        """The rows where keep (k,) is True."""

        def cut(values: np.ndarray | None) -> np.ndarray | None:
            return None if values is None else values[keep]

        named = ("energy", "liquid")
        parts = {f.name: cut(getattr(self, f.name)) for f in fields(self) if f.name not in named}
        return Rows(**parts, **{of: {name: a[keep] for name, a in getattr(self, of).items()} for of in named})


def no_impacts() -> np.ndarray:
    """An empty table of impacts."""
    return np.zeros(0, IMPACT)
