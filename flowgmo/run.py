"""A run: from a Model to its results folder. Steps, output, stops, signals; the physics is in step.py."""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.errors import StepFailed
from flowgmo.first_start import told_of_compilation
from flowgmo.model import Model
from flowgmo.output import (
    Fields,
    History,
    OutputError,
    RestartError,
    RunLog,
    Snapshots,
    read_restart,
    write_restart,
    write_run_json,
)
from flowgmo.output.errors import replacing
from flowgmo.output.history import impacts_until
from flowgmo.pace import Pace
from flowgmo.records import Rows
from flowgmo.run_summary import Summary
from flowgmo.state import State, initial_state
from flowgmo.stop_signals import INTERRUPTED, stopping_on_signals

if TYPE_CHECKING:
    from flowgmo.world import World

DONE, FAILED, WRONG = 0, 1, 2  # exit codes (DESIGN 8), with INTERRUPTED
MOST_LOST = 1e-6  # of the liquid's volume; round-off makes 1e-13 (DESIGN 4)
STATUS = {DONE: "done", FAILED: "failed", INTERRUPTED: "interrupted"}


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
        with stopping_on_signals(job), told_of_compilation(job.log.print):
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
        self.resume_at = resume_at
        self.code, self.stop_asked = DONE, False
        self.world: World | None = None
        self.summary = Summary(model, command_line)
        self.last_restart = time.perf_counter()
        if resume_at is not None:
            self.summary.count(impacts_until(folder, resume_at))
        self.log = RunLog(folder, resume_at=resume_at)
        self.history = History(folder, model, resume_at)
        self.snapshots = Snapshots(folder, model, resume_at)
        self.fields = Fields(folder, model, resume_at) if model.fluid is not None else None
        with replacing(folder / "deck.resolved.nml") as temporary:
            temporary.write_text(model.resolved_deck, encoding="utf-8")
        self.log.header(model)
        self.pace = Pace(model, state)

    def compute(self) -> None:
        """Step until the end, a stop, or an interrupt."""
        from flowgmo.rows import rows_of_state

        model, state = self.model, self.state
        if self.resume_at is None:
            from flowgmo.flow.observe.watch import at_once
            from flowgmo.step import liquid_values

            self._write_rows(rows_of_state(self.world, state, at_once(liquid_values(self.world, state))))
            self._write_snapshot(state)
        while state.t < model.clock.end and state.step < model.clock.last_step and not self.stop_asked:
            began_at = state.t
            report, landing = self.pace.advance(self.world)
            dt = state.t - began_at
            began = time.perf_counter()
            if report.rows is not None:
                self._write_rows(report.rows)
                _check_volume(report.rows)
            if len(report.impacts):
                self._note_impacts(report.impacts)
            if landing:
                self._write_snapshot(state)
                self._save()
            elif began - self.last_restart > model.output.restart_wall:
                self._save()
            liquid, impacts = self.world.liquid, state.impacts if self.world.collisions is not None else None
            of_liquid = (liquid.tally.iterations, liquid.tally.bounded_by) if liquid else ()
            self.log.progress(state.t, state.step, dt, impacts, *of_liquid)
            self.summary.writing += time.perf_counter() - began
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
        from flowgmo.step import poses_of, start_liquid

        start_liquid(self.world, self.state)
        wet = self.world.wet_bodies
        if wet is not None and wet.explicit is not None:
            for text in wet.explicit.compare_masses(self.state.fluid, poses_of(self.state), self.model.clock.dt):
                self.log.notice(text)

    def _write_snapshot(self, state: State) -> None:
        self.snapshots.write(state)
        if self.fields is not None:
            self.fields.write(state)

    def _write_rows(self, rows: Rows) -> None:
        """Rows at history times go to the history, those at selected times to pictures."""
        for k in np.flatnonzero(np.isin(rows.t, self.pace.selected)):
            then = replace(self.state, t=float(rows.t[k]), p_WB=rows.p_WB[k], q_WB=rows.q_WB[k], v_WB=rows.v_WB[k])
            then = replace(then, w_WB=rows.w_WB[k], fluid=self._liquid_at(float(rows.t[k])))
            self.snapshots.write(then, full=False)
        wanted = np.isin(rows.t, self.pace.history) | (rows.t == 0.0)
        if wanted.any():
            self.summary.last_rows = rows if wanted.all() else rows.only(wanted)
            self.history.write(self.summary.last_rows)

    def _liquid_at(self, t: float) -> object | None:
        """The Flow with F at a time in the step just made, linear in it: the old F is the Liquid's scratch."""
        flow, liquid = self.state.fluid, self.world.liquid
        if flow is None or flow.F is None:
            return flow
        share = (self.state.t - t) / flow.dt
        return replace(flow, F=share * liquid.F + (1.0 - share) * flow.F)

    def _note_impacts(self, impacts: np.ndarray) -> None:
        self.history.write_impacts(impacts)
        self.summary.count(impacts)

    def _save(self) -> None:
        self.history.flush()
        write_restart(self.folder / "restart.h5", self.model, self.state)
        self.last_restart = time.perf_counter()

    def finish(self, code: int, reason: str) -> None:
        """Close the files and say how it went. After a failure the state is the last good one."""
        self.code = code
        self._save()
        self.history.close()
        summary = self._table(code, reason)
        write_run_json(self.folder / "run.json", summary)
        self.log.footer(summary)  # last: the terminal may be gone
        self.log.close()

    def _table(self, code: int, reason: str) -> dict:
        return self.summary.table(self.state, self.world, STATUS[code], reason)

    def abandon(self, error: OutputError) -> None:
        """Nothing more can be written: say why, and leave what was written, with the last good restart file."""
        self.code = FAILED
        with suppress(Exception):  # the disk may be full for these too
            self.log.footer(self._table(FAILED, str(error)))
        self.close_quietly()
        with suppress(Exception):
            write_run_json(self.folder / "run.json", self._table(FAILED, str(error)))
        print(f"flowgmo: {error}", file=sys.stderr)

    def close_quietly(self) -> None:
        """An error that is not ours to explain: leave readable files."""
        for part in (self.history, self.log):
            with suppress(Exception):  # the first error is the one to report
                part.close()


def _check_volume(rows: Rows) -> None:
    """Raise StepFailed where the books of the liquid's volume do not close (DESIGN 4)."""
    errors = rows.liquid.get("fluid/volume_error")
    if errors is not None and np.abs(errors).max() > MOST_LOST:
        worst = float(errors[np.argmax(np.abs(errors))])
        raise StepFailed(
            f"the volume of the liquid is off by {worst:.2g} of itself at t = {rows.t[-1]:.6g}: some was lost or made. "
            "This is an error of the program; please send the deck to its authors"
        )
