"""Bad input and bad luck: wrong decks and files, full disks, failing physics, kills.

Each ends in a text that says what is wrong, where, and what to write, in the right exit code, and leaves no half of a
result: 0 done, 1 the run failed, 2 the deck or the command line is wrong or the folder exists, 130 interrupted.
"""

import errno
import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from flowgmo import cli

BODY = "imo(1)=4, rhomvb(1)=1000., iob(1)=1, rsh(1)=.1"
GOOD = """A ball above a floor
&xput
 twfin=.3, delt=.01, gz=-9.81, imobs=1, strngmob=.5,
 iclid=1, tpltd(1)=.1,
/
&bcdata ibct(5)=2 /
&mesh px=-1., 1., py=-1., 1., pz=-1., 1., /
&obs
 nobs=1,
 imo(1)=4, rhomvb(1)=1000., iob(1)=1, rsh(1)=.1,
/
"""


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


def left(folder):
    """Names of all files and folders below a folder."""
    return sorted(str(p.relative_to(folder)) for p in Path(folder).rglob("*"))


def deck(obs=BODY, xput="", bcdata="ibct(5)=2", mesh="px=-1., 1., py=-1., 1., pz=-1., 1.,", more="", count=1):
    obs = obs.replace(", ", ",\n ")
    return (
        f"t\n&xput\n twfin=.3, delt=.01, imobs=1, iclid=1,\n {xput}\n/\n&bcdata {bcdata} /\n&mesh {mesh} /\n"
        f"&obs nobs={count},\n {obs}\n/\n{more}"
    )


# ---- files that are no decks


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "the file is empty"),
        (b" \n\n", "the file is empty"),
        (bytes(range(256)) * 20, "this is not a text file"),
        (b"\x89HDF\r\n\x1a\n" + b"\0" * 4000, "this is not a text file"),
        (GOOD.encode("utf-16"), "this is not a text file"),
        (b"only a title\n", "there is no block in the file"),
        (b"solid x\nendsolid x\n" * 100, "there is no block in the file"),
        (b"t\n&xput\n", "&xput"),
    ],
)
def test_no_deck(flowgmo, tmp_path, command, content, says):
    (tmp_path / "bad.nml").write_bytes(content)
    code, err = flowgmo(command, "bad.nml")
    assert code == 2 and "bad.nml" in err and says in err and "nothing was computed" in err
    assert left(tmp_path) == ["bad.nml"]


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize("path", ["nowhere.nml", "no/where/x.nml", ".", "..", "/", "", "x" * 5000, "/dev/null"])
def test_no_file(flowgmo, tmp_path, command, path):
    code, err = flowgmo(command, path)
    assert code == 2 and err.strip() and left(tmp_path) == []


def test_a_missing_file_names_its_neighbours(flowgmo, tmp_path):
    (tmp_path / "anvil.nml").write_text(GOOD)
    code, err = flowgmo("run", "anvli.nml")
    assert code == 2 and "anvli.nml: there is no such file" in err and "anvil.nml" in err


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read and write everything")
def test_no_permission(flowgmo, tmp_path):
    path = tmp_path / "a.nml"
    path.write_text(GOOD)
    path.chmod(0)
    code, err = flowgmo("run", path)
    assert code == 2 and "no permission to read" in err


@pytest.mark.parametrize("refused", ["read_bytes", "stat"])
def test_no_permission_for_anyone(flowgmo, tmp_path, monkeypatch, refused):
    """The same for a test that runs as root."""
    (tmp_path / "a.nml").write_text(GOOD)

    def refuse(self, *rest, **more):
        raise PermissionError(errno.EACCES, "Permission denied", str(self))

    with monkeypatch.context() as patch:
        patch.setattr(Path, refused, refuse)
        code, err = flowgmo("run", "a.nml")
    assert code == 2 and "a.nml: there is no permission to read the file" in err


# ---- decks that say something wrong: (lines, what the text names)

