"""The command `flowgmo`: what each command says and leaves behind when all is well, and its exit codes."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from flowgmo import cli

OURS = {"deck.resolved.nml", "history.h5", "restart.h5", "run.json", "run.log", "vtk"}
BALL = "imo(1)=4, rhomvb(1)=1000., iob(1)=1, rsh(1)=.1,"

ANVIL = """A sphere above an anvil
&xput
 twfin=.6, delt=.01, imobs=1, strngmob=.5,
 gz=-9.81,
 iclid=1,
 thpltd(1)=.05, tpltd(1)=.2,
/
&props units='si' /
&mesh px=-1., 1., nxcelt=4, py=-1., 1., nycelt=4, pz=-1., 1., nzcelt=4 /
&obs
 nobs=2,
 obsid(1)='sphere', imo(1)=4,
 rhomvb(1)=1000., iob(1)=1, rsh(1)=.1, trnz(1)=.5,
 obsid(2)='anvil', iob(2)=2, xl(2)=-.5, xh(2)=.5, yl(2)=-.5, yh(2)=.5, zl(2)=-.5, zh(2)=0.,
/
"""


@pytest.fixture
def flowgmo(monkeypatch, capsys, tmp_path):
    """Runs the command in the test's own folder: exit code, standard output, standard error."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "stdout", sys.stdout)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["flowgmo", *map(str, arguments)])
        code = 0
        try:
            cli.main()
        except SystemExit as end:
            code = end.code
        said = capsys.readouterr()
        assert "Traceback" not in said.out + said.err
        return code, said.out, said.err

    return call


