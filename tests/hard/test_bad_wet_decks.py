"""Wrong decks with liquid: `run` and `check` say what is wrong, where, and what to write, and leave nothing behind."""

import json
import sys

import h5py
import pytest
from flowgmo_wet import FREE, FULL, wet

from flowgmo import cli

BODY = "nobs=1, iob(1)=1, zh(1)=.1,"
MOVES = FREE + "imobs=1, iclid=1,"
TWO = "nobs=2, iob(1)=1,2, rsh(1)=.2,.2, trnx(1)=1.,1.2, trny(1)=.5,.5, trnz(1)=.5,.5,"
BALL = "nobs=1, iob(1)=1, rsh(1)=.2, trnx(1)=1., trny(1)=.5, trnz(1)=.5,"

# The deck, and what the text names. Lines: &xput 3, &props 6, &mesh 9, &fl 12, others from 15.
WRONG = {
    "mesh planes": (wet(mesh="px=0., 2., 1., nxcelt=9,"), ["bad.nml:9: &mesh px(3)=1.0", "Let px increase"]),
    "no cells": (wet(mesh="nxcelt=0,"), ["bad.nml:9: &mesh nxcelt=0", "must be >= 1"]),
    "one cell": (wet(mesh="px=0., 2.,"), ["bad.nml:9: &mesh px(2)=2.0", "nothing flows", "Give nxcelt"]),
    "total without if_size": (
        wet(mesh="px=0., 2., ntotal=2000,"),
        ["bad.nml:9: &mesh ntotal=2000", "nothing flows", "Write if_size=0, with which cells follow ntotal"],
    ),
    "size without if_size": (
        wet(mesh="px=0., 2., if_size=0, size=.1,"),
        ["bad.nml:9: &mesh size=0.1", "nothing flows", "Write if_size=1, with which cells follow size"],
    ),
    "memory": (
        wet(mesh="px=0.,2.,py=0.,1.,pz=0.,1.,\nsize=1e-5,"),
        ["bad.nml:10: &mesh size=1e-05", "this machine has", "Write a mesh of at most"],
    ),
    "negative density": (wet(props="rhof=-1000.,"), ["bad.nml:6: &props rhof=-1000.", "must be > 0"]),
    "no density": (wet(props="mu1=1.,"), ["bad.nml:12: &fl flht=0.5", "Give rhof"]),
    "region outside": (wet(fl="nfls=1, fxl(1)=3.,"), ["bad.nml:12: &fl fxl(1)=3.0", "outside the mesh", "Move it"]),
    "no liquid": (wet(fl=""), ["bad.nml:6: &props rhof=1000.0", "no liquid", "Write flht"]),
    "into a wall": (
        wet(bcdata="ibct(5)=2, wbct(1,5)=1.,"),
        ["bad.nml:15: &bcdata wbct(1,5)=1.0", "into the side Zmin", "Write ibct(5)=6"],
    ),
    "times": (
        wet(bcdata="ibct(1)=6, timbct=0.,1.,1., ubct(1,1)=0.,1.,2.,"),
        ["bad.nml:15: &bcdata timbct(3)=1.0", "Let the times increase"],
    ),
    "too few times": (
        wet(bcdata="ibct(1)=6, timbct=0.,1., ubct(1,1)=0.,1.,2.,"),
        ["bad.nml:15: &bcdata ubct(3,1)=2.0", "Give timbct(3)"],
    ),
    "no table": (
        wet(bcdata="ibct(1)=6, fubct(1)='u.csv', iubctc(1)=2,"),
        ["bad.nml:15: &bcdata fubct(1)='u.csv'", "there is no such file"],
    ),
    "unbalanced": (
        wet(xput=FULL, fl="", bcdata="ibct(1)=6,\nubct(1,1)=1.,"),
        ["bad.nml:16: &bcdata ubct(1,1)=1.0", "more enters the domain than leaves it", "Write velocities that balance"],
    ),
    "one periodic side": (
        wet(bcdata="ibct(3)=4,"),
        ["bad.nml:15: &bcdata ibct(3)=4", "Ymin is periodic and Ymax is not"],
    ),
    "bodies through periodic sides": (
        wet(xput=FREE + "imobs=1,", props="", fl="", bcdata="ibct(3)=4,4,", obs=BODY + "imo(1)=4, rhomvb(1)=1.,"),
        ["bad.nml:15: &bcdata ibct(3)=4", "moving bodies with periodic sides"],
    ),
    "bodies and relaxation": (
        wet(xput=FREE + "imobs=1, igmres=0,", obs=BALL + "imo(1)=4, rhomvb(1)=1.,"),
        ["bad.nml:3: &xput igmres=0", "relaxation of the pressure with bodies", "Write igmres=1"],
    ),
    "body without mass in liquid": (
        wet(xput=FREE + "imobs=1,", obs=BALL + "imo(1)=4,"),
        ["bad.nml:14: &obs rhomvb(1)", "no density"],
    ),
    "body of negative density": (
        wet(xput=MOVES, obs=BALL + "\nimo(1)=4, rhomvb(1)=-500.,"),
        ["bad.nml:16: &obs rhomvb(1)=-500.", "must be >= 0"],
    ),
    "body outside": (
        wet(xput=MOVES, bcdata="ibct(2)=2,", obs=BALL.replace("trnx(1)=1.", "trnx(1)=9.") + "imo(1)=4, rhomvb(1)=5.,"),
        ["bad.nml:18: &obs imo(1)=4", "outside the domain, beyond its side Xmax", "Move the body"],
    ),
    "body everywhere": (
        wet(xput=MOVES, obs="nobs=1, iob(1)=1, zl(1)=-1., imo(1)=3, wtobs(1,1)=1.,"),
        ["bad.nml:15: &obs nobs=1", "obs1 fills the whole mesh at the start"],
    ),
    "speed that is no number": (
        wet(xput=MOVES, obs=BALL + "\nimo(1)=3, tobs(1)=0.,1., utobs(1,1)=0.,nan,"),
        ["bad.nml:16: &obs utobs(2,1)", "nan is no number", "Give a finite value"],
    ),
    "speed without end": (
        wet(xput=MOVES, obs=BALL + "\nimo(1)=3, tobs(1)=0.,1., utobs(1,1)=0.,inf,"),
        ["bad.nml:16: &obs utobs(2,1)", "inf is no number"],
    ),
    "speed that jumps": (
        wet(xput=MOVES, obs=BALL + "\nimo(1)=3, tobs(1)=0.,1.,1.,2., utobs(1,1)=0.,0.,1.,1.,"),
        ["bad.nml:16: &obs tobs(3)=1.0", "does not come after", "Let the times increase"],
    ),
    "two bodies in one place": (
        wet(xput=MOVES, obs=TWO + "imo(1)=4,4, rhomvb(1)=500.,500.,"),
        ["bad.nml:15: &obs imo(2)=4", "obs1 and obs2 overlap at the start by 0.2", "write iclidob(1,2)=0"],
    ),
    "body in a solid": (
        wet(xput=MOVES, obs=TWO + "imo(2)=4, rhomvb(2)=500.,"),
        ["bad.nml:15: &obs imo(2)=4", "obs1 and obs2 overlap at the start by 0.2", "Move one of them"],
    ),
    "nothing wet around a body": (
        wet(xput=MOVES, fl="", obs=BALL + "imo(1)=4, rhomvb(1)=500.,"),
        ["bad.nml:6: &props rhof=1000.0", "no liquid at the start", "Write flht"],
    ),
    "unknown law of impacts": (
        wet(xput=MOVES, obs=BALL + "imo(1)=4, rhomvb(1)=500.,", flowgmo="wetimpact='moist',"),
        ["bad.nml:18: &flowgmo wetimpact='moist'", "one of 'wet', 'dry'"],
    ),
    "all solid": (wet(obs="nobs=1, iob(1)=1, zl(1)=-1.,"), ["bad.nml:15: &obs nobs=1", "obs1 fills the whole mesh"]),
    "first step": (wet(xput=FREE + "delt=5.,"), ["bad.nml:3: &xput delt=5.0", "longer than the run"]),
    "smallest step": (wet(xput=FREE + "dtmin=5.,"), ["bad.nml:3: &xput dtmin=5.0", "larger than the first one"]),
    "second order": (wet(xput=FREE + "iorder=2,"), ["bad.nml:3: &xput iorder=2", "known but not computed"]),
    "two fluids": (wet(xput=FREE + "nmat=2,"), ["bad.nml:3: &xput nmat=2", "known but not computed"]),
    "accelerated mesh": (wet(xput=FREE + "iaccf=1,"), ["bad.nml:3: &xput iaccf=1", "known but not computed"]),
    "heat": (wet(xput=FREE + "ifenrg=1,"), ["bad.nml:3: &xput ifenrg=1", "known but not computed"]),
    "waves": (wet(bcdata="ibct(1)=10,"), ["bad.nml:15: &bcdata ibct(1)=10", "known but not computed"]),
}


