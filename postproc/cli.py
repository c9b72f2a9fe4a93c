"""flowgmo-postproc: curves, pictures, and a report from the results of a run. Arguments only."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path

import click

from postproc.errors import PostprocError


class Told(click.ClickException):
    """One line on stderr and an exit code."""

    def __init__(self, text: str, code: int) -> None:
        super().__init__(" ".join(text.split()))
        self.exit_code = code


def told(command: Callable) -> Callable:
    """No traceback reaches the user."""

    @wraps(command)
    def run(**arguments: object) -> None:
        try:
            command(**arguments)
        except BrokenPipeError:  # who read our output is gone (`... --list | head`)
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(1)
        except PostprocError as error:
            raise Told(str(error), error.exit_code) from error
        except click.ClickException:
            raise
        except Exception as error:  # a fault of ours or of a library; still one line
            raise Told(f"{type(error).__name__}: {error}", 1) from error

    return run


def notice(text: str) -> None:
    click.echo(f"notice: {text}", err=True)


VIEW = click.option(
    "--view",
    type=click.Choice(["iso", "x", "y", "z"]),
    default="iso",
    show_default=True,
    help="From a corner, or along an axis.",
)
RESULTS = click.argument("results", type=click.Path(path_type=Path))


def output(default: str) -> Callable:
    return click.option("-o", "--output", type=click.Path(path_type=Path), help=f"File to write [RESULTS/{default}].")


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def main() -> None:
    """Curves, pictures and reports from RESULTS, the folder that `flowgmo run` made.

    Times and places are in the deck's units; [brackets] hold defaults.
    """


@main.command()
@RESULTS
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@output("plot.png")
@click.option("--body", help="Body, for quantities given without one: position instead of bodies/NAME/position.")
@click.option("--component", type=click.Choice(["w", "x", "y", "z"]), help="Only this component of vectors.")
@click.option("--list", "listing", is_flag=True, help="List the quantities and leave.")
@told
def plot(
    results: Path,
    quantities: tuple[str, ...],
    output: Path | None,
    body: str | None,
    component: str | None,
    listing: bool,
) -> None:
    """Draw quantities of the history against time.

    A QUANTITY is for instance bodies/ball/position, or energy/kinetic, or position: that of every body.
    """
    from postproc.results import Results

    read = Results(results)
    if listing:
        for name in read.quantities:
            curve_unit = read.file[name].attrs.get("unit", "")
            click.echo(f"{name:44} {'' if curve_unit == '1' else curve_unit}".rstrip())
        return
    if not quantities:
        raise Told("which quantity? --list shows what there is", 2)
    read.file  # noqa: B018 (a missing or damaged history is told before matplotlib loads)
    from postproc.plot import plot as draw_plot

    click.echo(draw_plot(read, list(quantities), output or read.folder / "plot.png", body, component))


@main.command()
@RESULTS
@click.option("--time", "t", type=float, help="Time of the picture [the end].")
@output("picture.png")
@VIEW
@click.option("--size", default="1200,900", show_default=True, metavar="W,H", help="Pixels.")
@click.option("--colour", type=click.Choice(["name", "speed"]), default="name", show_default=True, help="Of bodies.")
@told
def picture(results: Path, t: float | None, output: Path | None, view: str, size: str, colour: str) -> None:
    """Draw bodies and the liquid's surface at one time.

    The surface is that of the nearest snapshot (TAPLTD).
    """
    from postproc.pictures import draw
    from postproc.results import Results
    from postproc.scene import Scene

    read = Results(results)
    scene = Scene(read)
    t = scene.end if t is None else t
    if not scene.times[0] <= t <= scene.end:
        raise Told(f"time {t:g} is outside of the run, {scene.times[0]:g} … {scene.end:g}", 2)
    path = output or read.folder / "picture.png"
    draw(read, [(t, path)], view, _pixels(size), colour, notice=notice)
    click.echo(path)


@main.command("slice")
@RESULTS
@click.option("--time", "t", type=float, help="Time; the nearest snapshot is drawn [the end].")
@click.option("--axis", type=click.Choice(["x", "y", "z"]), help="The slice lies across it [the shortest side].")
@click.option("--at", "position", type=float, help="Where on that axis [the middle].")
@output("slice.png")
@told
def slice_(results: Path, t: float | None, axis: str | None, position: float | None, output: Path | None) -> None:
    """Draw fraction, pressure, speed of the liquid in a plane.

    Bodies and solids lie over it, the mesh is seen beside them. Fields are those of the nearest snapshot (TPLTD).
    """
    from postproc.slices import draw_slice

    if not results.is_dir():
        raise Told(f"there is no results folder {results}", 2)
    number = None if axis is None else "xyz".index(axis)
    click.echo(draw_slice(results, output or results / "slice.png", t, number, position, notice))


def _pixels(text: str) -> tuple[int, int]:
    try:
        width, height = (int(number) for number in text.lower().replace("x", ",").split(","))
    except ValueError:
        raise Told(f"--size takes two whole numbers such as 1200,900, not {text!r}", 2) from None
    if not (16 <= width <= 8192 and 16 <= height <= 8192):  # 8192: what software renderers still do
        raise Told(f"--size must lie between 16 and 8192 pixels, not {text}", 2)
    return width, height


@main.command()
@RESULTS
@output("report.png")
@told
def report(results: Path, output: Path | None) -> None:
    """Draw the whole run in one figure.

    Pictures at a few times, the motion of up to six bodies, of four out of a crowd (or how they turn), energy or what a
    drive must push, and the first impacts; of a liquid its surface, loads on the bodies, gauges, energy, volume.
    """
    from postproc.results import Results

    read = Results(results)
    read.file  # noqa: B018 (a missing or damaged history is told before matplotlib loads)
    from postproc.report import report as draw_report

    click.echo(draw_report(read, output or read.folder / "report.png", notice))


@main.command()
@RESULTS
@output("movie.gif")
@click.option("--frames", type=click.IntRange(2, 10000), default=60, show_default=True, help="Over the whole run.")
@click.option("--rate", type=click.FloatRange(1, 60), default=20, show_default=True, help="Frames a second.")
@VIEW
@click.option("--size", default="640,480", show_default=True, metavar="W,H", help="Pixels.")
@told
def movie(results: Path, output: Path | None, frames: int, rate: float, view: str, size: str) -> None:
    """Draw a movie: a GIF, or with -o FOLDER numbered pictures."""
    from postproc.movie import movie as draw_movie
    from postproc.results import Results

    read = Results(results)
    path = output or read.folder / "movie.gif"
    click.echo(draw_movie(read, path, frames, rate, view, _pixels(size), notice))


if __name__ == "__main__":
    main()
