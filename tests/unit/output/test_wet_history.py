"""What the history, the log, and the VTK files hold of the liquid."""

import io
import xml.etree.ElementTree as ET

import h5py
import numpy as np
import pytest
import pyvista
from rich.console import Console

from flowgmo.flow.observe.tally import Tally
from flowgmo.flow.observe.watch import at_once
from flowgmo.output import History, Snapshots, read_restart, write_restart
from flowgmo.output.history_layout import LIQUID
from flowgmo.output.log import RunLog
from flowgmo.output.units import unit
from flowgmo.state import initial_state


@pytest.fixture
def rows(scenes, wet):
    """A model, and its row at time t."""
    model = wet.tank(scenes, n=(12, 6, 8))
    watch = wet.watch_of(model)
    return model, lambda t: wet.rows_of(model, [t], at_once(watch.measure(wet.flow_at(model, t), 0.6, np.zeros(6))))


def test_every_value_has_its_dataset(rows, tmp_path):
    model, at = rows
    history = History(tmp_path, model)
    for t in (0.0, 0.1, 0.2):
        history.write(at(t))
    history.close()
    with h5py.File(tmp_path / "history.h5") as file:
        for name, values in at(0.2).liquid.items():
            assert np.array_equal(file[name][2], values[0]) and len(file[name]) == 3
            assert file[name].attrs["unit"] and file[name].attrs["meaning"]
        assert file["probes/3/x"][()].tolist() == [1.9, 0.4, 0.05]
        assert file["planes/1"].attrs["axis"] == "x" and file["planes/1"].attrs["position"] == 1.2
        assert file["bodies/rock"].attrs["point"].tolist() == [0, 0, 0] and set(file["bodies"]) == {"rock"}


def test_it_goes_on_after_a_restart(rows, tmp_path):
    model, at = rows
    history = History(tmp_path, model)
    for t in (0.0, 0.1, 0.2, 0.3):
        history.write(at(t))
    history.close()
    history = History(tmp_path, model, resume_at=0.1)
    history.write(at(0.15))
    history.close()
    with h5py.File(tmp_path / "history.h5") as file:
        assert file["time"][()].tolist() == [0.0, 0.1, 0.15]
        assert all(len(file[name]) == 3 for name in at(0.0).liquid)


def test_room_is_asked_for_all_of_a_flush(rows, tmp_path):
    """The file never grows by more than what was asked for."""
    model, at = rows
    history = History(tmp_path, model)
    for k in range(40):
        history.write(at(0.1 * k))
    before, asked = history.path.stat().st_size, history._needed()
    history.flush()
    assert history.path.stat().st_size - before <= asked
    history.close()


def test_units_of_what_is_recorded():
    quantities = {entry[1] for group in LIQUID.values() for entry in group.values()}
    for system in ("si", "cgs", "eng", ""):
        assert all(unit(quantity, system) for quantity in quantities)
    assert unit("pressure", "SI") == "Pa" and unit("flow", "") == "length^3/time"


def test_snapshots_hold_bodies_surface_and_fields(scenes, wet, tmp_path):
    model = wet.tank(scenes, n=(16, 8, 10))
    V, state = wet.solids(model)[0].V, initial_state(model)
    snapshots = Snapshots(tmp_path, model, V=V)
    for t, full in ((0.0, True), (0.1, False), (0.2, True), (0.3, True)):
        state.t, state.fluid = t, wet.flow_at(model, t)
        snapshots.write(state, full)
    entries = [
        (e.attrib["timestep"], e.attrib["part"], e.attrib["file"])
        for e in ET.parse(tmp_path / "vtk/case.pvd").iter("DataSet")
    ]
    assert [e for e in entries if e[0] == "0.1"] == [
        ("0.1", "0", "bodies_000001.vtp"),
        ("0.1", "1", "surface_000001.vtp"),
    ]
    assert ("0.2", "2", "fields_000002.vtr") in entries
    grid = pyvista.read(tmp_path / "vtk/fields_000002.vtr")
    assert grid.dimensions == (17, 9, 11) and set(grid.cell_data) == {"p", "F", "velocity", "V"}
    i, j, k = 3, 4, 2
    cell = i + 16 * (j + 8 * k)
    state.fluid = wet.flow_at(model, 0.2)
    assert grid["p"][cell] == pytest.approx(state.fluid.p[i + 2, j + 2, k + 2])
    assert grid["V"][cell] == pytest.approx(V[i + 2, j + 2, k + 2])
    assert grid.cell_centers().points[cell] == pytest.approx(
        [0.5 * (x[m] + x[m + 1]) for x, m in zip(model.mesh.blocks[0].planes, (i, j, k), strict=True)]
    )
    assert pyvista.read(tmp_path / "vtk/surface_000001.vtp").n_cells > 100
    resumed = Snapshots(tmp_path, model, resume_at=0.2, V=V)
    assert sorted(p.name for p in (tmp_path / "vtk").glob("*_*")) == sorted(e[2] for e in entries if e[0] != "0.3")
    state.t = 0.2
    resumed.write(state)
    assert len(list((tmp_path / "vtk").glob("fields_*"))) == 2, "the same time again replaces it"


def test_a_scene_without_bodies_has_its_liquid(scenes, wet, tmp_path):
    model = wet.tank(scenes, n=(8, 4, 6), rock=False)
    state = initial_state(model)
    state.fluid = wet.flow_at(model, 0.0)
    Snapshots(tmp_path, model).write(state)
    assert {p.name for p in (tmp_path / "vtk").iterdir()} == {"case.pvd", "surface_000000.vtp", "fields_000000.vtr"}


def test_a_restart_holds_the_liquid_bit_for_bit(scenes, wet, tmp_path):
    model = wet.tank(scenes, n=(8, 4, 6))
    state = initial_state(model)
    state.fluid = wet.flow_at(model, 0.3)
    write_restart(tmp_path / "restart.h5", model, state)
    read = read_restart(tmp_path / "restart.h5", model)
    for name in "uvwpF":
        assert np.array_equal(getattr(read.fluid, name), getattr(state.fluid, name))
    assert read.fluid.dt == state.fluid.dt


def test_the_log_says_how_the_liquid_went(tmp_path):
    tally = Tally()
    for k in range(10):
        tally.note_solution(5 + k % 3)
        tally.note_step("surface" if k < 7 else "flow", 0.1 * (k % 4))
    tally.shortened += 1
    summary = tally.summary()
    assert summary["pressure"] == {"solutions": 10, "mean": pytest.approx(5.9), "most": 7}
    assert list(summary["steps_bounded_by"]) == ["surface", "flow"] and Tally().summary() == {}
    liquid = {"volume": 0.56, "volume_error": -3e-13, "kinetic_energy": 1.25, "potential_energy": 9.5} | summary
    text = io.StringIO()
    log = RunLog(tmp_path, console=Console(file=text, width=120), clock=lambda: 100.0)
    log._line_times = np.array([0.1])
    log.progress(0.2, 10, 1e-3, None, 7)
    log.footer({"status": "done", "steps": 10, "t": 1.0, "liquid": liquid, "volume_error": -3e-13})
    log.close()
    told = (tmp_path / "run.log").read_text()
    for part in ("iterations 7", "-3.00e-13", "5.9 mean, 7 most", "surface 70 %, flow 30 %", "0.300 most", "0.56 "):
        assert part in told, told
    assert "impacts" not in told.splitlines()[0]
