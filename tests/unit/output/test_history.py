"""history.h5: the layout that others read, continuing a run, and what a killed run leaves."""

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import h5py
import numpy as np
import pytest

from flowgmo.output import History, OutputError
from flowgmo.records import IMPACT, REGIMES, no_impacts


def layout(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item.shape}) if isinstance(item, h5py.Dataset) else None)
    return found


def slices(rows, *ends):
    """The same rows in pieces."""
    for a, b in zip((0, *ends), (*ends, len(rows.t)), strict=True):
        cut = {k: v[a:b] for k, v in vars(rows).items() if isinstance(v, np.ndarray)}
        absent = {k: None for k, v in vars(rows).items() if v is None}
        yield type(rows)(**cut, **absent, energy={k: v[a:b] for k, v in rows.energy.items()})


def test_layout_is_the_contract(scenes, tmp_path):
    model = scenes.all_kinds()
    history = History(tmp_path, model)
    history.write(scenes.random_rows(model, [0.0, 0.1, 0.2]))
    history.write_impacts(np.zeros(2, IMPACT))
    history.close()
    wanted = {"time": (3,), "deck": ()}
    for body in ("ball", "piston", "lever"):  # what moves; `rock` does not
        wanted |= {f"bodies/{body}/orientation": (3, 4), f"bodies/{body}/kinetic_energy": (3,)}
        for vector in (
            "position", "velocity", "angular_velocity", "contact_force", "residual_force", "residual_torque",
        ):  # fmt: skip
            wanted[f"bodies/{body}/{vector}"] = (3, 3)
    wanted |= {f"energy/{name}": (3,) for name in ("kinetic", "potential", "impacts", "dissipated")}
    wanted |= {f"collisions/{name}": (2,) for name in ("time", "a", "b", "e", "mu", "regime", "energy_loss")}
    wanted |= {"collisions/cluster": (2,), "collisions/count": (2,)}
    wanted |= {f"collisions/{name}": (2, 3) for name in ("point", "normal", "impulse", "fluid_impulse")}
    assert layout(tmp_path / "history.h5") == wanted


def test_attributes_say_unit_place_and_meaning(scenes, tmp_path):
    model = scenes.all_kinds()
    history = History(tmp_path, model)
    history.write(scenes.random_rows(model, [0.0]))
    history.close()
    with h5py.File(tmp_path / "history.h5") as file:
        assert file["bodies/ball/position"].attrs["point"] == "mass centre"
        assert file["bodies/piston/position"].attrs["point"] == "reference point"
        units = {name: file[name].attrs["unit"] for name in layout(tmp_path / "history.h5") if name != "deck"}
        assert units["time"] == "s" and units["bodies/ball/position"] == "m"
        assert units["bodies/ball/angular_velocity"] == "rad/s" and units["bodies/ball/orientation"] == "1"
        assert units["bodies/ball/residual_torque"] == "N m" and units["collisions/impulse"] == "N s"
        assert units["energy/kinetic"] == "J"
        vectors = [name for name in units if file[name].ndim == 2]
        assert all("space" in file[name].attrs["location"] for name in vectors)
        assert all(file[name].attrs["meaning"] for name in units)
        assert file["deck"][()].decode() == model.resolved_deck
        assert {"version_flowgmo", "version_numpy", "version_h5py"} <= set(file.attrs)
        assert list(file["collisions/regime"].attrs["names"]) == list(REGIMES)
        names = list(file["collisions"].attrs["names"])
        assert names[:2] == ["-6 Zmax", "-5 Zmin"] and names[5:9] == ["-1 Xmin", "0 limit", "1 ball", "2 piston"]
        assert np.array_equal(file.attrs["domain"], model.mesh.bounds)


def test_custom_units_are_combinations(scenes, tmp_path):
    model = scenes.anvil(units="cust")
    history = History(tmp_path, model)
    history.write(scenes.random_rows(model, [0.0]))
    history.close()
    with h5py.File(tmp_path / "history.h5") as file:
        assert file["bodies/ball/velocity"].attrs["unit"] == "length/time"
        assert file["collisions/impulse"].attrs["unit"] == "mass length/time"


def test_what_the_scene_does_not_have_is_absent(scenes, tmp_path):
    model = scenes.anvil()
    history = History(tmp_path, model)
    history.write(scenes.random_rows(model, [0.0], contact_force=None, residual_force=None, residual_torque=None))
    history.close()
    assert not [name for name in layout(history.path) if "contact_force" in name or "residual" in name]


