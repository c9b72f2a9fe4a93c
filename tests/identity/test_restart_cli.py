"""Restart is no restart: a run that is stopped, killed or extended and goes on ends with the bits of one that is not.

The scene has a ball that bounces, slides and rolls to rest, one that spins into it, a spinning brick, a pendulum with
stops, and a driven plate: every way of moving, and every part of the State.
"""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from flowgmo import cli

SCENE = """Everything that moves
&xput
 twfin={end}, delt={dt}, itwfin={steps}, gz=-9.81, gx=.3, imobs=1, iclid=1, strngmob=.6, frcmob=.2,
 thpltd(1)=.0137, tpltd(1)=.25, tapltd(1)=.11,
/
&bcdata ibct(1)=2, ibct(2)=2, ibct(3)=1, ibct(4)=1, ibct(5)=2, ibct(6)=3 /
&mesh px=-1., 1., py=-1., 1., pz=0., 2., /
&obs
 nobs=5, tobs=0., .4, 1.,
 obsid(1)='ball', imo(1)=4, rhomvb(1)=1000., iob(1)=1, rsh(1)=.1, trnz(1)=.6, utobs(1,1)=.3,
 obsid(2)='shot', imo(2)=4, rhomvb(2)=3000., iob(2)=2, rsh(2)=.05, trnx(2)=.6, trnz(2)=.4, utobs(1,2)=-2.,
 omytobs(1,2)=30., omztobs(1,2)=5.,
 obsid(3)='brick', imo(3)=4, rhomvb(3)=1000., iob(3)=3, xl(3)=-.1, xh(3)=.1, yl(3)=-.2, yh(3)=.2, zl(3)=-.3, zh(3)=.3,
 trnz(3)=5., omxtobs(1,3)=.01, omytobs(1,3)=3., iclidob(3,3)=0, igf(3)=1, txtobs(1,3)=0., txtobs(2,3)=.5,
 txtobs(3,3)=0.,
 obsid(4)='pendulum', imo(4)=4, imoaxs(4)=2, xaxs0(4)=.0, zaxs0(4)=8., rhomvb(4)=1000., iob(4)=4, rsh(4)=.1,
 trnx(4)=.5, trnz(4)=8., anglmin(4)=60., anglmax(4)=70., iclidob(4,4)=0,
 obsid(5)='plate', imo(5)=3, iob(5)=5, xl(5)=-.1, xh(5)=.1, yl(5)=-.1, yh(5)=.1, zl(5)=9., zh(5)=9.1, iwpre(5)=1,
 wamp(5)=.3, wfre(5)=2.3, omztobs(1,5)=0., omztobs(2,5)=1., omztobs(3,5)=-1., iclidob(5,5)=0,
/
"""
COMMAND = [sys.executable, "-m", "flowgmo.cli"]


def scene(end=1.0, dt=0.01, steps=2_000_000_000):
    return SCENE.format(end=end, dt=dt, steps=steps)


