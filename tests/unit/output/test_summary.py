"""run.json is always JSON."""

import json
from pathlib import Path

import numpy as np
import pytest

from flowgmo.output import versions, write_run_json


def refuse(text):
    raise ValueError(text)


def test_numbers_that_json_does_not_know(tmp_path):
    summary = {
        "status": "failed", "t": np.float64(0.5), "steps": np.int64(3), "energy": {"kinetic": np.nan, "x": -np.inf},
        "list": np.array([1.0, np.inf]), "path": Path("a/b"), 3: (True, None), "versions": versions(),
    }  # fmt: skip
    write_run_json(tmp_path / "run.json", summary)
    back = json.loads((tmp_path / "run.json").read_text(), parse_constant=refuse)
    assert back["energy"] == {"kinetic": None, "x": None} and back["list"] == [1.0, None]
    assert back["steps"] == 3 and back["t"] == 0.5 and back["3"] == [True, None]
    assert {"flowgmo", "python", "numpy", "numba", "h5py"} <= set(back["versions"])
    assert [p.name for p in tmp_path.iterdir()] == ["run.json"]


def test_a_status_that_does_not_exist(tmp_path):
    with pytest.raises(ValueError, match="done, failed, interrupted"):
        write_run_json(tmp_path / "run.json", {"status": "ok"})
