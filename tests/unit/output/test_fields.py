"""fields.h5: snapshots of the liquid."""

import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from flowgmo.output import Fields, OutputError
from flowgmo.output.fields import snapshots
from flowgmo.state import initial_state


@pytest.fixture
def small(scenes, wet):
    model = wet.tank(scenes, n=(12, 6, 8))
    state = initial_state(model)
    state.fluid = wet.flow_at(model, 0.0)
    return model, state, wet.solids(model)[0].V


def times(folder):
    with h5py.File(folder / "fields.h5") as file:
        return snapshots(file)


def test_what_it_holds(small, tmp_path, wet):
    model, state, V = small
    fields = Fields(tmp_path, model, V=V)
    assert times(tmp_path) == []
    for t in (0.0, 0.25):
        state.t, state.fluid = t, wet.flow_at(model, t)
        fields.write(state)
    with h5py.File(tmp_path / "fields.h5") as file:
        assert snapshots(file) == [(0.0, "000000"), (0.25, "000001")]
        group = file["000001"]
        assert {name: item.shape for name, item in group.items()} == {
            "F": (12, 6, 8),
            "p": (12, 6, 8),
            "velocity": (12, 6, 8, 3),
        }
        assert all(item.dtype == np.float32 for item in group.values())
        assert np.allclose(group["F"], state.fluid.F[2:-2, 2:-2, 2:-2], atol=1e-7)
        assert group["p"].attrs["unit"] == "Pa" and file.attrs["time_unit"] == "s"
        assert np.array_equal(file["x"], model.mesh.blocks[0].x) and file["V"].shape == (12, 6, 8)
        assert file["deck"][()].decode() == model.resolved_deck


def test_no_surface_no_solids_no_third_direction(scenes, wet, tmp_path):
    model = wet.tank(scenes, n=(12, 1, 8), rock=False)
    state = initial_state(model)
    state.fluid = wet.flow_at(model, 0.3)
    state.fluid.F = None
    Fields(tmp_path, model).write(state)
    with h5py.File(tmp_path / "fields.h5") as file:
        assert set(file["000000"]) == {"p", "velocity"} and "V" not in file
        assert not file["000000/velocity"][..., 1].any() and file["000000/velocity"][..., 0].any()


def test_the_same_time_twice_is_one_snapshot(small, tmp_path):
    model, state, V = small
    fields = Fields(tmp_path, model, V=V)
    fields.write(state)
    fields.write(state)
    assert len(times(tmp_path)) == 1


def test_a_reader_that_keeps_the_file_open_does_not_end_the_run(small, tmp_path):
    model, state, V = small
    fields = Fields(tmp_path, model, V=V)
    code = "import h5py, sys; f = h5py.File(sys.argv[1]); print('open', flush=True); sys.stdin.read()"
    command = [sys.executable, "-c", code, str(tmp_path / "fields.h5")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as reader:
        reader.stdout.readline()
        fields.write(state)
        reader.stdin.close()
    assert len(times(tmp_path)) == 1


def test_resume_drops_what_is_later_or_not_whole(small, tmp_path):
    model, state, V = small
    fields = Fields(tmp_path, model, V=V)
    for state.t in (0.0, 0.1, 0.2, 0.3):
        fields.write(state)
    with h5py.File(tmp_path / "fields.h5", "r+") as file:
        file.create_group("000004")  # a run was killed here
    assert len(times(tmp_path)) == 4, "readers skip it"
    resumed = Fields(tmp_path, model, V=V, resume_at=0.15)
    state.t = 0.18
    resumed.write(state)
    assert times(tmp_path) == [(0.0, "000000"), (0.1, "000001"), (0.18, "000002")]
    Fields(tmp_path, model, V=V)
    assert times(tmp_path) == [], "a new run starts afresh"


def test_what_cannot_be_continued_is_told(small, scenes, wet, tmp_path):
    model, _, V = small
    Fields(tmp_path, model, V=V)
    with pytest.raises(OutputError, match="another mesh"):
        Fields(tmp_path, wet.tank(scenes, n=(4, 4, 4)), resume_at=1.0)
    (tmp_path / "fields.h5").write_bytes(b"no")
    with pytest.raises(OutputError, match=r"fields\.h5: it cannot be continued"):
        Fields(tmp_path, model, V=V, resume_at=1.0)


def test_a_full_disk_is_told_before_anything_is_written(small, tmp_path, monkeypatch):
    model, state, V = small
    fields = Fields(tmp_path, model, V=V)
    fields.write(state)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.posix_fallocate", full)
    state.t = 1.0
    with pytest.raises(OutputError, match=r"fields\.h5: No space left on device"):
        fields.write(state)
    assert len(times(tmp_path)) == 1


KILLED = """
import sys
sys.path[:0] = {paths!r}
import scenes, wet_scenes as wet
from pathlib import Path
from flowgmo.output import Fields
from flowgmo.state import initial_state
model = wet.tank(scenes, n=(30, 12, 16))
state = initial_state(model)
state.fluid = wet.flow_at(model, 0.2)
fields = Fields(Path(sys.argv[1]), model)
print("go", flush=True)
while True:
    state.t += 1.0
    fields.write(state)
"""


def test_a_killed_run_leaves_a_readable_file(tmp_path):
    """Kills at random moments of a run that does nothing but write: all but the last snapshot are there."""
    here = Path(__file__)
    code = KILLED.format(paths=[str(here.parent), str(here.parents[2] / "helpers")])
    for k in range(4):
        folder = tmp_path / str(k)
        child = subprocess.Popen([sys.executable, "-c", code, str(folder)], stdout=subprocess.PIPE)
        child.stdout.readline()
        time.sleep(0.1 + 0.037 * k)
        child.kill()
        child.wait()
        with h5py.File(folder / "fields.h5", locking=False) as file:
            found = snapshots(file)
            for _, name in found:
                assert np.isfinite(file[name]["p"][()]).all()
        assert [t for t, _ in found] == list(range(1, len(found) + 1)) and len(found) > 0
