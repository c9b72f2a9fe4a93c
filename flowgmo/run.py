"""A run: from a Model to its results folder. Steps, output, stops, signals; the physics is in step.py."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.errors import FlowgmoError, StepFailed, StepTooLong
from flowgmo.model import Model
from flowgmo.output import (
    Fields,
    History,
    OutputError,
    RestartError,
    RunLog,
    Snapshots,
    read_restart,
    versions,
    write_restart,
    write_run_json,
)
from flowgmo.output.errors import replacing
from flowgmo.output.history import impacts_until
from flowgmo.records import Rows
from flowgmo.state import State, initial_state

if TYPE_CHECKING:
    from flowgmo.step import Report

DONE, FAILED, WRONG, INTERRUPTED = 0, 1, 2, 130  # exit codes (DESIGN 8)
STATUS = {DONE: "done", FAILED: "failed", INTERRUPTED: "interrupted"}
LAND = 1e-6  # a step this part of itself short of a landing time is stretched to it, not followed by a tiny one
OURS = ("deck.resolved.nml", "run.log", "run.json", "history.h5", "fields.h5", "restart.h5", "vtk")


def prepare_folder(folder: Path, overwrite: bool, restart: bool) -> None:
    """Make the results folder. Raises FlowgmoError if it exists (without overwrite or restart), or cannot be made."""
    try:
        if folder.exists() and not folder.is_dir():
            raise FlowgmoError(f"{folder} is a file, not a folder. Name another results folder with -o")
        if folder.is_dir() and any(folder.iterdir()) and not (overwrite or restart):
            raise FlowgmoError(
                f"the results folder {folder} exists and is kept. Write --overwrite to replace it, --restart FILE to "
                "go on, or -o DIR for another one"
            )
        if overwrite and not restart and folder.is_dir():
            for name in OURS:  # only what a run writes; other files of the user stay
                target = folder / name
                if target.is_dir():
                    shutil.rmtree(target)
                elif target.exists():
                    target.unlink()
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise FlowgmoError(f"the results folder {folder} cannot be written: {error.strerror or error}") from None


def run(model: Model, folder: Path, restart: Path | None, command_line: str) -> int:
    """Compute the scene into `folder`. Returns the exit code. Raises FlowgmoError before anything is written."""
    from flowgmo.step import prepare  # loads the kernels

    state = read_restart(restart, model) if restart else initial_state(model)
    if restart and state.t >= model.clock.end:
        raise RestartError(
            f"{restart} stands at t = {state.t:.6g}, the run ends at twfin={model.clock.end:.6g}. Write a later twfin"
        )
    job = Job(model, state, folder, resume_at=state.t if restart else None, command_line=command_line)
    try:
        with stopping_on_signals(job):
            job.world = prepare(model)
            job.start_liquid()
            try:
                job.compute()
            except StepFailed as error:
                job.finish(FAILED, str(error))
    except OutputError as error:
        job.abandon(error)
    except BaseException:
        job.close_quietly()
        raise
    return job.code


class Job:
    """One run in progress: the model, its state, and the files it writes."""

    def __init__(self, model: Model, state: State, folder: Path, resume_at: float | None, command_line: str) -> None:
        self.model, self.state, self.folder = model, state, folder
        self.resume_at, self.command_line = resume_at, command_line
        self.code, self.stop_asked = DONE, False
        self.began = self.last_restart = time.perf_counter()
        self.writing = 0.0
        self.per_body: dict[str, dict[str, float]] = {}
        self.limits = 0
        self.cuts = 0
        self.last_rows: Rows | None = None
        if resume_at is not None:
            self._count(impacts_until(folder, resume_at))
        self.log = RunLog(folder, resume_at=resume_at)
        self.history = History(folder, model, resume_at)
        self.snapshots = Snapshots(folder, model, resume_at)
        self.fields = Fields(folder, model, resume_at) if model.fluid is not None else None
        with replacing(folder / "deck.resolved.nml") as temporary:
            temporary.write_text(model.resolved_deck, encoding="utf-8")
        self.log.header(model)
        self.history_times = model.output.history.times(model.clock.end)
        self.landings = model.output.snapshots.times(model.clock.end)
        self.selected = _apart_from(self.landings, model.output.selected.times(model.clock.end))

    def compute(self) -> None:
        """Step until the end, a stop, or an interrupt."""
        from flowgmo.rows import rows_of_state

        model, state = self.model, self.state
        if not _kernels_cached():
            self.log.print("first start: compiling the kernels of this scene, 5 to 60 s; later starts load them\n")
        if self.resume_at is None:
            from flowgmo.flow.watch import at_once
            from flowgmo.step import liquid_values

            self._write_rows(rows_of_state(self.world, state, at_once(liquid_values(self.world, state))))
            self._write_snapshot(state)
        while state.t < model.clock.end and state.step < model.clock.last_step and not self.stop_asked:
            began_at = state.t
            report, landing = self.advance()
            dt = state.t - began_at
            began = time.perf_counter()
            if report.rows is not None:
                self._write_rows(report.rows)
            if len(report.impacts):
                self._note_impacts(report.impacts)
            if landing:
                self._write_snapshot(state)
                self._save()
            elif began - self.last_restart > model.output.restart_wall:
                self._save()
            liquid, impacts = self.world.liquid, state.impacts if self.world.collisions is not None else None
            self.log.progress(state.t, state.step, dt, impacts, liquid.tally.iterations if liquid else None)
            self.writing += time.perf_counter() - began
        if self.stop_asked:
            self.finish(INTERRUPTED, "interrupted; restart.h5 holds the state, go on with --restart")
        elif state.t < model.clock.end:
            self.finish(DONE, f"itwfin={model.clock.last_step} steps are done")
        else:
            self.finish(DONE, "twfin is reached")

    def start_liquid(self) -> None:
        """The liquid at t = 0, where the scene has any and no restart file brought it."""
        if self.world.liquid is None:
            return
        self.snapshots.V = self.fields.V = self.world.liquid.openings.V
        from flowgmo.step import start_liquid

        start_liquid(self.world, self.state)

    def _write_snapshot(self, state: State) -> None:
        self.snapshots.write(state)
        if self.fields is not None:
            self.fields.write(state)

    def advance(self) -> tuple[Report, bool]:
        """One step, as long as it may be; shorter ones where the liquid asks for it. Returns whether it was a landing.

        Raises StepFailed where a step of dt_min fails too; the state is then the last good one.
        """
        from flowgmo.step import step

        state, clock = self.state, self.model.clock
        most = np.inf
        while True:
            t1, landing = self.next_time(most)
            asked = np.union1d(_between(self.history_times, state.t, t1), _between(self.selected, state.t, t1))
            try:
                began_at = state.t
                report = step(self.world, state, t1, asked, landing)
                self._note_step(state.t - began_at, most, landing)
                return report, landing
            except StepTooLong as error:
                most = 0.5 * (t1 - state.t)
                self.cuts += 1
                if most < clock.dt_min:
                    raise StepFailed(f"{error}, and a step below dtmin={clock.dt_min:.3g} would be needed") from error

    def _note_step(self, dt: float, most: float, landing: bool) -> None:
        """Book what bounded the step of the liquid."""
        liquid = self.world.liquid
        if liquid is None:
            return
        bounded = "tried again" if most < np.inf else "output" if dt < self.wanted else self.bounded_by
        liquid.tally.note_step(bounded, liquid.courant)
        liquid.tally.shortened = self.cuts

    def next_time(self, most: float) -> tuple[float, bool]:
        """Where the next step of at most `most` ends, and whether that is a landing."""
        state, clock = self.state, self.model.clock
        k = np.searchsorted(self.landings, state.t, side="right")
        landing = float(self.landings[min(k, len(self.landings) - 1)])
        if self.world.liquid is not None:
            return self._next_wet_time(min(most, _bound(clock.dt_max, state.t)), landing)
        return self._next_dry_time(landing)

    def _next_wet_time(self, most: float, landing: float) -> tuple[float, bool]:
        """As long as the liquid allows; the last two steps before a landing share what is left."""
        t, clock = self.state.t, self.model.clock
        longest = self.world.liquid.longest_step(self.state.fluid, clock.dt)
        dt = min(most, longest)
        self.wanted = dt * (1.0 - LAND)  # a step shorter than that is shared before a landing
        self.bounded_by = self.world.liquid.limiting if longest <= most else "largest step"
        left = landing - t
        if left <= dt * (1.0 + LAND):
            return landing, True
        return t + min(dt, 0.5 * left), False

    def _next_dry_time(self, landing: float) -> tuple[float, bool]:
        """Steps of DELT that count from the last landing: no drift."""
        state, clock = self.state, self.model.clock
        dt = min(clock.dt, _bound(clock.dt_max, state.t))
        t1 = state.landed + (state.since_landing + 1) * dt
        if dt < clock.dt or t1 <= state.t:
            t1 = state.t + dt
        if t1 >= landing - LAND * dt:
            return landing, True
        return t1, False

    def _write_rows(self, rows: Rows) -> None:
        """Rows at history times go to the history, those at selected times to pictures."""
        for k in np.flatnonzero(np.isin(rows.t, self.selected)):
            then = replace(self.state, t=float(rows.t[k]), p_WB=rows.p_WB[k], q_WB=rows.q_WB[k], v_WB=rows.v_WB[k])
            then = replace(then, w_WB=rows.w_WB[k], fluid=self._liquid_at(float(rows.t[k])))
            self.snapshots.write(then, full=False)
        wanted = np.isin(rows.t, self.history_times) | (rows.t == 0.0)
        if wanted.any():
            self.last_rows = rows if wanted.all() else rows.only(wanted)
            self.history.write(self.last_rows)

    def _liquid_at(self, t: float) -> object | None:
        """The Flow with F at a time in the step just made, linear in it: the old F is the Liquid's scratch."""
        flow, liquid = self.state.fluid, self.world.liquid
        if flow is None or flow.F is None:
            return flow
        share = (self.state.t - t) / flow.dt
        return replace(flow, F=share * liquid.F + (1.0 - share) * flow.F)

    def _note_impacts(self, impacts: np.ndarray) -> None:
        self.history.write_impacts(impacts)
        self._count(impacts)

    def _count(self, impacts: np.ndarray) -> None:
        """Add impacts to the sums of the final table."""
        self.limits += int((impacts["b"] == 0).sum())
        sizes = np.linalg.norm(impacts["impulse"], axis=1)
        for side in ("a", "b"):
            for number in np.unique(impacts[side][impacts[side] > 0]):
                mine = impacts[side] == number
                entry = self.per_body.setdefault(self.model.bodies[number - 1].name, {"count": 0, "impulse": 0.0})
                entry["count"] += int(impacts["count"][mine].sum())
                entry["impulse"] += float(sizes[mine].sum())

    def _save(self) -> None:
        self.history.flush()
        write_restart(self.folder / "restart.h5", self.model, self.state)
        self.last_restart = time.perf_counter()

    def finish(self, code: int, reason: str) -> None:
        """Close the files and say how it went. After a failure the state is the last good one."""
        self.code = code
        self._save()
        self.history.close()
        summary = self._summary(code, reason)
        write_run_json(self.folder / "run.json", summary)
        self.log.footer(summary)  # last: the terminal may be gone
        self.log.close()

    def abandon(self, error: OutputError) -> None:
        """Nothing more can be written: say why, and leave what was written, with the last good restart file."""
        self.code = FAILED
        with suppress(Exception):  # the disk may be full for these too
            self.log.footer(self._summary(FAILED, str(error)))
        self.close_quietly()
        with suppress(Exception):
            write_run_json(self.folder / "run.json", self._summary(FAILED, str(error)))
        print(f"flowgmo: {error}", file=sys.stderr)

    def close_quietly(self) -> None:
        """An error that is not ours to explain: leave readable files."""
        for part in (self.history, self.log):
            with suppress(Exception):  # the first error is the one to report
                part.close()

    def _limits(self) -> list[str]:
        """What was met on the way that a user should know of."""
        stops = [f"{self.limits} stops met"] if self.limits else []
        collisions = self.world.collisions if hasattr(self, "world") else None
        return stops + (collisions.notices() if collisions is not None else [])

    def _summary(self, code: int, reason: str) -> dict:
        wall = time.perf_counter() - self.began
        parts = {**self.world.seconds, "output": self.writing} if hasattr(self, "world") else {}
        parts["set-up and rest"] = max(wall - sum(parts.values()), 0.0)
        energy = {name: float(values[-1]) for name, values in (self.last_rows.energy if self.last_rows else {}).items()}
        return {
            "status": STATUS[code],
            "reason": reason,
            "steps": self.state.step,
            "t": self.state.t,
            "cells": self.model.mesh.cells,
            "wall_seconds": wall,
            "effects": {name: {"seconds": s, "share": s / wall} for name, s in parts.items()},
            "peak_memory_bytes": _peak_memory(),
            "energy": energy,
            **self._liquid_summary(),
            "collisions": {"total": self.state.impacts, "per_body": self.per_body},
            "limits": self._limits(),
            "versions": versions(),
            "command_line": self.command_line,
        }

    def _liquid_summary(self) -> dict:
        """What run.json and the final table say of the liquid; {} in a dry scene, or where it did not begin."""
        world = getattr(self, "world", None)
        if world is None or world.watch is None or self.state.fluid is None:
            return {}
        from flowgmo.step import liquid_values

        values = liquid_values(world, self.state)
        names = ("volume", "volume_error", "kinetic_energy", "potential_energy")
        shown = {name: values[f"fluid/{name}"] for name in names if f"fluid/{name}" in values}
        return {"volume_error": shown.get("volume_error"), "liquid": shown | world.liquid.tally.summary()}


