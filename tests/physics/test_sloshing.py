"""Standing waves of small amplitude: the period of the first mode, T = 2 pi / sqrt(g k tanh(k H)), k = pi / L."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_runs import CLOSED, REAL, advance, start

PERIOD = 2.0 * np.pi / np.sqrt(9.81 * np.pi / 2.0 * np.tanh(np.pi / 2.0))  # L = 2, H = 1: 1.67134 s
#: z = 1 +- .019379 (1 - s2), s from the end walls: 32 / pi3 of a parabola is the cosine of .02
TILT = (
    "nfls=2, fcc(1)=-1.01937892, fcz(1)=1., fcx2(1)=.019378925, "
    "fxl(2)=1., fcc(2)=-1.05813676, fcz(2)=1., fcx(2)=.07751569, fcx2(2)=-.019378925,"
)


@pytest.mark.parametrize(("nx", "nz", "bound"), [(25, 16, 0.002), (50, 32, 0.0005)])
def test_period_of_the_first_mode(nx, nz, bound):
    """From passages of the first mode through level, in three periods: off by -.10 % and -.011 %, measured (VALIDATION
    D: .5 %). Where the last pressure meets the new surface (first_stage.py) it was .3 %."""
    mesh = f"px=0., 2., nxcelt={nx}, py=0., .04, nycelt=1, pz=0., 1.26, nzcelt={nz},"
    sides = CLOSED.replace("ibct(3)=2, ibct(4)=2", "ibct(3)=1, ibct(4)=1")
    deck = wet("twfin=9., delt=.004, itb=1, gz=-9.81, ipdis=1,", fl=TILT, mesh=mesh, bcdata=sides)
    liquid, flow, first = start(deck)
    mode = np.cos(np.pi * (np.arange(nx) + 0.5) / nx)
    seen = []

    def note(t, flow):
        seen.append((t, float(mode @ (flow.F[REAL] * liquid.grid.dz[2:-2]).sum(axis=2)[:, 0])))

    _, over, books = advance(liquid, flow, first, end=3.0 * PERIOD, each=note)
    t, tilt = np.array(seen).T
    k = np.flatnonzero(tilt[:-1] * tilt[1:] < 0.0)
    level = t[k] + (t[k + 1] - t[k]) * tilt[k] / (tilt[k] - tilt[k + 1])
    assert len(level) == 6
    period = 2.0 * (level[-1] - level[0]) / 5
    assert abs(period / PERIOD - 1.0) <= bound
    assert books <= 1e-12
