"""Sizes of the liquid's force over a run: quantiles by time, and the table that shows them."""

import io

import numpy as np
import pytest
from rich.console import Console

from flowgmo.flow.observe.spikes import Spikes
from flowgmo.output import RunLog


def by_time(sizes, dt, share):
    """The quantile of all values, each weighted by its time."""
    order = np.argsort(sizes)
    return sizes[order][np.searchsorted(np.cumsum(dt[order]), share * dt.sum())]


def test_quantiles_are_those_of_all_steps_to_one_per_cent():
    rng, n = np.random.default_rng(3), 5000
    sizes = np.exp(rng.normal(0.0, 2.0, (n, 2))) * [1e-6, 1e5]
    directions = rng.normal(size=(n, 2, 3))
    forces = sizes[..., None] * directions / np.linalg.norm(directions, axis=2, keepdims=True)
    dt = rng.uniform(0.001, 0.1, n)
    spikes, t = Spikes(2), np.cumsum(dt)
    for k in range(n):
        spikes.note(forces[k], t[k], dt[k])
    found = spikes.summary(["light", "heavy"])
    for k, name in enumerate(("light", "heavy")):
        assert found[name]["median"] == pytest.approx(by_time(sizes[:, k], dt, 0.5), rel=0.01)  # half a bin of 2 %
        assert found[name]["quantile_99"] == pytest.approx(by_time(sizes[:, k], dt, 0.99), rel=0.01)
        assert found[name]["largest"] == pytest.approx(sizes[:, k].max(), rel=1e-12)
        assert found[name]["time"] == t[np.argmax(sizes[:, k])]
    assert sum(map(len, spikes.shares)) <= 2 * 900  # bins, not steps: e^18 in steps of 2 %


def test_a_step_cut_in_parts_counts_the_same_and_dry_time_does_not():
    whole, parts = Spikes(1), Spikes(1)
    for k, size in enumerate((0.0, 3.0, 5.0, 700.0)):
        force = np.array([[0.0, 0.0, size]])
        whole.note(force, k + 1.0, 1.0)
        for part in range(8):
            parts.note(force, k + (part + 1) / 8.0, 0.125)
    one, other = whole.summary(["ball"])["ball"], parts.summary(["ball"])["ball"]
    assert one["median"] == other["median"] == pytest.approx(5.0, rel=0.01)
    assert one["largest"] == other["largest"] == 700.0
    assert one["quantile_99"] == other["quantile_99"] == pytest.approx(700.0, rel=0.01)
    assert (one["time"], other["time"]) == (4.0, 3.125)  # the end of the first step that has it
    assert Spikes(1).summary(["never wet"]) == {}


def test_a_constant_force_is_its_own_median():
    spikes = Spikes(1)
    for k in range(3):
        spikes.note(np.array([[0.0, 4.0, 3.0]]), float(k), 1.0)
    assert spikes.summary(["held"])["held"]["median"] == pytest.approx(5.0, rel=0.01)


def test_the_log_shows_them(tmp_path):
    forces = {f"ball{k}": {"median": 1.5, "quantile_99": 8.25, "largest": 77.0, "time": 0.375} for k in range(41)}
    log = RunLog(tmp_path, console=Console(file=io.StringIO(), width=120))
    log.footer({"status": "done", "steps": 10, "t": 1.0, "forces": forces})
    log.close()
    told = (tmp_path / "run.log").read_text()
    for part in ("force of the liquid on", "99 % below", "ball0 ", "8.25", "77", "0.375", "… and 1 more"):
        assert part in told, told
