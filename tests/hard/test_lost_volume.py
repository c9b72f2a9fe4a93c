"""A run whose liquid does not add up ends with the reason."""

from pathlib import Path

import h5py
import numpy as np
from flowgmo_wet import wet
from flowgmo_wet_runs import CLOSED

import flowgmo.flow.stages
from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.run import FAILED, run


def test_liquid_that_vanishes_ends_the_run(tmp_path, monkeypatch, capsys):
    """1.5e-6 of what the cells hold is taken away in one step; the row that shows it is in the history."""
    move, calls = flowgmo.flow.stages.move_liquid, []

    def leak(liquid, flow, dt, number):
        move(liquid, flow, dt, number)
        calls.append(number)
        if len(calls) == 4:
            liquid.F *= 1.0 - 1.5e-6

    monkeypatch.setattr(flowgmo.flow.stages, "move_liquid", leak)
    text = wet(
        "twfin=1., delt=.01, itb=1, gz=-10., tapltd(1)=1., thpltd(1)=.02,", fl="fxh(1)=1., nfls=1,", bcdata=CLOSED
    )
    model = build_model(parse_deck(text, Path("t.nml")))
    assert run(model, tmp_path / "out", None, "test") == FAILED
    assert "volume of the liquid is off by -1.5e-06" in capsys.readouterr().out
    with h5py.File(tmp_path / "out" / "history.h5") as file:
        assert np.abs(file["fluid/volume_error"][-1]) > 1e-6
        assert len(file["fluid/volume_error"]) < 20
    assert (tmp_path / "out" / "restart.h5").exists()
