"""vtk/: what ParaView reads."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
import pyvista

from flowgmo.output import OutputError, Snapshots
from flowgmo.output.vtk import rotation
from flowgmo.state import initial_state


def times(folder):
    return [float(e.attrib["timestep"]) for e in ET.parse(folder / "vtk/case.pvd").iter("DataSet")]


@pytest.fixture
def turned(scenes):
    """A ball that moved and turned 90 degrees about z, and the anvil."""
    model = scenes.anvil()
    state = initial_state(model)
    state.t = 0.25
    state.p_WB[0] = [0.1, 0.2, 0.3]
    state.q_WB[0] = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
    state.v_WB[0], state.w_WB[0] = [3, 4, 0], [0, 0, 2]
    return model, state


def test_surfaces_follow_the_bodies(scenes, tmp_path, turned):
    model, state = turned
    Snapshots(tmp_path, model).write(state)
    mesh = pyvista.read(tmp_path / "vtk/bodies_000000.vtp")
    assert set(np.unique(mesh["component"])) == {1, 2} and set(np.unique(mesh["kind"])) == {0, 2}
    assert mesh.field_data["TimeValue"][0] == 0.25
    ball = mesh.extract_cells(mesh["component"] == 1).extract_surface(algorithm=None)
    assert np.allclose(ball.points.mean(axis=0), [0.1, 0.2, 0.3], atol=1e-2)
    assert np.allclose(np.linalg.norm(ball.points - [0.1, 0.2, 0.3], axis=1), 0.1, atol=1e-6)
    arms = ball.points - np.array([0.1, 0.2, 0.3])
    assert np.allclose(ball["velocity"], [3, 4, 0] + np.cross([0, 0, 2], arms), atol=1e-6)
    assert np.allclose(np.unique(mesh["speed"]), [0, 5])
    anvil = mesh.extract_cells(mesh["component"] == 2)
    assert np.allclose(anvil.bounds, [-0.3, 0.3, -0.3, 0.3, -0.1, 0.0]), "stationary solids end at the domain"


def test_rotation_is_body_to_space():
    assert np.allclose(rotation(np.array([[np.sqrt(0.5), 0, 0, np.sqrt(0.5)]]))[0] @ [1, 0, 0], [0, 1, 0])


def test_the_collection_is_valid_after_every_snapshot(tmp_path, turned):
    model, state = turned
    snapshots = Snapshots(tmp_path, model)
    assert times(tmp_path) == []
    for k in range(3):
        state.t = 0.1 * k
        snapshots.write(state)
        assert times(tmp_path) == [0.1 * j for j in range(k + 1)]
    snapshots.write(state)  # the same time again
    assert len(times(tmp_path)) == 3
    reader = pyvista.get_reader(str(tmp_path / "vtk/case.pvd"))
    assert reader.time_values == times(tmp_path)
    reader.set_active_time_value(0.1)
    assert reader.read()[0].n_cells > 100


def test_resume_drops_later_snapshots(tmp_path, turned):
    model, state = turned
    snapshots = Snapshots(tmp_path, model)
    for state.t in (0.0, 0.1, 0.2, 0.3):
        snapshots.write(state)
    resumed = Snapshots(tmp_path, model, resume_at=0.15)
    assert times(tmp_path) == [0.0, 0.1]
    assert len(list((tmp_path / "vtk").glob("*.vtp"))) == 2
    state.t = 0.18
    resumed.write(state)
    assert times(tmp_path) == [0.0, 0.1, 0.18]
    assert Snapshots(tmp_path, model) and times(tmp_path) == [], "a new run starts afresh"


def test_a_scene_without_bodies_writes_nothing(scenes, tmp_path):
    model = scenes.build([])
    Snapshots(tmp_path, model).write(initial_state(model))
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_collection_is_told(tmp_path, turned):
    Snapshots(tmp_path, turned[0])
    (tmp_path / "vtk/case.pvd").write_text("<VTKFile")
    with pytest.raises(OutputError, match=r"case\.pvd: it is damaged"):
        Snapshots(tmp_path, turned[0], resume_at=1.0)


def test_vtk_failing_to_write_is_told_and_prints_nothing(tmp_path, turned, capfd):
    model, state = turned
    snapshots = Snapshots(tmp_path, model)
    for file in (tmp_path / "vtk").iterdir():
        file.unlink()
    (tmp_path / "vtk").rmdir()
    with pytest.raises(OutputError, match=r"bodies_000000\.vtp"):
        snapshots.write(state)
    assert capfd.readouterr() == ("", "")