@pytest.fixture
def deck(tmp_path):
    """Writes a deck and returns its path."""

    def write(text=ANVIL, name="case.nml"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write


def datasets(path):
    """Every dataset of a file by name, as bytes."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return {name: (v.tobytes() if isinstance(v, np.ndarray) else v) for name, v in found.items() if name != "deck"}


def free(n_bodies, xput="", obs=""):
    """A deck of bodies that nothing hits."""
    return (
        f"t\n&xput\n twfin=1., delt=.1, imobs=1, {xput}\n/\n&mesh px=-9., 9., py=-9., 9., pz=-9., 9., /\n"
        f"&obs\n nobs={n_bodies},\n {obs}\n/\n"
    )


# ---- run


def test_run(flowgmo, deck, tmp_path):
    """Exit 0, everything that the contract names is there, and nothing besides."""
    deck()
    code, out, err = flowgmo("run", "case.nml")
    assert (code, err) == (0, "") and "done: twfin is reached" in out
    folder = tmp_path / "case.out"
    assert {p.name for p in folder.iterdir()} == OURS
    assert {p.name for p in tmp_path.iterdir()} == {"case.nml", "case.out"}
    summary = json.loads((folder / "run.json").read_text())
    assert summary["status"] == "done" and summary["t"] == 0.6 and summary["command_line"] == "flowgmo run case.nml"
    log = (folder / "run.log").read_text()
    assert "done: twfin is reached" in log and "\x1b" not in log
    with h5py.File(folder / "history.h5") as file:
        assert file["time"][:] == pytest.approx(np.arange(13) * 0.05)
        assert list(file["bodies"]) == ["sphere"] and len(file["collisions/time"]) > 0
    assert len(list((folder / "vtk").glob("bodies_*.vtp"))) > 3 and (folder / "vtk" / "case.pvd").is_file()


def test_existing_folder_is_kept(flowgmo, deck, tmp_path):
    deck()
    kept = tmp_path / "case.out" / "mine.txt"
    kept.parent.mkdir()
    kept.write_text("mine")
    code, out, err = flowgmo("run", "case.nml")
    assert code == 2 and "case.out exists and is kept" in err and "--overwrite" in err and "-o DIR" in err
    assert [p.name for p in kept.parent.iterdir()] == ["mine.txt"] and "done" not in out


def test_an_empty_folder_is_used(flowgmo, deck, tmp_path):
    deck()
    (tmp_path / "case.out").mkdir()
    assert flowgmo("run", "case.nml")[0] == 0


def test_overwrite_replaces_our_files_only(flowgmo, deck, tmp_path):
    """All results are new, what the user put there stays, no old picture survives."""
    deck()
    folder = tmp_path / "case.out"
    (folder / "vtk").mkdir(parents=True)
    for name in ("mine.txt", "run.log", "history.h5", "fields.h5", "restart.h5", "vtk/bodies_000999.vtp"):
        (folder / name).write_text("old")
    code, _, err = flowgmo("run", "case.nml", "--overwrite")
    assert (code, err) == (0, "")
    assert {p.name for p in folder.iterdir()} == OURS | {"mine.txt"} and (folder / "mine.txt").read_text() == "old"
    assert not (folder / "vtk" / "bodies_000999.vtp").exists() and "old" not in (folder / "run.log").read_text()


def test_a_wrong_deck_does_not_cost_the_old_results(flowgmo, deck, tmp_path):
    """--overwrite deletes only when there is something to compute."""
    path = deck()
    assert flowgmo("run", "case.nml")[0] == 0
    before = {p.name: p.stat().st_mtime_ns for p in (tmp_path / "case.out").iterdir()}
    path.write_text(ANVIL.replace("imo(1)=4", "imo(1)=7"))
    assert flowgmo("run", "case.nml", "--overwrite")[0] == 2
    assert {p.name: p.stat().st_mtime_ns for p in (tmp_path / "case.out").iterdir()} == before


def test_nested_output_folder_and_spaces(flowgmo, deck, tmp_path):
    deck(name="my decks/first case.nml")
    assert flowgmo("run", "my decks/first case.nml", "-o", "a/b c/d")[0] == 0
    assert {p.name for p in (tmp_path / "a" / "b c" / "d").iterdir()} == OURS
    assert flowgmo("run", "my decks/first case.nml")[0] == 0
    assert (tmp_path / "my decks" / "first case.out" / "run.json").is_file()


def test_files_beside_the_deck(flowgmo, deck, tmp_path):
    """STL and table are found from the deck's folder, whatever the current one; the resolved deck finds them too."""
    tetra = [[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    lines = ["solid t"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {' '.join(map(str, tetra[k]))}" for k in face)]
        lines += ["endloop", "endfacet"]
    (tmp_path / "cases" / "parts").mkdir(parents=True)
    (tmp_path / "cases" / "parts" / "tetra.stl").write_text("\n".join([*lines, "endsolid t", ""]))
    (tmp_path / "cases" / "drive.csv").write_text("# t, u\n0., 0.\n1., 2.\n")
    obs = "imo(1)=3, rhomvb(1)=1., iob(1)=1, igen(1)=3, fstl(1)='parts/tetra.stl', futobs(1)='drive.csv', iutobsc(1)=2"
    deck(free(1, obs=obs), "cases/driven.nml")
    code, _, err = flowgmo("run", "cases/driven.nml", "-o", "elsewhere/out")
    assert (code, err) == (0, "")
    with h5py.File(tmp_path / "elsewhere" / "out" / "history.h5") as file:
        x = file["bodies/obs1/position"][:, 0]
        assert x[-1] - x[0] == pytest.approx(1.0, rel=1e-12)  # integral of 2 t
    code, _, err = flowgmo("run", "elsewhere/out/deck.resolved.nml", "-o", "again")
    assert (code, err) == (0, "")
    assert datasets("again/history.h5") == datasets("elsewhere/out/history.h5")


def test_resolved_deck_gives_the_same_results(flowgmo, deck):
    """Bit for bit: nothing that acts is missing in the resolved deck, no number loses digits."""
    deck(ANVIL.replace("strngmob=.5", "strngmob=.7, frcmob=.1").replace("rsh(1)=.1,", "rsh(1)=.1, utobs(1,1)=.3,"))
    assert flowgmo("run", "case.nml")[0] == 0
    assert flowgmo("run", "case.out/deck.resolved.nml", "-o", "again")[0] == 0
    assert datasets("again/history.h5") == datasets("case.out/history.h5")


def test_no_bodies(flowgmo, deck, tmp_path):
    """NOBS=0 and no block &obs: runs to the end, with a history of times, a restart file and a summary."""
    for name, text in (("none", free(0)), ("no_block", "t\n&xput twfin=1. /\n&mesh /\n")):
        deck(text, f"{name}.nml")
        code, out, err = flowgmo("run", f"{name}.nml")
        assert (code, err) == (0, "") and "done: twfin is reached" in out
        folder = tmp_path / f"{name}.out"
        with h5py.File(folder / "history.h5") as file:
            assert file["time"][-1] == 1.0 and list(file["bodies"]) == [] and file["collisions/time"].shape == (0,)
        assert json.loads((folder / "run.json").read_text())["status"] == "done"
        assert flowgmo("check", f"{name}.nml")[0] == 0


def test_no_moving_body(flowgmo, deck, tmp_path):
    """A stationary body alone: pictures, no body in the history."""
    deck(free(1, obs="iob(1)=1, rsh(1)=.1"))
    code, _, err = flowgmo("run", "case.nml")
    assert (code, err) == (0, "")
    assert list((tmp_path / "case.out" / "vtk").glob("bodies_*.vtp"))
    with h5py.File(tmp_path / "case.out" / "history.h5") as file:
        assert list(file["bodies"]) == []


def test_many_bodies(flowgmo, deck, tmp_path):
    """500, the most a deck may have; every one has its rows."""
    one = "imo({0})=4, rhomvb({0})=1., iob({0})={0}, rsh({0})=.05, trnx({0})={1}, trny({0})={2},\n"
    places = [one.format(m, m % 25 * 0.3, m // 25 * 0.3) for m in range(1, 501)]
    deck(free(500, xput="iclid=1, tapltd(1)=1., thpltd(1)=.1,", obs="".join(places)))
    code, _, err = flowgmo("run", "case.nml")
    assert (code, err) == (0, "")
    with h5py.File(tmp_path / "case.out" / "history.h5") as file:
        assert len(file["bodies"]) == 500
    code, out, _ = flowgmo("check", "case.nml")
    assert code == 0 and "and 460 more" in out


@pytest.mark.parametrize(
    "xput", ["twfin=1e30, itwfin=3", "twfin=1e300, itwfin=3, thpltd(1)=.1", "twfin=1e9, itwfin=3, tapltd(1)=1e-3"]
)
def test_last_step(flowgmo, deck, tmp_path, xput):
    """ITWFIN ends a run long before TWFIN; output times that it cannot reach cost nothing."""
    deck(free(1, obs=BALL + " utobs(1,1)=1.").replace("twfin=1.,", f"{xput},"))
    code, out, err = flowgmo("run", "case.nml")
    assert (code, err) == (0, "") and "itwfin=3 steps are done" in out
    assert json.loads((tmp_path / "case.out" / "run.json").read_text())["t"] == pytest.approx(0.3)


def test_no_step_at_all(flowgmo, deck, tmp_path):
    deck(free(1, xput="itwfin=0,", obs=BALL))
    assert flowgmo("run", "case.nml")[0] == 0
    assert json.loads((tmp_path / "case.out" / "run.json").read_text())["steps"] == 0


def test_long_and_foreign_titles_and_names(flowgmo, deck, tmp_path):
    """Title of 200 000 signs with brackets (rich markup) and any script; a name of 1000 letters."""
    title = "[bold]Kügelchen ☃ 球[/bold] [/] " + "x" * 200_000
    deck(free(1, obs=f"{BALL} obsid(1)='{'n' * 1000}'").replace("t\n", title + "\n", 1), "größe 球.nml")
    code, out, err = flowgmo("run", "größe 球.nml")
    assert (code, err) == (0, "") and "[bold]Kügelchen ☃ 球[/bold]" in out
    with h5py.File(tmp_path / "größe 球.out" / "history.h5") as file:
        assert file.attrs["title"].startswith("[bold]Kügelchen ☃ 球") and list(file["bodies"]) == ["n" * 1000]
    assert flowgmo("check", "größe 球.nml")[0] == 0


def test_names_that_could_be_mistaken(flowgmo, deck, tmp_path):
    """For a dataset, a path, a number, a partner of collisions: all stand in the history as they are."""
    names = ["time", "..a", "-1", "a.b.c", "limit"]
    bodies = [BALL.replace("(1)", f"({m})").replace("=1, rsh", f"={m}, rsh") for m in range(1, 6)]
    deck(
        free(5, obs="\n".join(f"{b} obsid({m})='{n}'," for m, (b, n) in enumerate(zip(bodies, names, strict=True), 1)))
    )
    assert flowgmo("run", "case.nml")[0] == 0
    with h5py.File(tmp_path / "case.out" / "history.h5") as file:
        assert set(file["bodies"]) == set(names)


# ---- check, explain, help


def test_check(flowgmo, deck, tmp_path):
    """Effects with their deck lines, bodies with mass and inertia, cells, memory; nothing is written."""
    deck()
    code, out, err = flowgmo("check", "case.nml")
    assert (code, err) == (0, "")
    for words in (
        ["gravity", "line 4: gz=-9.81"],
        ["motion", "line 12: imo(1)=4"],
        ["collisions", "line 5: iclid=1"],
        ["sphere", "coupled", "six degrees", "4.18879", "0.0167552  0.0167552  0.0167552"],
        ["anvil", "solid"],
        ["64 cells", "60 steps", "12 history rows", "KiB beside the program"],
        ["gravity (0, 0, -9.81) m/s^2"],
        ["end at t = 0.6 s"],
    ):
        assert any(all(word in line for word in words) for line in out.splitlines()), words
    assert [p.name for p in tmp_path.iterdir()] == ["case.nml"]


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        ("ivmcal(1)=0, iomxcal(1)=0, iomycal(1)=0,", "six degrees, x, z, turn z free"),
        ("imoaxs(1)=4, iomxcal(1)=0,", "fixed point, turn y, turn z free"),
        ("imoaxs(1)=3,", "fixed axis  "),
    ],
)
def test_check_says_what_is_left_to_the_loads(flowgmo, deck, monkeypatch, flags, said):
    monkeypatch.setenv("COLUMNS", "120")
    deck(ANVIL.replace("imo(1)=4,", f"imo(1)=4, {flags}"))
    code, out, err = flowgmo("check", "case.nml")
    assert code == 0 and said in next(line for line in out.splitlines() if "coupled" in line)


def test_check_says_notices(flowgmo, deck):
    deck(ANVIL.replace("iclid=1", "iclid=0").replace("imo(1)=4,", "imo(1)=4, crstrng(1)=.3,"))
    code, out, _ = flowgmo("check", "case.nml")
    assert code == 0 and "crstrng(1)=0.3: iclid=0 switches all collisions off" in out.replace("\n", " ")


def test_check_loads_no_kernels_and_no_pictures(deck):
    """A question of start-up time: numba alone takes a second to load."""
    program = (
        "import sys; from flowgmo.cli import main; sys.argv = ['flowgmo', 'check', sys.argv[1]]; main(); "
        "heavy = {'numba', 'pyvista', 'vtk', 'vtkmodules', 'h5py', 'matplotlib', 'llvmlite'}; "
        "sys.exit(f'loaded {heavy & set(sys.modules)}' if heavy & set(sys.modules) else 0)"
    )
    done = subprocess.run([sys.executable, "-c", program, deck()], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_explain(flowgmo):
    code, out, err = flowgmo("explain", "crstrng")
    assert (code, err) == (0, "") and "crstrng(m)" in out and "&obs" in out and "0 .. 1" in out
    assert flowgmo("explain", "CrStrng(3)")[1] == out


def test_explain_all(flowgmo):
    code, out, _ = flowgmo("explain")
    assert code == 0 and all(word in out for word in ("&xput", "&mesh", "&obs", "&flowgmo", "twfin", "iclidob"))
    assert max(map(len, out.splitlines())) <= 80


def test_explain_unknown(flowgmo):
    code, out, err = flowgmo("explain", "crstrg")
    assert (code, out) == (2, "") and "there is no variable crstrg. Near it: crstrng" in err
    code, _, err = flowgmo("explain", "qqqqqq")
    assert code == 2 and "there is no variable qqqqqq. flowgmo explain lists all" in err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["run"], "DECK"),
        (["run", "a.nml", "b.nml"], "b.nml"),
        (["run", "a.nml", "--threads", "0"], "--threads"),
        (["run", "a.nml", "--threads", "two"], "--threads"),
        (["run", "a.nml", "--overwrit"], "--overwrite"),
        (["rnu", "a.nml"], "rnu"),
        (["--nonsense"], "--nonsense"),
        (["check"], "DECK"),
        (["explain", "a", "b"], "b"),
    ],
)
def test_wrong_command_lines(flowgmo, arguments, says):
    code, out, err = flowgmo(*arguments)
    assert (code, out) == (2, "") and says in err


def test_help_and_version(flowgmo):
    assert flowgmo("--version")[:2] == (0, f"flowgmo, version {cli.flowgmo.__version__}\n")
    for arguments in (["-h"], ["run", "--help"], ["check", "-h"]):
        code, out, err = flowgmo(*arguments)
        assert (code, err) == (0, "") and "Usage:" in out


def test_threads_do_not_matter(flowgmo, deck, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", os.environ.get("NUMBA_NUM_THREADS", "2"))
    deck()
    assert flowgmo("run", "case.nml", "-o", "one", "--threads", "1")[0] == 0
    assert flowgmo("run", "case.nml", "-o", "two", "--threads", "2")[0] == 0
    assert datasets("one/history.h5") == datasets("two/history.h5")


# ---- the program as others see it


def program(*arguments, **more):
    command = [sys.executable, "-m", "flowgmo.cli", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **more)


def test_a_reader_that_leaves(deck, tmp_path):
    """`flowgmo run deck | head -1`: the run goes on to its end. `check` and `explain` end without words."""
    path = deck()
    for command in ("run", "check", "explain"):
        arguments = "" if command == "explain" else f"'{path}'"
        line = f"'{sys.executable}' -m flowgmo.cli {command} {arguments} 2>'{tmp_path}/err' | true"
        subprocess.run(["bash", "-c", line], check=True, timeout=120)
        assert (tmp_path / "err").read_text() == "", command
    assert json.loads((tmp_path / "case.out" / "run.json").read_text())["status"] == "done"


def test_a_terminal_without_unicode(deck, tmp_path):
    """Signs that cannot be shown become question marks; run.log keeps them."""
    path = deck(ANVIL.replace("A sphere", "Eine Kügel ☃"))
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    for command in ("check", "run"):
        done = program(command, path, env=environment)
        assert (done.returncode, done.stderr) == (0, "") and "Eine K?gel ?" in done.stdout
    assert "Eine Kügel ☃" in (tmp_path / "case.out" / "run.log").read_text(encoding="utf-8")


def test_console_script(deck):
    script = shutil.which("flowgmo", path=str(Path(sys.executable).parent))
    done = subprocess.run([script, "check", deck()], capture_output=True, text=True)
    assert done.returncode == 0 and "sphere" in done.stdout
