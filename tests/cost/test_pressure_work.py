"""What the pressure of a scene with a surface costs, in iterations. No times."""

from flowgmo_wet import wet
from flowgmo_wet_runs import CLOSED, advance, start


def test_iterations_of_a_dam_break():
    """50 000 cells, of which 12 500 hold water, to the blow at the other wall and back: 3.6 a solution, 5 at most,
    measured. 8 a solution would be a preconditioner that does not know the surface, or a guess that is none."""
    mesh = "px=0., 2., nxcelt=50, py=0., 1., nycelt=25, pz=0., 1.6, nzcelt=40,"
    dam = "nfls=1, fxh(1)=.8, fzh(1)=1.,"
    liquid, flow, first = start(wet("twfin=2., delt=.002, itb=1, gz=-9.81,", fl=dam, mesh=mesh, bcdata=CLOSED))
    advance(liquid, flow, first, end=1.0)
    tally = liquid.tally
    assert tally.solutions >= 300
    assert tally.all_iterations / tally.solutions <= 5.0
    assert tally.most_iterations <= 8
