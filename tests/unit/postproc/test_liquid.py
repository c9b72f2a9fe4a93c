"""A run with a liquid: its surface in pictures, slices, the panels of a report."""

import importlib.util
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.image import imread

from postproc.cli import main
from postproc.errors import WrongRequest
from postproc.liquid_panels import liquid_panels
from postproc.palette import WATER
from postproc.results import Results
from postproc.scene import Scene
from postproc.sight import frame_of
from postproc.slices import Fields, draw_slice


def call(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def blue(image):
    """Share of the pixels that are bluer than red by far."""
    return float((image[..., 2] - image[..., 0] > 0.15).mean())


def test_the_scene_has_bodies_and_the_nearest_surface(tank):
    scene = Scene(Results(tank))
    assert scene.has_liquid and [s.name for s in scene.at(0.3)] == ["rock"] and scene.moving == []
    assert scene.shown_time(0.3) == 0.25
    points, faces = scene.liquid(0.3)
    assert faces.max() < len(points) and np.abs(points[:, 2] - 0.4).max() < 0.13
    assert np.array_equal(frame_of(scene).bounds, scene.results.domain), "water goes everywhere"
    assert scene.results.bodies == {}, "a body with a load only does not move"


@pytest.mark.parametrize("simply", [False, True])
def test_the_picture_shows_the_surface(tank, tmp_path, simply, monkeypatch):
    if simply:
        monkeypatch.setattr("postproc.pictures.windows", list)
    result = call("picture", tank, "--time", "0.3", "--size", "400,300", "-o", tmp_path / "p.png")
    assert result.exit_code == 0, result.output
    assert blue(imread(tmp_path / "p.png")) > 0.05  # measured 0.15, and 0.09 drawn simply


def test_a_liquid_without_bodies_is_drawn(scenes, tmp_path):
    path = Path(__file__).parents[1] / "output" / "wet_scenes.py"
    spec = importlib.util.spec_from_file_location("wet_scenes_here", path)
    wet = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(wet)
    folder = tmp_path / "r"
    wet.write_tank(scenes, folder, n=(12, 1, 8), rock=False, snapshots=2)
    assert call("picture", folder, "--size", "300,200", "-o", tmp_path / "p.png").exit_code == 0
    assert blue(imread(tmp_path / "p.png")) > 0.001  # seen from its edge
    result = call("report", folder, "-o", tmp_path / "r.png")
    assert result.exit_code == 0, result.output
    assert call("slice", folder, "-o", tmp_path / "s.png").exit_code == 0, "no solids: no V"


def test_a_slice_holds_the_cells_of_its_plane(tank):
    fields = Fields(tank)
    with h5py.File(tank / "fields.h5", locking=False) as file:
        cut = fields.cut(2, 1, 0.41)
        j = int(np.searchsorted(file["y"][()], 0.41)) - 1
        assert cut.names == "xz" and np.array_equal(cut.p, file["000002/p"][:, j])
        assert np.allclose(cut.speed, np.linalg.norm(file["000002/velocity"][:, j], axis=-1))
        assert (cut.V == 0).sum() > 10 and len(cut.planes[0]) == cut.p.shape[0] + 1
        assert np.array_equal(fields.cut(0, 2, 0.8).F, file["000000/F"][:, :, -1]), "the last plane has the last cell"


def test_a_slice_is_drawn(tank, tmp_path):
    for more in ([], ["--axis", "x", "--at", "0.8"], ["--axis", "z", "--at", "0.2", "--time", "0.5"]):
        result = call("slice", tank, *more, "-o", tmp_path / "s.png")
        assert result.exit_code == 0, result.output
        image = imread(tmp_path / "s.png")
        assert blue(image) > 0.03 and WATER.startswith("#")


def test_a_slice_shows_solids_as_they_are_and_without_surfaces_as_cells(tank, tmp_path):
    """The rock ends amid cells: more grey with its outline than with the cells that are all solid."""
    bare = tmp_path / "bare"
    bare.mkdir()
    shutil.copy(tank / "fields.h5", bare)
    shares = []
    for folder in (tank, bare):
        said = []
        image = imread(draw_slice(folder, tmp_path / "s.png", 0.5, 1, 0.41, said.append))
        shares.append(float((np.abs(image[..., :3] - [0.765, 0.784, 0.812]).max(axis=2) < 0.01).mean()))
        assert said == []
    assert 0.01 < shares[1] < shares[0]
    draw_slice(tank, tmp_path / "s.png", 0.37, None, None, said.append)
    assert "the nearest to 0.37 is" in said[0] and "TPLTD" in said[0]


def test_what_cannot_be_sliced_is_told(tank, anvil, tmp_path):
    result = call("slice", tank, "--axis", "x", "--at", "7")
    assert result.exit_code == 2 and "outside of the mesh, 0 … 2" in result.output
    result = call("slice", anvil)
    assert result.exit_code == 2 and "no fields.h5" in result.output
    assert call("slice", tmp_path / "nowhere").exit_code == 2
    (tmp_path / "fields.h5").write_bytes(b"no")
    assert call("slice", tmp_path).exit_code == 1
    with pytest.raises(WrongRequest):
        draw_slice(tank, tmp_path / "s.png", None, 0, -1.0)


def test_panels_of_the_liquid(tank, anvil):
    shown = {panel.title: panel for panel in liquid_panels(Results(tank))}
    assert list(shown) == [
        "Pressure at the probes",
        "Surface at the probes",
        "Flow through the planes",
        "Force of the liquid on rock",
        "Energy of the liquid",
        "Volume of the liquid",
    ]
    pressure = shown["Pressure at the probes"]
    assert [line.text for line in pressure.lines] == ["probe 1", "probe 3"] and pressure.unit == "Pa"
    kinetic, potential, total = (line.y for line in shown["Energy of the liquid"].lines)
    assert potential[0] == 0.0 and np.allclose(kinetic + potential, total)
    assert "but for" in shown["Volume of the liquid"].note
    assert liquid_panels(Results(anvil)) == []


def test_plot_names_the_probes(tank, tmp_path):
    result = call("plot", tank, "probes/1/p", "probes/3/p", "bodies/rock/force", "-o", tmp_path / "a.png")
    assert result.exit_code == 0, result.output
    assert "bodies/rock/force" in call("plot", tank, "--list").output


def test_the_report(tank, tmp_path):
    result = call("report", tank, "-o", tmp_path / "r.png")
    assert result.exit_code == 0, result.output
    image = imread(tmp_path / "r.png")
    assert blue(image[: len(image) // 5]) > 0.1, "pictures of the water on top"
