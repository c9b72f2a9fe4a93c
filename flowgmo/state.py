"""State: every array that changes during a run. The glossary of what moves.

| symbol  | word                     | shape   | unit        | axes          | written by          |
|---------|--------------------------|---------|-------------|---------------|---------------------|
| t       | time                     | -       | time        |               | State.advance_clock |
| p_WB    | position of B            | (n, 3)  | length      | space         | step                |
| q_WB    | orientation w x y z      | (n, 4)  | -           | body to space | step                |
| v_WB    | velocity of B            | (n, 3)  | length/time | space         | step                |
| w_WB    | angular velocity         | (n, 3)  | rad/time    | space         | step                |
| angle   | turned about a fixed axis| (n,)    | rad         | about it      | step                |
| hold    | held at a stop           | (n, 4)  | -1, 0, +1   | x y z, angle  | step                |
| support | flats a ball rests on    | (n, 3)  | flat or -1  |               | collisions          |
| held_parts, held_values | contacts that last (collision/stage.py) | (c, 3), (c, 10) | - | space | step |
| asleep, quiet | who sleeps; for how many legs one was quiet (collision/sleep.py) | (n,) | - |  | step |
| books   | energy given and lost    | (BOOKS) | energy      |               | step                |
| owed    | friction owed to bodies that move after the liquid, `impmob=0` | (n, 6) | momentum | space | step |
| rates   | dv/dt, dw/dt in the last step and the one before (wet_foresight.py) | (n, 2, 6) | | space | step |

B is the mass centre, or the reference point of a body without mass (bodies/body.py). Stationary bodies keep their
rows so that a body's row is its deck number minus one. `fluid` holds the mesh fields (u v w p F V Ax Ay Az, places in
flow/fields.py) in a scene with liquid and is None in a dry one.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from flowgmo.flow.fields import Flow
from flowgmo.model import Model

BOOKS = ("impacts", "dissipated", "work_prescribed", "work_loads")
LOST_IN_IMPACTS, LOST_IN_FRICTION, FROM_PRESCRIBED, FROM_LOADS = range(len(BOOKS))


@dataclass
class State:
    """One instant of a scene. `restart.h5` holds exactly these fields."""

    t: float
    step: int
    landed: float  # time of the last output landing; steps are counted from it so that they do not drift
    since_landing: int
    impacts: int
    p_WB: np.ndarray
    q_WB: np.ndarray
    v_WB: np.ndarray
    w_WB: np.ndarray
    angle: np.ndarray
    hold: np.ndarray
    support: np.ndarray
    held_parts: np.ndarray
    held_values: np.ndarray
    asleep: np.ndarray
    quiet: np.ndarray
    general: bool  # the closed forms of balls no longer do: the contact engine has taken over (collision/stage.py)
    busy: bool  # impacts are too many to be resolved one by one (collision/crowd.py)
    books: np.ndarray
    owed: np.ndarray
    rates: np.ndarray
    fluid: Flow | None = None

    def advance_clock(self, t: float, landing: bool) -> None:
        """Set the time reached [time]; a landing restarts the count of equal steps."""
        self.t = t
        self.step += 1
        self.since_landing += 1
        if landing:
            self.landed = t
            self.since_landing = 0

    def nbytes(self) -> int:
        """Bytes of all arrays."""
        own = sum(v.nbytes for f in fields(self) if isinstance(v := getattr(self, f.name), np.ndarray))
        return own + (self.fluid.nbytes() if self.fluid is not None else 0)


def initial_state(model: Model) -> State:
    """The state at t = 0: every body where the deck puts it, with its initial velocities; `fluid` is still None."""
    n = len(model.bodies)
    state = State(
        t=0.0,
        step=0,
        landed=0.0,
        since_landing=0,
        impacts=0,
        p_WB=np.array([b.origin for b in model.bodies], dtype=float).reshape(n, 3),
        q_WB=np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
        v_WB=np.array([b.velocity for b in model.bodies], dtype=float).reshape(n, 3),
        w_WB=np.array([_initial_spin(b) for b in model.bodies], dtype=float).reshape(n, 3),
        angle=np.zeros(n),
        hold=np.zeros((n, 4), dtype=np.int8),
        support=np.full((n, 3), -1, dtype=np.int32),
        held_parts=np.zeros((0, 3), dtype=np.int64),
        held_values=np.zeros((0, 10)),
        asleep=np.zeros(n, dtype=np.int64),
        quiet=np.zeros(n, dtype=np.int64),
        general=False,
        busy=False,
        books=np.zeros(len(BOOKS)),
        owed=np.zeros((n, 6)),
        rates=np.zeros((n, 2, 6)),
    )
    return state


def _initial_spin(body) -> np.ndarray:  # noqa: ANN001 (a Body; body axes are space axes at t = 0)
    return body.spin if body.axis is None else body.spin[0] * body.axis