@pytest.fixture
def flowgmo(monkeypatch, capsys, tmp_path):
    """Runs the command in the test's own folder: exit code and standard error."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["flowgmo", *map(str, arguments)])
        code = 0
        try:
            cli.main()
        except SystemExit as end:
            code = end.code
        said = capsys.readouterr()
        assert "Traceback" not in said.out + said.err and "unforeseen" not in said.err, said.err
        return code, said.err

    return call


def content(folder):
    """All that a run computed, bit by bit: history, state, pictures (a restarted run may differ in its words only)."""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset) and name != "deck":
            values = np.asarray(item[()])
            found[f"{Path(file.filename).name}:{name}"] = (
                values.tolist() if values.dtype == object else values.tobytes()
            )

    for name in ("history.h5", "restart.h5"):
        with h5py.File(folder / name) as file:
            file.visititems(keep)
    found |= {path.name: path.read_bytes() for path in (folder / "vtk").iterdir()}
    return found


def same(one, other):
    """Assert equality, and name what differs."""
    a, b = content(one), content(other)
    assert sorted(a) == sorted(b)
    assert [name for name in a if a[name] != b[name]] == []


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The uninterrupted run to t = 1, with a landing at 0.5."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "a.nml").write_text(scene())
    done = subprocess.run([*COMMAND, "run", "a.nml"], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "a.out" / "history.h5") as file:
        names = file["collisions"].attrs["names"]
        partners = {tuple(pair) for pair in zip(file["collisions/a"][:], file["collisions/b"][:], strict=True)}
    assert (1, -5) in partners and len(partners & {(1, 2), (2, 1)}) and len(names) == 12  # the scene is worth it
    return folder / "a.out"


@pytest.mark.parametrize("steps", [1, 33, 50, 97])
def test_stopped_at_a_step(flowgmo, tmp_path, whole, steps):
    """At any step: before a landing, on it, and after most has come to rest."""
    (tmp_path / "a.nml").write_text(scene(steps=steps))
    assert flowgmo("run", "a.nml")[0] == 0
    (tmp_path / "a.nml").write_text(scene())
    assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5") == (0, "")
    same(tmp_path / "a.out", whole)


def test_stopped_many_times(flowgmo, tmp_path, whole):
    (tmp_path / "a.nml").write_text(scene(steps=10))
    assert flowgmo("run", "a.nml")[0] == 0
    for steps in (11, 24, 25, 26, 60, 2_000_000_000):
        (tmp_path / "a.nml").write_text(scene(steps=steps))
        assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5")[0] == 0
    same(tmp_path / "a.out", whole)
    assert (tmp_path / "a.out" / "run.log").read_text().count("continued at t") == 6


def even(**more):
    """The scene with output times of which 0.5 is one: the row at the end of a run of that length is no extra row."""
    return scene(**more).replace("thpltd(1)=.0137", "thpltd(1)=.0125").replace("tapltd(1)=.11", "tapltd(1)=.125")


def test_a_later_end(flowgmo, tmp_path):
    """A finished run goes on with a larger TWFIN; then once more from the older restart file: later rows go first."""
    (tmp_path / "b.nml").write_text(even())
    assert flowgmo("run", "b.nml")[0] == 0
    (tmp_path / "a.nml").write_text(even(end=0.5))
    assert flowgmo("run", "a.nml")[0] == 0
    old = (tmp_path / "a.out" / "restart.h5").read_bytes()
    (tmp_path / "a.nml").write_text(even())
    for _ in range(2):
        assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5") == (0, "")
        same(tmp_path / "a.out", tmp_path / "b.out")
        (tmp_path / "a.out" / "restart.h5").write_bytes(old)


def test_into_another_folder(flowgmo, tmp_path, whole):
    """-o: the folder gets what comes after the restart; the old one is not touched."""
    (tmp_path / "a.nml").write_text(scene(end=0.5))
    assert flowgmo("run", "a.nml")[0] == 0
    before = content(tmp_path / "a.out")
    (tmp_path / "a.nml").write_text(scene())
    assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5", "-o", "b") == (0, "")
    assert content(tmp_path / "a.out") == before
    with h5py.File(tmp_path / "b" / "history.h5") as new, h5py.File(whole / "history.h5") as all_rows:
        late = all_rows["time"][:] > 0.5
        assert (new["time"][:] == all_rows["time"][:][late]).all()
        for name in ("ball", "shot", "brick", "pendulum", "plate"):
            for what in ("position", "orientation", "velocity"):
                table = f"bodies/{name}/{what}"
                assert (new[table][:] == all_rows[table][:][late]).all(), table


# ---- signals


LONG = {"end": 1.0, "dt": 2e-4}  # 5000 steps, a few seconds


def started(folder, wait_for):
    """A run in a process of its own, when the file that we wait for is there."""
    (folder / "a.nml").write_text(scene(**LONG))
    process = subprocess.Popen(
        [*COMMAND, "run", "a.nml"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    end = time.monotonic() + 300
    while not (folder / "a.out" / wait_for).exists():
        assert process.poll() is None and time.monotonic() < end, process.communicate()
        time.sleep(0.002)
    return process


@pytest.fixture(scope="module")
def long(tmp_path_factory):
    """The uninterrupted long run."""
    folder = tmp_path_factory.mktemp("long")
    (folder / "a.nml").write_text(scene(**LONG))
    done = subprocess.run([*COMMAND, "run", "a.nml"], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return folder / "a.out"


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
def test_interrupted(flowgmo, tmp_path, long, which):
    """Ctrl-C, or a polite kill: 130, all that was computed is readable, and the run goes on as if nothing had been."""
    process = started(tmp_path, "vtk/bodies_000002.vtp")
    process.send_signal(which)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in out + err
    assert "interrupted" in out and "--restart" in out
    folder = tmp_path / "a.out"
    summary = json.loads((folder / "run.json").read_text())
    assert summary["status"] == "interrupted" and 0.0 < summary["t"] < 1.0
    with h5py.File(folder / "history.h5") as file, h5py.File(folder / "restart.h5") as restart:
        t = restart["state/t"][()]
        assert t == summary["t"] and file["time"][-1] <= t < file["time"][-1] + 0.0137
    assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5") == (0, "")
    same(folder, long)
    assert json.loads((folder / "run.json").read_text())["status"] == "done"


def test_killed(flowgmo, tmp_path, long):
    """SIGKILL: the restart file of the last full landing is whole, and what came after it is computed again."""
    process = started(tmp_path, "restart.h5")
    time.sleep(0.3)
    process.kill()
    process.communicate()
    folder = tmp_path / "a.out"
    with h5py.File(folder / "restart.h5") as restart:
        assert restart["state/t"][()] % 0.25 == pytest.approx(0.0, abs=1e-12)
    assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5") == (0, "")
    same(folder, long)


def test_interrupted_before_the_first_step(tmp_path):
    """While the kernels are still loading: 130, or the end of the first step and then 130; never a traceback."""
    process = started(tmp_path, "deck.resolved.nml")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 130 and "Traceback" not in out + err
    with h5py.File(tmp_path / "a.out" / "history.h5"):
        pass  # it can be opened


# ---- restart files that do not fit


@pytest.fixture
def half(flowgmo, tmp_path):
    """A folder with a run to t = 0.5."""
    (tmp_path / "a.nml").write_text(scene(end=0.5))
    assert flowgmo("run", "a.nml")[0] == 0
    return tmp_path / "a.out"


def refused(flowgmo, folder, deck, restart, *says):
    """Exit 2, clear words, and not one byte of the results changed."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    code, err = flowgmo("run", deck, "--restart", restart)
    assert code == 2 and all(word in err for word in says), err
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_finished(flowgmo, half):
    refused(flowgmo, half, "a.nml", "a.out/restart.h5", "stands at t = 0.5", "twfin=0.5", "Write a later twfin")


