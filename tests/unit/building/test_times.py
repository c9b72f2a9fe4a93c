"""Clock and output intervals."""

import numpy as np
import pytest


def lines(xput):
    """One assignment a line."""
    return xput.replace(", ", ",\n ")


@pytest.fixture
def model(build):
    return lambda xput: build(f"t\n&xput\n {lines(xput)}\n/\n&mesh /\n")


def test_defaults(model):
    made = model("twfin=2.,")
    assert (made.clock.end, made.clock.dt, made.clock.dt_min) == (2.0, 2e-3, 2e-8)
    assert made.clock.last_step == 2**31 - 1
    assert made.output.history.spacing.tolist() == [2e-3] and made.output.history.ends.size == 0
    assert made.output.snapshots.spacing.tolist() == [0.2] and made.output.selected.spacing.tolist() == [0.02]
    assert made.output.restart_wall == 600.0


def test_output_beyond_the_last_step_is_left_out(build):
    """In a dry scene; in a wet one steps grow beyond DELT: rows after (ITWFIN + 1) DELT were missing."""
    text = "t\n&xput\n twfin=1.,\n delt=.01,\n itwfin=9,\n thpltd(1)=.02,\n itb=1,\n/\n&mesh {mesh} /\n{more}"
    dry = build(text.format(mesh="", more=""))
    assert dry.output.history.times(1.0) == pytest.approx([0.02, 0.04, 0.06, 0.08, 0.1, 1.0])
    more = "&props rhof=1000. /\n&fl flht=.5 /\n"
    wet = build(text.format(mesh="px=0.,1., nxcelt=4, py=0.,1., nycelt=4, pz=0.,1., nzcelt=4,", more=more))
    assert len(wet.output.history.times(1.0)) == 50


def test_intervals_change_at_tedit(model):
    """Each value until the same element of TEDIT, the last one to the end."""
    made = model("twfin=2., tpltd(1)=.25, tpltd(2)=.5, tedit(1)=1.,")
    assert made.output.snapshots.times(2.0) == pytest.approx([0.25, 0.5, 0.75, 1.0, 1.5, 2.0])


def test_a_missing_interval_goes_on(model):
    """THPLTD(2) is not given: the first one holds until TEDIT(2)."""
    made = model("twfin=3., thpltd(1)=.5, thpltd(3)=1., tedit(1)=.5, tedit(2)=1.,")
    assert made.output.history.times(3.0) == pytest.approx([0.5, 1.0, 2.0, 3.0])


def test_more_ends_than_intervals(model):
    """The last interval holds to the end of the run, not to its TEDIT."""
    made = model("twfin=2., tpltd(1)=1., thpltd(1)=.5, thpltd(2)=.1, tedit(1)=1., tedit(2)=1.2,")
    assert made.output.history.times(2.0) == pytest.approx([0.5, 1.0, *np.arange(1.1, 2.01, 0.1)])
    assert made.output.snapshots.times(2.0) == pytest.approx([1.0, 2.0])


def test_an_end_after_the_run(model):
    made = model("twfin=1., tpltd(1)=.5, tpltd(2)=.1, tedit(1)=5.,")
    assert made.output.snapshots.times(1.0) == pytest.approx([0.5, 1.0])


def test_largest_steps(model):
    made = model("twfin=1., tdtmax(1)=.1, tdtmax(2)=.2, teditdt(1)=.5,")
    assert made.clock.dt_max.spacing.tolist() == [0.1, 0.2] and made.clock.dt_max.ends.tolist() == [0.5]


@pytest.mark.parametrize(
    ("xput", "says"),
    [
        ("twfin=1., thpltd(1)=1e-12,", ["deck.nml:4: &xput thpltd(1)=1e-12", "rows", "Write thpltd(1)="]),
        ("twfin=1., tpltd(1)=1e-300,", ["deck.nml:4: &xput tpltd(1)=1e-300", "Write tpltd(1)="]),
        ("twfin=1., tapltd(1)=1e-9,", ["deck.nml:4: &xput tapltd(1)=1e-09", "Write tapltd(1)="]),
        ("twfin=1., tsprtd(1)=1e-20,", ["deck.nml:4: &xput tsprtd(1)=1e-20", "Write tsprtd(1)="]),
        ("twfin=5e-324,", ["deck.nml:3: &xput twfin=5e-324"]),
        ("twfin=1., delt=2.,", ["deck.nml:4: &xput delt=2.0", "Write delt=0.001"]),
        ("twfin=1., tdtmax(1)=1e-17,", ["deck.nml:4: &xput tdtmax(1)=1e-17", "dtmin"]),
    ],
)
def test_impossible_times(problems, xput, says):
    """More output than any machine can hold, and steps that never arrive, are said before the run."""
    found = "\n".join(problems(f"t\n&xput\n {lines(xput)}\n/\n&mesh /\n"))
    assert all(word in found for word in says), found
