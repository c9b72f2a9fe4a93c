"""A gate comes down before an opening in a wall and shuts it: what that takes does not depend on the step."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import play

from flowgmo.step import liquid_values

SHUT, STILL = 0.2, 480.0  # [s] when the gate's bottom reaches the bed; [N] on the gate by water at rest, afterwards


def gate(con):
    """Water .5 m deep stands behind a wall with an opening of .2 m at the bed; a gate of .08 x .35 m, flush with the
    wall, comes down before it with 1 m/s. Cells of .05 m."""
    return wet(
        f"twfin=.3, delt=.004, con={con}, itb=1, ipdis=1, gz=-9.81, imobs=1,", bcdata="ibct=2,2,2,2,2,2,",
        mesh="px=0.,1., py=0.,.5, pz=0.,.6, nxcelt=20, nycelt=10, nzcelt=12,",
        fl="flht=-1., nfls=1, fxh(1)=.5, fzh(1)=.5,",
        obs=f"nobs=2, obsid(1)='wall', imo(1)=0, iob(1)=1, xl(1)=.5, xh(1)=.6, zl(1)=.2, obsid(2)='gate', imo(2)=3, "
        f"iob(2)=2, xl(2)=.42, xh(2)=.5, yl(2)=-.1, yh(2)=.6, zl(2)=.2, zh(2)=.55, tobs(1)=0.,{SHUT},{SHUT + 1e-4},9., "
        "wtobs(1,2)=-1.,-1.,0.,0.,",
    )  # fmt: skip


def test_work_and_impulse_are_those_of_any_step():
    """Steps of .45, .15 and .05 of a cell, 46, 110 and 307 until .21 s. Work of the gate: 84, 97, 97 J; with the liquid
    in the last slit (a hundredth of a cell) at rest before each step 154, 268, 822: each had to set it going again.
    Impulse of the stop along the stream: -9.9, -10.2, -10.1 N s. Then the load is that of water at rest: 480 N."""
    works, impulses = [], []
    for con in (0.45, 0.15, 0.05):
        rows = []

        def note(world, state, report, rows=rows, last=[0.0]):  # noqa: B006
            force, dt = world.wet_bodies.records.loads.total[0][0], state.t - last[0]
            rows.append((state.t, dt, force, liquid_values(world, state)["energy/work_prescribed"]))
            last[0] = state.t

        play(gate(con).replace("twfin=.3", "twfin=.21"), 2000, each=note)
        t, dt, force, work = np.array(rows).T
        stop = (t > SHUT - 5e-4) & (t < SHUT + 5e-3)
        works.append(work[-1])
        impulses.append(((force - STILL) * dt)[stop].sum())
        late = t > SHUT + 6e-3
        assert force[late] == pytest.approx(STILL, rel=0.1)
    assert works == pytest.approx([90.0] * 3, rel=0.2)
    assert np.ptp(impulses) < 0.2 * abs(np.mean(impulses))