def test_an_earlier_end(flowgmo, half, tmp_path):
    (tmp_path / "a.nml").write_text(scene(end=0.25))
    refused(flowgmo, half, "a.nml", "a.out/restart.h5", "stands at t = 0.5", "twfin=0.25")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("gz=-9.81", "gz=-1.62", ("GZ was -9.81, is -1.62",)),
        ("strngmob=.6", "strngmob=.7", ("CRSTRNG(1) was 0.6, is 0.7", "and 1 more")),
        ("obsid(1)='ball'", "obsid(1)='egg'", ("component 1 was ball", "is egg")),
        ("imoaxs(4)=2", "imoaxs(4)=3", ("another deck",)),
        ("trnz(1)=.6", "trnz(1)=.61", ("TRNZ(1) was 0.6, is 0.61",)),
    ],
)
def test_foreign(flowgmo, half, tmp_path, old, new, says):
    """The file of another scene: what differs is named."""
    (tmp_path / "a.nml").write_text(scene().replace(old, new))
    refused(flowgmo, half, "a.nml", "a.out/restart.h5", *says)


def test_fewer_bodies(flowgmo, half, tmp_path):
    (tmp_path / "b.nml").write_text("t\n&xput twfin=1. /\n&mesh /\n")
    refused(flowgmo, half, "b.nml", "a.out/restart.h5", "holds 5 bodies, the deck has 0")


@pytest.mark.parametrize("name", ["nowhere.h5", "a.out", "a.nml", "a.out/history.h5", "a.out/run.json"])
def test_no_restart_file(flowgmo, half, name):
    refused(flowgmo, half, "a.nml", name, "restart file", Path(name).name)


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.99])
def test_damaged(flowgmo, half, tmp_path, part):
    (tmp_path / "a.nml").write_text(scene())
    file = half / "restart.h5"
    file.write_bytes(file.read_bytes()[: int(part * file.stat().st_size)])
    refused(flowgmo, half, "a.nml", "a.out/restart.h5", "not a readable restart file")


def test_flipped_bytes(flowgmo, half, tmp_path):
    """Whatever single byte is wrong: refused, or a run that ends; never a traceback or an unforeseen error."""
    (tmp_path / "a.nml").write_text(scene(end=0.51))
    whole = (half / "restart.h5").read_bytes()
    dice = np.random.default_rng(1)
    for place in dice.integers(0, len(whole), 40):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << dice.integers(8)
        (tmp_path / "r.h5").write_bytes(bytes(damaged))
        code, _ = flowgmo("run", "a.nml", "--restart", "r.h5", "-o", "out", "--overwrite")
        assert code in (0, 1, 2), place


def test_a_history_that_does_not_fit(flowgmo, half, tmp_path):
    """The folder holds something else under our names: refused with the file's name, nothing is lost."""
    (tmp_path / "a.nml").write_text(scene())
    (half / "history.h5").write_bytes(b"something else")
    code, err = flowgmo("run", "a.nml", "--restart", "a.out/restart.h5")
    assert code == 2 and "history.h5" in err and "cannot be continued" in err
    assert (half / "history.h5").read_bytes() == b"something else"
    (half / "history.h5").unlink()
    (half / "vtk" / "case.pvd").write_text("<not xml")
    code, err = flowgmo("run", "a.nml", "--restart", "a.out/restart.h5")
    assert code == 2 and "case.pvd" in err and "cannot be continued" in err
