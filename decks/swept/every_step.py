"""How full the cells stay that a body passes, looked at after every step; snapshots would miss it.

python decks/swept/every_step.py
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.pace import Pace
from flowgmo.state import initial_state
from flowgmo.step import prepare, start_liquid

REAL = (slice(2, -2),) * 3
STOP = 0.4  # s, when the sphere of full.nml stands


class Fullness(NamedTuple):
    """after (n,): time of each step. off (n,): largest |V (F - 1)| in the tank [-]. volume (n,): of the liquid."""

    after: np.ndarray
    off: np.ndarray
    volume: np.ndarray
    tries: int


def look(deck: str, con: float, end: float | None = None) -> Fullness:
    """Step decks/swept/<deck>.nml with another CON."""
    path = Path(__file__).parent / f"{deck}.nml"
    model = build_model(parse_deck(path.read_text().replace("con=0.45", f"con={con}"), path))
    world, state = prepare(model), initial_state(model)
    start_liquid(world, state)
    pace, grid = Pace(model, state), world.liquid.grid
    volumes = np.einsum("i,j,k->ijk", grid.dx, grid.dy, grid.dz)
    rows = []
    while state.t < (model.clock.end if end is None else end):
        pace.advance(world)
        V, F = world.liquid.openings.V[REAL], state.fluid.F[REAL]
        rows.append((state.t, np.abs(V * (F - 1.0)).max(), float((V * F * volumes[REAL]).sum())))
    return Fullness(*np.array(rows).T, pace.cuts)


def main() -> None:
    """Print the largest |V (F - 1)| of the full tank, and ten steps after the sphere stands."""
    for con in (0.45, 0.2, 0.1, 0.05):
        found = look("full", con)
        off = found.off
        rest = int(np.argmax(found.after > STOP + 0.001))
        print(
            f"con {con}: {len(found.after)} steps ({found.tries} tried again), largest {found.off.max():.1e}, "
            f"{off[rest]:.1e} when the sphere stands, {off[min(rest + 10, len(off) - 1)]:.1e} ten steps later, "
            f"volume {np.ptp(found.volume) / found.volume[0]:.1e}"
        )


if __name__ == "__main__":
    main()
