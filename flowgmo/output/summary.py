"""run.json: what a run did and cost, for programs. Always valid JSON: what is not a finite number is null."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

from flowgmo.output.errors import make_folder, replacing

STATUSES = ("done", "failed", "interrupted")


def write_run_json(path: Path, summary: dict) -> None:
    """Write the summary, a dict with

    status        "done", "failed", "interrupted";  reason  one line
    steps, t, cells, wall_seconds, peak_memory_bytes
    effects       name -> {"seconds", "share"}
    energy        name -> number, names as in `/energy` of history.h5
    collisions    {"total", "per_body": name -> {"count", "impulse"}}
    volume_error, liquid (Tally.summary and the last row's volume and energies)   only with liquid
    forces        name -> {"median", "quantile_99", "largest", "time"}, the liquid's on bodies that move in it
    versions, command_line;  limits  list of texts
    """
    path = Path(path)
    if summary.get("status") not in STATUSES:
        raise ValueError(f"status is one of {', '.join(STATUSES)}, not {summary.get('status')!r}")
    make_folder(path.parent)
    text = json.dumps(_plain(summary), indent=2, allow_nan=False)
    with replacing(path) as temporary:
        temporary.write_text(text + "\n")


def _plain(value: object) -> object:
    """The same in types that JSON knows."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return str(value)
