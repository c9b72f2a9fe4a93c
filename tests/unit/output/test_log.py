"""run.log and the terminal: the same words, colours only where they belong, lines no faster than people read."""

import io

import pytest
from rich.console import Console

from flowgmo.output import OutputError, RunLog

SUMMARY = {
    "status": "done", "reason": "TWFIN reached", "steps": 200, "t": 2.0, "cells": 1000, "wall_seconds": 1.5,
    "effects": {"flight": {"seconds": 0.2, "share": 0.2}, "collisions": {"seconds": 0.8, "share": 0.8}},
    "peak_memory_bytes": 50 << 20,
    "energy": {"kinetic": 1.25, "impacts": 0.5},
    "collisions": {"total": 7, "per_body": {"ball": {"count": 7, "impulse": 3.5}}},
    "limits": ["ball reached zmax"],
}  # fmt: skip


class Wall:
    """A clock that tests turn by hand."""

    now = 0.0

    def __call__(self):
        return self.now


def terminal(is_terminal):
    return Console(file=io.StringIO(), width=120, force_terminal=is_terminal)


def run(scenes, folder, console, wall=None, **more):
    log = RunLog(folder, console, clock=wall or Wall(), **more)
    log.header(scenes.all_kinds())
    return log


@pytest.mark.parametrize("is_terminal", [True, False])
def test_the_file_has_every_word_and_no_colour(scenes, tmp_path, is_terminal):
    wall, console = Wall(), terminal(is_terminal)
    log = run(scenes, tmp_path, console, wall)
    for k in range(40):
        wall.now = 0.5 * k
        log.progress(0.05 * k, k, 1e-3, k // 2)
    log.footer(SUMMARY)
    log.close()
    text, shown = (tmp_path / "run.log").read_text(), console.file.getvalue()
    assert "\x1b" not in text
    assert ("\x1b" in shown) == is_terminal
    for word in ("A ball bounces", "1,000 cells", "piston", "prescribed", "fixed axis", "0.3 about the axis", "ICLID=1",
                 "IFVOF 5 means 6", "done: TWFIN reached", "200 steps", "80.0 %", "impacts",
                 "3.5", "ball reached zmax", "50 MiB", "symmetry"):  # fmt: skip
        assert word in text, word
    assert "volume error" not in text
    assert max(len(line) for line in text.splitlines()) <= 120


def test_plain_lines_keep_to_the_decks_interval_and_to_two_seconds(scenes, tmp_path):
    wall, console = Wall(), terminal(False)
    log = run(scenes, tmp_path, console, wall)
    before = len(console.file.getvalue())
    for k in range(1000):  # 10 log times in the run; a millisecond of wall time for each step, then a second
        wall.now += 1e-3 if k < 500 else 0.01
        log.progress(2.0 * (k + 1) / 1000, k, 1e-3, 0)
    lines = [line for line in console.file.getvalue()[before:].splitlines() if line.startswith("t ")]
    assert 2 <= len(lines) <= 4
    assert lines == [line for line in (tmp_path / "run.log").read_text().splitlines() if line.startswith("t ")]
    log.close()


def test_a_plain_line_fits_a_narrow_terminal(scenes, tmp_path):
    wall, console = Wall(), Console(file=io.StringIO(), width=80)
    log = run(scenes, tmp_path, console, wall)
    wall.now = 45296.0
    log.progress(1.23456, 123456, 1.2345e-4, 12345, 12)
    log.close()
    (line,) = [line for line in console.file.getvalue().splitlines() if line.startswith("t 1.23456")]
    assert line.endswith("wall 12:34:56")


@pytest.mark.parametrize(("impacts", "told"), [(None, True), (12345, False)])
def test_a_plain_line_says_what_bounds_the_step_where_it_has_room(scenes, tmp_path, impacts, told):
    console = Console(file=io.StringIO(), width=80)
    log = run(scenes, tmp_path, console)
    log.progress(1.23456, 123456, 1.2345e-4, impacts, 12, "largest step")
    log.close()
    (line,) = [line for line in console.file.getvalue().splitlines() if line.startswith("t 1.23456")]
    assert ("by largest step wall" in line) == told and line.endswith("wall 0:00:00")


def test_the_bar_is_for_terminals_and_long_runs(scenes, tmp_path):
    for is_terminal, wall_step, wanted in ((True, 1.0, True), (True, 0.001, False), (False, 1.0, False)):
        wall, console = Wall(), terminal(is_terminal)
        log = run(scenes, tmp_path, console, wall)
        for k in range(1, 20):
            wall.now = k * wall_step
            log.progress(0.1 * k, k, 1e-3, 5)
        log.close()
        assert ("━" in console.file.getvalue()) == wanted


def test_names_of_the_user_are_not_markup(scenes, tmp_path):
    log = RunLog(tmp_path, terminal(False))
    log.header(scenes.build([], title="[bold]A [red title", notices=("see [/x] there",)))
    log.close()
    text = (tmp_path / "run.log").read_text()
    assert "[bold]A [red title" in text and "see [/x] there" in text


def test_a_continued_run_appends(scenes, tmp_path):
    run(scenes, tmp_path, terminal(False)).close()
    first = (tmp_path / "run.log").read_text()
    run(scenes, tmp_path, terminal(False), resume_at=0.5).close()
    text = (tmp_path / "run.log").read_text()
    assert text.startswith(first) and "continued at t = 0.5" in text


def test_many_bodies_do_not_flood_the_log(scenes, tmp_path):
    log = RunLog(tmp_path, terminal(False))
    log.header(scenes.build([scenes.ball(k + 1, f"b{k}", [k, 0, 0]) for k in range(200)]))
    log.close()
    text = (tmp_path / "run.log").read_text()
    assert "… and 160 more" in text and len(text.splitlines()) < 80


def test_a_log_that_cannot_be_opened(tmp_path):
    (tmp_path / "run.log").mkdir()
    with pytest.raises(OutputError, match=r"run\.log"):
        RunLog(tmp_path)


class GoneTerminal(io.StringIO):
    """A terminal whose window has been closed: every write fails like the system call does."""

    def write(self, text):
        raise OSError(5, "Input/output error")

    def isatty(self):
        return True


def test_a_run_outlives_its_terminal(scenes, tmp_path):
    """Fails if a closed window ends the run: everything still goes to run.log, the bar included."""
    wall = Wall()
    log = run(scenes, tmp_path, Console(file=GoneTerminal(), force_terminal=True), wall)
    for k in range(40):
        wall.now = 0.5 * k
        log.progress(0.05 * k, k, 1e-3, k // 2)
    log.footer(SUMMARY)
    log.close()
    assert "done" in (tmp_path / "run.log").read_text()
