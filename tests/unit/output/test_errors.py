"""A full disk, a folder without permission: one error with file and reason, and no half-written file."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from flowgmo.output import History, OutputError, Snapshots, write_restart, write_run_json
from flowgmo.output.errors import make_folder, replacing, writing
from flowgmo.state import initial_state


@pytest.fixture
def full_disk(monkeypatch):
    """Every replacement of a file fails as on a full disk."""

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "replace", full)


def test_full_disk(scenes, tmp_path, full_disk):
    model = scenes.anvil()
    for write in (
        lambda: write_restart(tmp_path / "restart.h5", model, initial_state(model)),
        lambda: write_run_json(tmp_path / "run.json", {"status": "done"}),
        lambda: Snapshots(tmp_path, model),
    ):
        with pytest.raises(OutputError, match="No space left on device"):
            write()
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == []


def test_full_disk_in_the_history(scenes, tmp_path, monkeypatch):
    model = scenes.anvil()
    history = History(tmp_path, model)
    history.write(scenes.random_rows(model, [0.0]))

    def full(*_):
        raise RuntimeError("Can't decrement id ref count (unable to extend file, No space left on device)")

    monkeypatch.setattr("flowgmo.output.history._append", full)
    with pytest.raises(OutputError, match=r"history\.h5.*No space left on device"):
        history.flush()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_device_that_is_really_full(tmp_path):
    with pytest.raises(OutputError, match="No space left"), writing(tmp_path), open("/dev/full", "w") as file:  # noqa: PTH123
        file.write("x" * 100000)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write anywhere")
def test_read_only_folder(scenes, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match="Permission denied"):
        History(tmp_path / "new", scenes.anvil())
    tmp_path.chmod(0o700)


def test_a_file_where_a_folder_should_be(tmp_path):
    (tmp_path / "out").write_text("")
    with pytest.raises(OutputError, match="cannot write"):
        make_folder(tmp_path / "out" / "vtk")


def test_replacing_leaves_the_old_file_when_something_fails(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replacing(path) as temporary:
        temporary.write_text("half")
        raise ZeroDivisionError
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


def test_importing_the_package_loads_nothing_heavy():
    code = "import sys, flowgmo.output; print([m for m in ('h5py', 'vtkmodules', 'rich', 'numba') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


def test_the_package_imports_what_it_may():
    """numpy, h5py, rich, vtkmodules (inside functions), and the standard library; never the heavy rest."""
    code = (
        "import sys, flowgmo.output as o; [getattr(o, n) for n in o.__all__];"
        "print([m for m in ('pyvista', 'numba', 'scipy', 'matplotlib', 'meshio', 'vtkmodules') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    allowed = "[]" if "scipy" not in out.stdout else "['scipy']"  # geometry, which Body names, may use scipy
    assert out.stdout.strip() == allowed
