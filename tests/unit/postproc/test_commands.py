"""flowgmo-postproc: files that show something, and one readable line for what cannot be done."""

import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.image import imread
from PIL import Image

from postproc.cli import main


def call(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def drawn(path, least=0.01):
    """Whether a picture is there and its pixels differ."""
    image = imread(path)[..., :3]
    return image.size > 0 and image.std() > least


@pytest.mark.parametrize(
    "request_",
    [
        ["bodies/ball/position"],
        ["position", "--component", "z"],
        ["position", "velocity", "energy/kinetic", "energy/potential", "collisions/impulse"],
        ["kinetic_energy", "--body", "ball"],
        ["orientation"],
    ],
)
def test_plot(anvil, tmp_path, request_):
    result = call("plot", anvil, *request_, "-o", tmp_path / "a.png")
    assert result.exit_code == 0, result.output
    assert result.output.strip() == str(tmp_path / "a.png") and drawn(tmp_path / "a.png")


def test_plot_of_all_bodies(crowd, tmp_path):
    assert call("plot", crowd, "velocity", "-o", tmp_path / "a.png").exit_code == 0
    assert drawn(tmp_path / "a.png")


def test_list(anvil):
    lines = call("plot", anvil, "--list").output.splitlines()
    assert any(line.split() == ["bodies/ball/velocity", "m/s"] for line in lines)
    assert not any(line.startswith(("deck", "time", "collisions/time")) for line in lines)


@pytest.mark.parametrize("view", ["iso", "y"])
def test_picture(anvil, tmp_path, view):
    done = subprocess.run(
        [sys.executable, "-m", "postproc.cli", "picture", str(anvil), "--time", "0.3", "--view", view]
        + ["--size", "300,200", "-o", str(tmp_path / "p.png")],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(tmp_path / "p.png")
    assert done.stderr in (
        "",
        "notice: VTK cannot draw on this machine; the picture is drawn with matplotlib instead\n",
    )
    assert imread(tmp_path / "p.png").shape[:2] == (200, 300) and drawn(tmp_path / "p.png")


def test_picture_by_speed_of_the_end(crowd, tmp_path):
    result = call("picture", crowd, "--colour", "speed", "--size", "300x200", "-o", tmp_path / "p.png")
    assert result.exit_code == 0 and drawn(tmp_path / "p.png")


def test_picture_without_vtk(anvil, tmp_path, monkeypatch):
    monkeypatch.setattr("postproc.pictures.windows", list)
    result = call("picture", anvil, "--size", "300,200", "-o", tmp_path / "p.png")
    assert result.exit_code == 0 and "drawn with matplotlib instead" in result.output
    assert imread(tmp_path / "p.png").shape[:2] == (200, 300) and drawn(tmp_path / "p.png")


def test_a_window_that_crashes_is_passed_over(anvil, tmp_path, monkeypatch):
    """vtkOSOpenGLRenderWindow ends the process where OSMesa is not installed; one that does not exist is an error."""
    monkeypatch.setattr("postproc.pictures.windows", lambda: ["vtkOSOpenGLRenderWindow", "vtkNoSuchWindow", None])
    result = call("picture", anvil, "--size", "200,200", "-o", tmp_path / "p.png")
    assert result.exit_code == 0 and drawn(tmp_path / "p.png")


@pytest.mark.parametrize("results", ["anvil", "crowd"])
def test_report(results, tmp_path, request):
    result = call("report", request.getfixturevalue(results), "-o", tmp_path / "r.png")
    assert result.exit_code == 0, result.output
    assert result.output.splitlines()[-1] == str(tmp_path / "r.png") and drawn(tmp_path / "r.png", 0.05)


def test_report_without_snapshots_still_has_curves(scenes, tmp_path):
    model = scenes.write_anvil(tmp_path)
    for file in (tmp_path / "vtk").iterdir():
        file.unlink()
    result = call("report", tmp_path)
    assert model and result.exit_code == 0 and "notice: no pictures" in result.output
    assert drawn(tmp_path / "report.png")


def test_a_movie_keeps_white_and_the_colour_of_a_small_ball(anvil, tmp_path):
    """Blue on white in every frame, one palette for all, and the end is shown longer."""
    assert call("movie", anvil, "--frames", 3, "--size", "160,120", "-o", tmp_path / "m.gif").exit_code == 0
    movie = Image.open(tmp_path / "m.gif")
    for k in range(3):
        movie.seek(k)
        pixels = np.asarray(movie.convert("RGB")).reshape(-1, 3).astype(int)
        assert (pixels == 255).all(axis=1).mean() > 0.4
        assert (pixels[:, 2] - pixels[:, 0] > 80).any()
        assert movie.info["duration"] == (1000 if k == 2 else 50)


def test_movie(anvil, tmp_path):
    assert call("movie", anvil, "--frames", 2, "--size", "80,60", "-o", tmp_path / "m.gif").exit_code == 0
    assert (tmp_path / "m.gif").read_bytes()[:6] == b"GIF89a"
    assert call("movie", anvil, "--frames", 2, "--size", "80,60", "-o", tmp_path / "frames").exit_code == 0
    assert len(list((tmp_path / "frames").glob("*.png"))) == 2


@pytest.mark.parametrize(
    "arguments, told",
    [
        (["plot", "{}", "bodies/bal/positon"], "did you mean bodies/ball/position"),
        (["plot", "{}", "kinetik"], "did you mean energy/kinetic"),
        (["plot", "{}", "qqqqqq"], "--list shows"),
        (["plot", "{}", "position", "--body", "bll"], "did you mean ball?"),
        (["plot", "{}", "position", "--component", "w"], "no component w; it has x, y, z"),
        (["plot", "{}"], "which quantity?"),
        (["plot", "{}/none", "x"], "no results folder"),
        (["report", "{}/vtk"], "holds no history.h5"),
        (["picture", "{}/vtk"], "nothing to picture"),
        (["picture", "{}", "--time", "9"], "outside of the run, 0 … 2"),
        (["picture", "{}", "--size", "big"], "two whole numbers"),
        (["movie", "{}", "-o", "m.mp4"], "a movie is a .gif"),
    ],
)
def test_wrong_requests(anvil, arguments, told):
    result = call(*(a.format(anvil) for a in arguments))
    assert result.exit_code == 2
    assert told in result.output and len(result.output.splitlines()) == 1


@pytest.mark.parametrize("command", [["report"], ["plot", "position"], ["picture"], ["movie"]])
def test_damaged_files(scenes, tmp_path, command):
    scenes.write_anvil(tmp_path)
    command = [command[0], tmp_path, *command[1:]]
    whole = (tmp_path / "history.h5").read_bytes()
    for damaged in (b"", b"rubbish", whole[: len(whole) // 2]):
        (tmp_path / "history.h5").write_bytes(damaged)
        result = call(*command)
        assert result.exit_code == 1, result.output
        assert "history.h5 is damaged" in result.output and len(result.output.splitlines()) == 1


def test_damaged_snapshots(scenes, tmp_path):
    scenes.write_anvil(tmp_path)
    (tmp_path / "vtk/bodies_000000.vtp").write_text("<VTKFile")
    result = call("picture", tmp_path)
    assert result.exit_code == 1 and "is damaged" in result.output
    (tmp_path / "vtk/case.pvd").write_text("<VTKFile")
    result = call("picture", tmp_path)
    assert result.exit_code == 1 and "case.pvd is damaged" in result.output


def test_postproc_never_imports_the_solver():
    """Every module of the package, loaded in a fresh process."""
    code = (
        "import sys, pkgutil, importlib, postproc;"
        "[importlib.import_module('postproc.' + m.name) for m in pkgutil.iter_modules(postproc.__path__)];"
        "print([m for m in sys.modules if m.split('.')[0] == 'flowgmo'])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


def test_pixels_of_a_constant_picture_do_not_count(tmp_path):
    from matplotlib.image import imsave

    imsave(tmp_path / "white.png", np.ones((4, 4, 3)))
    assert not drawn(tmp_path / "white.png")