@pytest.fixture
def flowgmo(monkeypatch, capsys, tmp_path):
    """Runs the command in the test's own folder: exit code, standard output, standard error."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["flowgmo", *arguments])
        code = 0
        try:
            cli.main()
        except SystemExit as end:
            code = end.code
        said = capsys.readouterr()
        assert "Traceback" not in said.out + said.err and "unforeseen" not in said.err, said.err
        return code, said.out, said.err

    return call


@pytest.mark.parametrize("name", WRONG)
def test_wrong_deck(flowgmo, tmp_path, name):
    text, says = WRONG[name]
    (tmp_path / "bad.nml").write_text(text)
    code, _, err = flowgmo("run", "bad.nml")
    assert code == 2 and all(word in err for word in says), err
    assert "1 problem, nothing was computed" in err and [p.name for p in tmp_path.iterdir()] == ["bad.nml"]
    assert flowgmo("check", "bad.nml") == (code, "", err)


def test_a_table_that_is_no_table_of_numbers(flowgmo, tmp_path):
    (tmp_path / "bad.nml").write_text(wet(xput=MOVES, obs=BALL + "imo(1)=3, futobs(1)='u.csv', iutobsc(1)=2,"))
    (tmp_path / "u.csv").write_text("0., 0.\n.1, nan\n.2, 1.\n")
    code, _, err = flowgmo("run", "bad.nml")
    assert code == 2 and "bad.nml:15: &obs futobs(1)='u.csv': u.csv:2: nan is not a finite number" in err, err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.nml", "u.csv"]


def test_a_body_that_presses_a_full_chamber_ends_the_run(flowgmo, tmp_path):
    """The reason, what was so far, and the last good state are kept.

    The volume, which is that of the room, had shrunk by 6e-7 of itself (measured): less than the books may miss, 1e-6.
    """
    piston = "nobs=1, iob(1)=1, xl(1)=-1., xh(1)=.3, yl(1)=-1., yh(1)=2., zl(1)=-1., zh(1)=2., imo(1)=3,"
    obs = piston + "tobs(1)=0.,1., utobs(1,1)=0.,.5,"
    (tmp_path / "bad.nml").write_text(wet(xput="twfin=1., gz=-9.81, imobs=1,", fl="", obs=obs))
    code, out, _ = flowgmo("run", "bad.nml")
    said = " ".join(out.split())
    assert code == 1 and "body obs1 presses liquid together that fills a closed space of 2550 cells" in said
    assert "Give the space an opening" in said and "rcsql in &props" in said
    with h5py.File(tmp_path / "bad.out" / "history.h5") as file:
        assert len(file["time"]) >= 1 and abs(file["fluid/volume"][-1] - 2.55) <= 1e-6 * 2.55
    assert json.loads((tmp_path / "bad.out" / "run.json").read_text())["status"] == "failed"
    assert (tmp_path / "bad.out" / "restart.h5").is_file()


def test_a_pressure_that_does_not_converge_ends_the_run(flowgmo, tmp_path):
    """One iteration a solution, and a tolerance that no step meets: steps are halved down to DTMIN, and the text says
    what to write. So the run goes on from the state before the step, here the first one."""
    dam = "nfls=1, fxh(1)=.8, fzh(1)=1.,"
    (tmp_path / "bad.nml").write_text(wet(xput=FREE + "delt=.005, epsadj=1e-7,", fl=dam, limits="itmax=1,"))
    code, out, _ = flowgmo("run", "bad.nml")
    said = " ".join(out.split())
    assert code == 1 and "failed: the pressure did not converge in 1 iterations" in said
    assert "Write a larger itmax in &limits, or a larger epsadj in &xput" in said
    told = json.loads((tmp_path / "bad.out" / "run.json").read_text())
    assert told["status"] == "failed" and "did not converge" in told["reason"]
    (tmp_path / "good.nml").write_text(wet(xput=FREE.replace("twfin=2.", "twfin=.02, delt=.005"), fl=dam))
    code, _, err = flowgmo("run", "good.nml", "--restart", "bad.out/restart.h5")
    assert code == 0, err


def test_a_sound_deck_runs_and_keeps_its_liquid(flowgmo, tmp_path):
    """The deck that the wrong ones vary: it runs, says how much liquid there is, and loses none (measured 0)."""
    (tmp_path / "a.nml").write_text(wet(FREE.replace("twfin=2.", "twfin=.05, delt=.01")))
    code, _, err = flowgmo("run", "a.nml")
    assert code == 0, err
    with h5py.File(tmp_path / "a.out" / "history.h5") as file:
        assert abs(file["fluid/volume"][-1] - 1.0) <= 1e-12
        assert abs(file["fluid/volume_error"][-1]) <= 1e-12
