"""The log: everything the user sees on the terminal also stands in run.log, there without colours.

On a terminal a bar shows how far a long run is; elsewhere plain lines do, at the deck's intervals but not faster than
people read. run.log always gets the plain lines.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console, RenderableType
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.text import Text

from flowgmo.model import Model
from flowgmo.output import log_tables as tables
from flowgmo.output.errors import make_folder, writing
from flowgmo.output.software import versions

WIDTH = 110  # columns of run.log
BAR_AFTER = 1.0  # s of wall time: shorter runs need no bar
BAR_EVERY = 0.2  # s of wall time between two pictures of the bar
LINE_EVERY = 2.0  # s of wall time between two plain lines
LINE_WIDTH = 80  # columns of a plain line


class Screen(Console):
    """The terminal. A run goes on when nobody reads it any more (`flowgmo run deck.nml | head`)."""

    def on_broken_pipe(self) -> None:
        self.quiet = True
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what Python flushes at its end


class RunLog:
    """The log of one run. `resume_at`: append to run.log. `clock` gives wall time [s] (tests bring their own)."""

    def __init__(
        self,
        folder: Path,
        console: Console | None = None,
        resume_at: float | None = None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.path = make_folder(Path(folder)) / "run.log"
        self.console = console or Screen(highlight=False)
        self._clock = clock
        self._start = clock()
        self._resumed = resume_at
        self._bar: Progress | None = None
        self._terminal_gone = False
        self._next_bar = self._start + BAR_AFTER
        self._last_line = -np.inf
        self._line_times = np.zeros(0)
        self._end = np.nan
        self._units = ""
        with writing(self.path):
            self._text = self.path.open("w" if resume_at is None else "a", encoding="utf-8")
        self._file = Console(file=self._text, width=WIDTH, color_system=None, force_terminal=False, highlight=False)

    def print(self, *what: RenderableType) -> None:
        """Print text (rich markup) or a table, on the terminal and in the file."""
        self._on_terminal(self.console.print, *what)
        self._print_to_file(*what)

    def _on_terminal(self, action: Callable, *what: object) -> None:
        """Do something on the terminal; a run goes on when its terminal is gone (closed window, lost connection)."""
        if self._terminal_gone:
            return
        try:
            action(*what)
        except OSError:
            self._terminal_gone = True
            self._bar = None

    def _print_to_file(self, *what: RenderableType) -> None:
        with writing(self.path):
            self._file.print(*what)
            self._text.flush()

    def header(self, model: Model) -> None:
        """What will be computed: title, domain, bodies, effects, and the notices of the deck."""
        self._end, self._units = model.clock.end, model.units
        self._line_times = model.output.log.times(model.clock.end)
        self.print(tables.title(model, versions().get("flowgmo", "")))
        self.print(tables.domain(model))
        if model.bodies:
            self.print(tables.bodies(model))
        self.print(tables.effects(model))
        for notice in model.notices:
            self.print(tables.notice(notice))
        if self._resumed is not None:
            self.print(f"continued at t = {self._resumed:.6g}")
        self.print("")

    def notice(self, text: str) -> None:
        """Print what the user should know before the run goes on."""
        self.print(tables.notice(text))

    def progress(
        self, t: float, step: int, dt: float, impacts: int | None, solution: int | None = None, bounded_by: str = ""
    ) -> None:
        """Say how far the run is. For every step: with nothing to say it costs less than a microsecond.

        impacts so far, None where nothing collides; solution: iterations of the step's pressure, None in a dry scene;
        bounded_by: what bounded the step, told where the line has room for it.
        """
        now = self._clock()
        if now >= self._next_bar and self.console.is_terminal:
            self._next_bar = now + BAR_EVERY
            self._on_terminal(self._draw_bar, t, step, dt, impacts, solution)
        if now - self._last_line < LINE_EVERY or not self._line_due(t):
            return
        self._last_line = now
        line = f"t {t:<9.6g} step {step:<6} dt {dt:<8.3g} "  # all of it within LINE_WIDTH
        line += "" if solution is None else f"iterations {solution:<3} "
        line += "" if impacts is None else f"impacts {impacts:<5} "
        wall, by = f"wall {_wall(now - self._start)}", f"by {bounded_by:<12} "
        line += by if bounded_by and len(line + by + wall) <= LINE_WIDTH else ""
        line += wall
        self._print_to_file(Text(line))
        if not self.console.is_terminal:
            self._on_terminal(self.console.print, Text(line))

    def _line_due(self, t: float) -> bool:
        """Whether a log time has been passed since the last line; those passed are used up."""
        if len(self._line_times) == 0 or t < self._line_times[0]:
            return False
        passed = int(np.searchsorted(self._line_times, t, side="right"))
        self._line_times = self._line_times[passed:]
        return True

    def _draw_bar(self, t: float, step: int, dt: float, impacts: int | None, solution: int | None) -> None:
        if self._bar is None:
            self._bar = Progress(
                BarColumn(bar_width=28),
                TextColumn("{task.percentage:3.0f} %  {task.description}"),
                TimeRemainingColumn(compact=True),
                console=self.console,
                auto_refresh=False,  # no thread beside the solver
                transient=True,
            )
            self._bar.start()
            self._task = self._bar.add_task("", total=self._end, completed=self._resumed or 0.0)
        what = f"t {t:.4g} of {self._end:.4g}   step {step}   dt {dt:.3g}   "
        what += "" if solution is None else f"{solution} iterations   "
        what += ("" if impacts is None else f"{impacts} impacts   ") + "left"
        self._bar.update(self._task, completed=t, description=what)
        self._bar.refresh()

    def footer(self, summary: dict) -> None:
        """What was computed and what it cost; `summary` as in summary.write_run_json."""
        self._end_bar()
        for part in tables.footer(summary, self._units):
            self.print(part)

    def _end_bar(self) -> None:
        if self._bar is not None:
            self._on_terminal(self._bar.stop)
            self._bar = None

    def close(self) -> None:
        """End the bar and close the file."""
        self._end_bar()
        with writing(self.path):
            self._text.close()


def _wall(seconds: float) -> str:
    minutes, seconds = divmod(seconds, 60)
    hours, minutes = divmod(int(minutes), 60)
    return f"{hours:d}:{minutes:02d}:{int(seconds):02d}"
