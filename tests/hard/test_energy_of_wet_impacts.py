"""What an impact in liquid books as lost, bodies and liquid do lose: balls that hit the lid, with gravity a hair apart
(where in its step an impact lies is chance).

To the pressure a face has the mass rho (A S)^2 / b, S its area, b of the pressure's matrix. With these masses the law's
(M + A)^-1 and the answer of the liquid are one system, which by an impulse J = (M + A) (U+ - U) loses

    - (U + U+) . J / 2          U, U+: velocities that the liquid fits before and after

and what flows on into cells that lack liquid takes.
"""

from pathlib import Path

import numpy as np
import pytest
from flowgmo_wet_bodies import begin, hair

from flowgmo.pace import Pace
from flowgmo.wet_impacts import WetImpacts

RELEASED = Path(__file__).parents[2] / "decks" / "hard" / "wet_released.nml"

EXACT = 1e-9  # measured 4e-16; .01 to .55 where an impact meets what the load has made of the velocity until then
LEFT = (
    0.01  # measured: .03 to .8 more is lost than booked, .006 less where pockets are shut in the impact; up to .3 less
)
# where impacts meet such velocities


def moved_by_pressure(world, v):
    """Kinetic energy of the liquid as the pressure sees it, and of the ball with v (3,)."""
    liquid, total = world.liquid, 0.5 * float(world.arrays["mass"][0]) * float(v @ v)
    projector = liquid.projector
    for d, u in enumerate(liquid.predicted):
        flow, b = np.einsum("i,j,k->ijk", *projector.areas[d]) * liquid.openings[1 + d] * u, projector.matrix.b[d]
        total += 0.5 * liquid.plan.rho * float((flow[b > 0.0] ** 2 / b[b > 0.0]).sum())
    return total


def lost_by_law(of, found, after):
    """- (U + U+) . (M + A) (U+ - U) / 2 of the only body, U+ (6,)."""
    mass = np.linalg.inv(of.each_inverse[0]) + found[0][1]
    return -0.5 * float((of.reached[0] + after) @ mass @ (after - of.reached[0]))


@pytest.mark.parametrize("draw", range(5))
@pytest.mark.parametrize("density", (100.0, 1.0))
def test_what_is_booked_is_lost(monkeypatch, density, draw):
    text = RELEASED.read_text().replace("rhomvb(1)=100.0", f"rhomvb(1)={density!r}")
    world, state = begin(hair(text, draw))
    losses = []

    def settle(self, flow, motion, owed, met, of=WetImpacts.settle):
        if not owed.any():
            return of(self, flow, motion, owed, met)
        after = np.hstack([motion["v"][0], motion["w"][0]])
        before = moved_by_pressure(world, world.wet_bodies.reached[0, :3])
        law = lost_by_law(world.wet_bodies, self.found, after)
        given = of(self, flow, motion, owed, met)
        losses.append((law, before - moved_by_pressure(world, motion["v"][0])))
        return given

    monkeypatch.setattr(WetImpacts, "settle", settle)
    pace, booked = Pace(world.model, state), 0.0
    while booked == 0.0 and state.t < world.model.clock.end:
        losses.clear()
        booked = float(pace.advance(world)[0].impacts["energy_loss"].sum())
    ((law, all_of_it),) = losses
    assert booked > 0.02  # [J] of 4.1; measured .025 and more
    assert abs(law - booked) <= EXACT * booked
    assert all_of_it >= (1.0 - LEFT) * booked