def _between(times: np.ndarray, t0: float, t1: float) -> np.ndarray:
    """The times in (t0, t1]."""
    a, b = np.searchsorted(times, [t0, t1], side="right")
    return times[a:b]


def _apart_from(times: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Those of `others` that are not, up to rounding, among `times` (not empty, ascending)."""
    after = np.clip(np.searchsorted(times, others), 1, len(times) - 1) if len(times) > 1 else np.zeros(len(others), int)
    gap = np.minimum(np.abs(others - times[after]), np.abs(others - times[after - 1]))
    return others[gap > 1e-9 * times[-1]]


def _kernels_cached() -> bool:
    """Whether any compiled kernel of this version lies on disk."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    return folder is not None and any(Path(folder).rglob("*.nbc"))


def _bound(intervals: object, t: float) -> float:
    """The value of an interval table that holds at t."""
    k = int(np.searchsorted(intervals.ends, t, side="right"))
    return float(intervals.spacing[min(k, len(intervals.spacing) - 1)])


def _peak_memory() -> int:
    """Bytes this process held at most."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


@contextmanager
def stopping_on_signals(job: Job) -> Iterator[None]:
    """Ctrl-C, a polite kill and a closed terminal end the run after the step in progress; a second one at once."""

    def ask(number: int, frame: object) -> None:
        if job.stop_asked:
            os._exit(INTERRUPTED)
        job.stop_asked = True

    wanted = [signal.SIGINT, signal.SIGTERM]
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) == signal.SIG_DFL:  # nohup ignores it: so do we
        wanted.append(signal.SIGHUP)
    old = {s: signal.signal(s, ask) for s in wanted}
    try:
        yield
    finally:
        for s, handler in old.items():
            signal.signal(s, handler)