def test_rows_in_pieces_come_out_as_written(scenes, tmp_path):
    model = scenes.all_kinds()
    rows = scenes.random_rows(model, np.linspace(0, 2, 1001))
    history = History(tmp_path, model)
    for k, piece in enumerate(slices(rows, 1, 2, 300, 700)):
        history.write(piece)
        if k % 2:
            history.flush()
    history.close()
    history.close()  # a second time does nothing
    with h5py.File(history.path) as file:
        assert np.array_equal(file["time"], rows.t)
        assert np.array_equal(file["bodies/lever/position"], rows.p_WB[:, 3])
        assert np.array_equal(file["bodies/piston/orientation"], rows.q_WB[:, 1])
        assert np.array_equal(file["bodies/ball/kinetic_energy"], rows.kinetic_energy[:, 0])
        assert np.array_equal(file["energy/impacts"], rows.energy["impacts"])


def test_resume_drops_what_came_later_and_appends(scenes, tmp_path):
    model = scenes.anvil()
    rows, impacts = scenes.random_rows(model, np.linspace(0, 1, 11)), np.zeros(4, IMPACT)
    impacts["time"], impacts["a"] = [0.1, 0.5, 0.55, 0.9], [1, 2, 3, 4]
    history = History(tmp_path, model)
    history.write(rows)
    history.write_impacts(impacts)
    history.close()
    history = History(tmp_path, model, resume_at=rows.t[5])
    later = scenes.random_rows(model, [0.6, 0.7], seed=1)
    history.write(later)
    history.write_impacts(impacts[3:])
    history.write_impacts(no_impacts())
    history.close()
    with h5py.File(history.path) as file:
        assert np.array_equal(file["time"], [*rows.t[:6], 0.6, 0.7])
        assert np.array_equal(file["bodies/ball/velocity"], np.concatenate([rows.v_WB[:6, 0], later.v_WB[:, 0]]))
        assert np.array_equal(
            file["energy/kinetic"], np.concatenate([rows.energy["kinetic"][:6], later.energy["kinetic"]])
        )
        assert np.array_equal(file["collisions/time"], [0.1, 0.5, 0.9])
        assert np.array_equal(file["collisions/a"], [1, 2, 4])


def test_a_new_run_replaces_an_old_history(scenes, tmp_path):
    for _ in range(2):
        history = History(tmp_path, scenes.anvil())
        history.write(scenes.random_rows(history.model, [0.0, 0.1]))
        history.close()
    assert layout(history.path)["time"] == (2,)


def test_resume_refuses_foreign_files_and_other_bodies(scenes, tmp_path):
    history = History(tmp_path, scenes.anvil())
    history.write(scenes.random_rows(history.model, [0.0]))
    history.close()
    with pytest.raises(OutputError, match="other bodies"):
        History(tmp_path, scenes.all_kinds(), resume_at=0.0)
    for content in (b"", b"not HDF5 at all"):
        history.path.write_bytes(content)
        with pytest.raises(OutputError, match=r"history\.h5"):
            History(tmp_path, scenes.anvil(), resume_at=0.0)


def test_can_be_read_while_the_run_goes_on(scenes, tmp_path):
    model = scenes.anvil()
    history = History(tmp_path, model)
    history.write(scenes.random_rows(model, [0.0, 0.1]))
    history.flush()
    read = "import h5py, sys; print(len(h5py.File(sys.argv[1], 'r', locking=False)['time']))"
    out = subprocess.run([sys.executable, "-c", read, history.path], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "2"
    history.close()


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_killed_run_leaves_a_readable_file(scenes, tmp_path):
    """Killed with rows in memory after two flushes: the flushed rows are there."""
    program = f"""
        import importlib.util, os, signal
        from pathlib import Path
        spec = importlib.util.spec_from_file_location("scenes", {str(Path(scenes.__file__))!r})
        scenes = importlib.util.module_from_spec(spec); spec.loader.exec_module(scenes)
        from flowgmo.output import History
        model = scenes.anvil()
        history = History(Path({str(tmp_path)!r}), model)
        for k in range(3):
            history.write(scenes.random_rows(model, [k + 0.0, k + 0.5]))
            if k < 2: history.flush()
        os.kill(os.getpid(), signal.SIGKILL)
    """
    killed = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], env=os.environ)
    assert killed.returncode == -signal.SIGKILL
    with h5py.File(tmp_path / "history.h5") as file:
        assert np.array_equal(file["time"], [0.0, 0.5, 1.0, 1.5])
    History(tmp_path, scenes.anvil(), resume_at=0.5).close()
    assert layout(tmp_path / "history.h5")["bodies/ball/position"] == (2, 3)
