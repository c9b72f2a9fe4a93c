"""docs/results.md: it names every curve of history.h5 and every command, and its script runs."""

import re
import shutil
from pathlib import Path
from textwrap import dedent

import numpy as np

from flowgmo.output import history_layout as layout
from postproc.cli import main

PAGE = (Path(__file__).parents[3] / "docs" / "results.md").read_text(encoding="utf-8")


def test_every_curve_and_every_command_is_named():
    names = {column.name for column in layout.BODY} | set(layout.ENERGY) | set(layout.COLLISIONS)
    names |= {name for group in layout.LIQUID.values() for name in group}
    assert not [name for name in names if f"`{name}`" not in PAGE]
    assert not [name for name in main.commands if f"flowgmo-postproc {name}" not in PAGE]


def test_the_script_runs(tank, tmp_path):
    script = dedent(re.search(r"(?ms)^    import h5py\n.*?(?=^\S)", PAGE)[0])
    shutil.copy(tank / "history.h5", tmp_path)  # other tests may have it open
    read = {"folder": tmp_path, "name": "rock"}
    script = script.replace('body["position"][:, 2], ', "None, ")  # a rock that stands still has a load only
    exec(script, read)
    assert read["unit"] == "N" and len(read["t"]) == len(read["force"]) and np.isfinite(read["force"]).all()
