"""history.h5 of bodies that move in liquid."""

import h5py
import numpy as np
import pytest
from flowgmo_wet_bodies import model_of, tank

from flowgmo.run import DONE, run


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wet") / "r"
    text = tank(output="thpltd(1)=.01, tpltd(1)=.04, tapltd(1)=.03,").replace("twfin=2.0", "twfin=.08")
    assert run(model_of(text), folder, None, "test") == DONE
    return folder


def test_every_moving_body_has_its_loads(results):
    with h5py.File(results / "history.h5") as file:
        rows = len(file["time"])
        for name in ("ball", "box"):
            group = file[f"bodies/{name}"]
            for part in ("force", "torque", "force_pressure", "buoyancy_centre"):
                assert group[part].shape == (rows, 3) and np.isfinite(group[part]).all()
                assert group[part].attrs["unit"] and "space axes" in group[part].attrs["location"]
            assert group["wetted_area"].shape == (rows,) and "force_shear" not in group
            assert group["torque"].attrs["location"].endswith("about the body's point")
            assert "mean over the step" in group["force"].attrs["meaning"]
            assert np.array_equal(group["force"], group["force_pressure"])
        assert file["bodies/box/position"].attrs["point"] == "mass centre"


def test_energy_of_bodies_and_liquid(results):
    """The books add up: what is kinetic and potential now, less what was, is what was given and the remainder."""
    with h5py.File(results / "history.h5") as file:
        energy = {name: file[f"energy/{name}"][:] for name in file["energy"]}
        assert set(energy) == {"kinetic", "potential", "work_prescribed", "remainder"}
        total = energy["kinetic"] + energy["potential"]
        assert energy["remainder"][0] == 0.0
        miss = total - total[0] - energy["work_prescribed"] - energy["remainder"]
        assert np.abs(miss).max() <= 1e-12 * np.abs(total).max()
        bodies = file["bodies/box/kinetic_energy"][:]
        assert energy["kinetic"][-1] == pytest.approx(file["fluid/kinetic_energy"][-1] + bodies[-1], rel=1e-12)


def test_snapshots_have_the_openings_of_their_time(results):
    """The volume of the bodies leaves the first cells that the ball covered and enters others; the sum stays."""
    with h5py.File(results / "fields.h5") as file:
        names = []
        file.visit(lambda name: names.append(name) if name.split("/")[-1] == "V" else None)
        found = [file[name][()] for name in names]
    frames = found if len(found) > 1 else list(found[0])
    assert len(frames) >= 3
    assert np.abs(frames[0] - frames[-1]).max() > 0.2
    assert frames[0].sum() == pytest.approx(frames[-1].sum(), rel=1e-6)
