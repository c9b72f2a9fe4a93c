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


def test_the_scripts_run(tank, tmp_path):
    """As on the page, but for the folder, the body, and its place: a rock that stands still has a load only."""
    scripts = [dedent(block) for block in re.findall(r"(?m)(?:^(?:    .*)?\n)+", PAGE) if "h5py.File" in block]
    for name in ("history.h5", "fields.h5"):
        shutil.copy(tank / name, tmp_path)  # other tests may have it open
    script = "".join(scripts).replace('Path("decks/gate/gate.out")', "there").replace("bodies/gate", "bodies/rock")
    read = {"there": tmp_path}
    exec(script.replace('body["position"][:, 0], ', "None, "), read)
    assert len(scripts) == 2 and read["depth"].ndim == 2 and np.isfinite(read["depth"]).all()
    assert read["unit"] == "N" and len(read["t"]) == len(read["force"]) and np.isfinite(read["force"]).all()
