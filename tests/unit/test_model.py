"""Plans of the Model: when things are written, what is listed, what cannot change."""

import dataclasses
import sys
from pathlib import Path

import numpy as np
import pytest

from flowgmo.model import Intervals

HELPERS = str(Path(__file__).parents[1] / "helpers")


def intervals(spacing, ends=()):
    return Intervals(spacing=np.array(spacing, dtype=float), ends=np.array(ends, dtype=float))


def test_multiples_until_the_end():
    np.testing.assert_allclose(intervals([0.25]).times(1.0), [0.25, 0.5, 0.75, 1.0])


def test_the_end_is_always_there():
    np.testing.assert_allclose(intervals([0.4]).times(1.0), [0.4, 0.8, 1.0])


def test_spacing_changes_where_the_deck_says():
    """.1 until .3, then .35."""
    np.testing.assert_allclose(intervals([0.1, 0.35], [0.3]).times(1.0), [0.1, 0.2, 0.3, 0.65, 1.0])


@pytest.mark.parametrize("n", [10, 1000, 12345])
def test_rounding_neither_doubles_nor_drops_a_time(n):
    """end/n as a spacing: n times, all apart. Fails if the last multiple and the end are both kept."""
    times = intervals([1.0 / n]).times(1.0)
    assert len(times) == n and times[-1] == 1.0
    assert np.diff(times).min() > 0.5 / n


def test_a_model_is_frozen_and_says_what_is_on():
    sys.path.insert(0, HELPERS)
    from flowgmo_scenes import Scene, ball, deck

    model = Scene(deck(ball((0, 0, 0)), ball((1, 0, 0)), g=(0, 0, -1), mu=0.2)).model
    assert [e.name for e in model.effects] == ["gravity", "motion", "collisions", "friction"]
    assert all(e.because for e in model.effects)
    assert model.has("friction") and not model.has("stops")
    with pytest.raises(dataclasses.FrozenInstanceError):
        model.gravity = None


@pytest.mark.parametrize("text, on", [
    ("imo(#)=3, utobs(1,#)=1.0,", {"prescribed"}),
    ("imo(#)=4, rhomvb(#)=1.0, dxmcmax(#)=1.0,", {"motion", "stops"}),
    ("imo(#)=4, rhomvb(#)=1.0, imoaxs(#)=3,", {"motion", "fixed axis"}),
    ("imo(#)=4, rhomvb(#)=1.0, imoaxs(#)=4,", {"motion", "fixed point"}),
    ("imo(#)=4, rhomvb(#)=1.0, igf(#)=1, fxtobs(1,#)=1.0,", {"motion", "control loads"}),
    ("imo(#)=4, rhomvb(#)=1.0, ivmcal(#)=0,", {"motion", "residual"}),
    ("imo(#)=3, rhomvb(#)=1.0, utobs(1,#)=1.0,", {"prescribed", "residual"}),
])  # fmt: skip
def test_a_scene_has_the_effects_its_deck_asks_for_and_no_others(text, on):
    sys.path.insert(0, HELPERS)
    from flowgmo_scenes import Scene, deck

    s = Scene(deck(text + " iob(#)=#, rsh(#)=0.1,", collide=False))
    assert {e.name for e in s.model.effects} == on