WRONG = {
    "unknown variable": (deck(f"{BODY}, rhomv(2)=1."), ["bad.nml:", "&obs", "rhomv", "Did you mean rhomvb?"]),
    "wrong block": (deck(xput="imo(1)=4"), ["bad.nml:4: &xput", "imo", "Move it to &obs"]),
    "unknown block": (deck(more="&obz a=1 /\n"), ["bad.nml:14: &obz", "Write &obs"]),
    "wrong type": (deck(xput="gz='down'"), ["bad.nml:4: &xput gz", "is not a number"]),
    "not whole": (deck(BODY.replace("imo(1)=4", "imo(1)=4.5")), ["bad.nml:9: &obs imo(1)", "whole number"]),
    "out of range": (deck(f"{BODY}, crstrng(1)=1.5"), ["bad.nml:13: &obs crstrng(1)=1.5", "must be in 0 .. 1"]),
    "nan": (deck(xput="gz=nan"), ["bad.nml:4: &xput gz", "finite"]),
    "index beyond": (deck(f"{BODY}, imo(501)=4"), ["bad.nml:13: &obs imo(501)", "is not in 1 .. 500"]),
    "component beyond": (deck(f"{BODY}, imo(7)=4"), ["bad.nml:13: &obs imo(7)=4", "nobs=1", "Write nobs=7"]),
    "set twice": (deck(f"{BODY}, rhomvb(1)=2."), ["bad.nml:13: &obs rhomvb(1)", "line 10"]),
    "limits crossed": (deck(f"{BODY}, xl(1)=.1, xh(1)=-.1"), ["bad.nml:13: &obs xl(1)=0.1", "xh(1)"]),
    "mesh backwards": (deck(mesh="px=1., 0.,"), ["bad.nml:7: &mesh px(2)=0.0", "Let px increase"]),
    "step and end": (deck(xput="dtmin=.5"), ["bad.nml:4: &xput dtmin=0.5", "delt=0.01"]),
    "no mass": (deck("imo(1)=4, iob(1)=1, rsh(1)=.1"), ["bad.nml:8: &obs rhomvb(1)", "no density"]),
    "two masses": (deck(f"{BODY}, massmvb(1)=2."), ["bad.nml:13: &obs massmvb(1)=2.0", "both a mass and a density"]),
    "no shape": (
        deck("imo(1)=4, rhomvb(1)=1."),
        ["bad.nml:8: &obs obsid(1)", "no solid subcomponent", "Write iob(n)=1"],
    ),
    "liquid": (
        deck(xput="igmres=0,", more="&props rhof=1000. /\n"),
        ["bad.nml:4: &xput igmres=0", "relaxation of the pressure with bodies", "Write igmres=1"],
    ),
    "liquid without density": (deck(more="&fl flht=.5 /\n"), ["bad.nml:14: &fl flht=0.5", "rhof"]),
    "not computed": (deck(xput="ifvis=4"), ["bad.nml:4: &xput ifvis=4", "not computed", "Write ifvis=0"]),
    "imo without imobs": (
        deck().replace("imobs=1, iclid=1,", ""),
        ["bad.nml:9: &obs imo(1)=4", "imobs=1"],
    ),
    "iclid without imobs": (deck().replace("imobs=1,", ""), ["bad.nml:3: &xput iclid=1", "Write imobs=1"]),
    "component left out": (
        deck(f"{BODY}, ifcompenabled(1)=0"),
        ["bad.nml:13: &obs ifcompenabled(1)=0", "not computed"],
    ),
    "no such stl": (deck(f"{BODY}, igen(1)=3, fstl(1)='no.stl'"), ["&obs fstl(1)='no.stl'", "there is no file no.stl"]),
    "names": (deck(f"{BODY}, obsid(1)='a/b'"), ["bad.nml:13: &obs obsid(1)='a/b'", "Write obsid(1)='a_b'"]),
    "too many rows": (deck(xput="thpltd(1)=1e-15"), ["bad.nml:4: &xput thpltd(1)=1e-15", "Write thpltd(1)=0.0003"]),
    "too many cells": (deck(mesh="nxcelt=2000000000,"), ["bad.nml:7: &mesh nxcelt=2000000000", "cells"]),
    "overlap": (
        deck(f"{BODY}, imo(2)=4, rhomvb(2)=1., iob(2)=2, rsh(2)=.1, trnx(2)=.15", count=2),
        ["bad.nml:13: &obs imo(2)=4", "obs1 and obs2 overlap at the start by 0.05", "iclidob(1,2)=0"],
    ),
    "outside": (deck(f"{BODY}, trnz(1)=-3."), ["bad.nml:9: &obs imo(1)=4", "obs1 starts outside", "Zmin"]),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_deck(flowgmo, tmp_path, name):
    """`run` and `check` say the same, with file, line, variable, and what to write; nothing is left behind."""
    text, says = WRONG[name]
    (tmp_path / "bad.nml").write_text(text)
    code, err = flowgmo("run", "bad.nml")
    assert code == 2 and all(word in err for word in says), err
    assert "nothing was computed" in err and left(tmp_path) == ["bad.nml"]
    assert flowgmo("check", "bad.nml") == (code, err)


def test_pair_flags_without_their_switch(flowgmo, tmp_path):
    """Not an error: the deck says something that has no effect, and the user is told where."""
    text = deck(f"{BODY}, iclidob(1,1)=1").replace("iclid=1", "iclid=0")
    (tmp_path / "a.nml").write_text(text)
    assert flowgmo("run", "a.nml")[0] == 0
    log = " ".join((tmp_path / "a.out" / "run.log").read_text().split())
    assert "a.nml:13: &obs iclidob(1,1)=1: iclid=0 switches all collisions off" in log


def test_all_problems_at_once(flowgmo, tmp_path):
    (tmp_path / "bad.nml").write_text(deck(f"{BODY}, crstrng(1)=2., cfrc(1)=-1.", xput="gz=abc"))
    code, err = flowgmo("run", "bad.nml")
    assert code == 2 and "3 problems, nothing was computed" in err
    assert [line.split(":")[1] for line in err.splitlines()[:3]] == ["4", "13", "14"]


# ---- folders that cannot be used


def test_the_folder_is_a_file(flowgmo, tmp_path):
    (tmp_path / "a.nml").write_text(GOOD)
    (tmp_path / "a.out").write_text("mine")
    code, err = flowgmo("run", "a.nml", "--overwrite")
    assert code == 2 and "a.out is a file, not a folder" in err and (tmp_path / "a.out").read_text() == "mine"
    code, err = flowgmo("run", "a.nml", "-o", "a.out/deeper")
    assert code == 2 and "a.out" in err and "cannot be written" in err


@pytest.mark.parametrize("folder", ["/proc/nowhere", "x" * 300])
def test_a_folder_that_cannot_be_made(flowgmo, tmp_path, folder):
    (tmp_path / "a.nml").write_text(GOOD)
    code, err = flowgmo("run", "a.nml", "-o", folder)
    assert code == 2 and "cannot be written" in err and left(tmp_path) == ["a.nml"]


def test_a_read_only_folder(flowgmo, tmp_path, monkeypatch):
    """Also as root, whom permissions do not stop: the probe file is refused."""
    (tmp_path / "a.nml").write_text(GOOD)
    write_bytes = Path.write_bytes

    def refuse(self, data):
        if self.name == ".writable":
            raise PermissionError(errno.EACCES, "Permission denied", str(self))
        return write_bytes(self, data)

    monkeypatch.setattr(Path, "write_bytes", refuse)
    code, err = flowgmo("run", "a.nml")
    assert code == 2 and "a.out cannot be written: Permission denied" in err


# ---- a disk that fills up


def full(*_, **__):
    raise OSError(errno.ENOSPC, "No space left on device")


def after(count, real):
    """Works `count` times, then the disk is full."""
    calls = iter(range(count))

    def write(*arguments, **more):
        return real(*arguments, **more) if next(calls, None) is not None else full()

    return write


def readable(folder):
    """What stands in history.h5 and restart.h5 after a failure: times, and the state's time (None without)."""
    with h5py.File(folder / "history.h5") as file:
        times = file["time"][:]
    if not (folder / "restart.h5").exists():
        return times, None
    with h5py.File(folder / "restart.h5") as file:
        return times, float(file["state/t"][()])


@pytest.mark.parametrize("what", ["history", "restart", "pictures", "log"])
def test_a_full_disk(flowgmo, tmp_path, monkeypatch, what):
    """Exit 1 with the file and the reason; the restart file of the last good landing is there and can be used."""
    from flowgmo.output import log, restart, vtk_files

    def told(self, *_):
        with log.writing(self.path):
            no_more()

    (tmp_path / "a.nml").write_text(GOOD)
    no_more = after(20, int)
    where, name, now = {
        "history": (os, "posix_fallocate", after(2, os.posix_fallocate)),
        "restart": (restart, "_identity", after(2, restart._identity)),
        "pictures": (vtk_files, "encoded", after(40, vtk_files.encoded)),
        "log": (log.RunLog, "progress", told),
    }[what]
    with monkeypatch.context() as patch:
        patch.setattr(where, name, now)
        code, err = flowgmo("run", "a.nml")
    assert code == 1 and "No space left on device" in err and "cannot write a.out" in err
    folder = tmp_path / "a.out"
    times, t = readable(folder)
    assert (np.diff(times) > 0).all() and not list(folder.rglob(".*part*"))
    summary = json.loads((folder / "run.json").read_text())
    assert summary["status"] == "failed" and "No space left on device" in summary["reason"]
    assert t is not None and 0.0 < t < 0.3
    assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5")[0] == 0
    assert readable(folder)[1] == 0.3


@pytest.mark.parametrize("size", [200, 20_000, 200_000, 640_000])
def test_no_file_may_grow(tmp_path, size):
    """The system itself refuses to write (a limit on the size of files): exit 1, a reason, no traceback."""
    (tmp_path / "a.nml").write_text(GOOD)
    done = subprocess.run(
        [sys.executable, "-m", "flowgmo.cli", "run", "a.nml"],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    assert "flowgmo: cannot write" in done.stderr and "unforeseen" not in done.stderr
    assert "Traceback" not in done.stdout + done.stderr, done.stderr
    assert not list(tmp_path.rglob(".*part*"))


# ---- runs that fail


def test_a_run_that_fails(flowgmo, tmp_path):
    """A fall beyond all numbers: exit 1, the reason in all three places, restart.h5 = last good state."""
    text = deck(xput="gz=-1e308", bcdata="ibct(5)=3").replace("twfin=.3", "twfin=5.")
    (tmp_path / "a.nml").write_text(text)
    code, err = flowgmo("run", "a.nml")
    assert code == 1
    folder = tmp_path / "a.out"
    summary = json.loads((folder / "run.json").read_text())
    assert summary["status"] == "failed" and "range of numbers" in summary["reason"]
    assert "range of numbers" in " ".join((folder / "run.log").read_text().split())
    times, t = readable(folder)
    assert 0.0 < t < 5.0 and t == summary["t"] and times[-1] <= t
    with h5py.File(folder / "restart.h5") as file:
        assert np.isfinite(file["state/p_WB"][:]).all()
    code, err = flowgmo("run", "a.nml", "--restart", "a.out/restart.h5")
    assert code == 1  # fails at the same place, in the same words
    again = json.loads((folder / "run.json").read_text())
    assert again["reason"] == summary["reason"] and again["t"] == t


def test_balls_that_pile_up(flowgmo, tmp_path):
    """One ball comes to rest on another: the run goes on to its end, from a restart as well, and they stay."""
    second = "imo(2)=4, rhomvb(2)=1000., iob(2)=2, rsh(2)=.1, trnz(2)=-.6"
    text = deck(
        f"{BODY.replace('rsh(1)=.1', 'rsh(1)=.1, trnz(1)=-.9')}, {second}", xput="gz=-9.81, strngmob=.3", count=2
    )
    (tmp_path / "a.nml").write_text(text.replace("twfin=.3", "twfin=2."))
    assert flowgmo("run", "a.nml") == (0, "")
    (tmp_path / "a.nml").write_text(text.replace("twfin=.3", "twfin=3."))
    assert flowgmo("run", "a.nml", "--restart", "a.out/restart.h5") == (0, "")
    with h5py.File(tmp_path / "a.out" / "history.h5") as file:
        z = np.stack([file[f"bodies/obs{k}/position"][:, 2] for k in (1, 2)])
        assert file["time"][-1] == 3.0
    np.testing.assert_allclose(z[:, -1], [-0.9, -0.7], atol=1e-6)


def test_an_unforeseen_error_leaves_readable_files(flowgmo, tmp_path, monkeypatch, capsys):
    """A mistake of the program: one line, exit 1, no traceback without FLOWGMO_DEBUG, files closed."""
    from flowgmo import step

    def mistaken(*_):
        raise IndexError("list index out of range")

    (tmp_path / "a.nml").write_text(GOOD)
    monkeypatch.setattr(step, "step", mistaken)
    monkeypatch.setattr(sys, "argv", ["flowgmo", "run", "a.nml"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    err = capsys.readouterr().err
    assert end.value.code == 1 and "unforeseen error, please report it: IndexError" in err and "Traceback" not in err
    assert readable(tmp_path / "a.out")[0].tolist() == [0.0]


def test_not_enough_memory(flowgmo, tmp_path, monkeypatch):
    from flowgmo import step

    def too_much(*_):
        raise MemoryError

    (tmp_path / "a.nml").write_text(GOOD)
    monkeypatch.setattr(step, "prepare", too_much)
    code, err = flowgmo("run", "a.nml")
    assert code == 1 and "memory is not enough" in err
