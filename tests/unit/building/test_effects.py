"""The list of effects: what a scene calls for, because of which line, and nothing else."""

import numpy as np


def test_nothing(build):
    """A deck without bodies has no effect at all."""
    model = build("t\n&xput\n twfin=1., gz=-9.81,\n/\n&mesh /\n")
    assert model.effects == () and model.bodies == () and model.contacts is None and model.moving == ()
    assert model.gravity.tolist() == [0, 0, -9.81]


def test_each_with_its_line(build):
    text = """a scene
&xput
 twfin=1., imobs=1,
 gz=-9.81,
 iclid=1, frcmob=.2,
/
&bcdata ibct=6*2 /
&mesh px=-9., 9., py=-9., 9., pz=-9., 9., /
&obs
 nobs=4, tobs=0., 1.,
 imo(1)=4,
 rhomvb(1)=1., iob(1)=1, rsh(1)=.1,
 imo(2)=3,
 rhomvb(2)=1., iob(2)=2, rsh(2)=.1, trnx(2)=1., utobs(1,2)=0., 1.,
 imo(3)=4, imoaxs(3)=2,
 anglmax(3)=10.,
 rhomvb(3)=1., iob(3)=3, rsh(3)=.1, trnx(3)=2., iclidob(3,3)=0,
 igf(3)=1,
 tytobs(1,3)=1.,
 imo(4)=3, iob(4)=4, rsh(4)=.1, trnx(4)=3.,
/
"""
    model = build(text)
    assert {e.name: e.because for e in model.effects} == {
        "gravity": "line 4: gz=-9.81",
        "motion": "line 11: imo(1)=4",
        "prescribed": "line 13: imo(2)=3",
        "fixed axis": "line 15: imoaxs(3)=2",
        "control loads": "line 18: igf(3)=1",
        "stops": "line 16: anglmax(3)=10.0",
        "residual": "line 14: rhomvb(2)=1.0",
        "collisions": "line 5: iclid=1",
        "friction": "line 5: frcmob=0.2",
    }
    assert all(e.what for e in model.effects)


def test_friction_only_where_a_pair_has_it(build):
    """A rough body among smooth walls slides: the smaller coefficient holds, and the effect is absent."""
    text = (
        "t\n&xput\n twfin=1., imobs=1, iclid=1,\n/\n&bcdata ibct=6*2 /\n&mesh px=-1., 1., py=-1., 1., pz=-1., 1., /\n"
        "&obs nobs=1, imo(1)=4, rhomvb(1)=1., iob(1)=1, rsh(1)=.1, cfrc(1)=.5 /\n"
    )
    assert [e.name for e in build(text).effects] == ["motion", "collisions"]


def test_model_is_frozen(build):
    """Deck -> Model: what a run could change by mistake cannot be assigned."""
    import dataclasses

    import pytest

    model = build("t\n&xput twfin=1. /\n&mesh /\n")
    with pytest.raises(dataclasses.FrozenInstanceError):
        model.title = "other"
    assert np.isfinite(model.mesh.bounds).all()
