"""The command `flowgmo`: arguments only.

Exit codes: 0 done, 1 the run failed, 2 the deck or the command line is wrong, 130 interrupted. No traceback reaches a
user: what is not foreseen is reported in one line, and whole with FLOWGMO_DEBUG=1.
"""

from __future__ import annotations

import os
import shlex
import signal
import sys
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

import flowgmo

FAILED, WRONG, INTERRUPTED = 1, 2, 130
RESULTS = "Results folder [DECK's name with .out in place of .nml; with --restart the folder of FILE]."


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(flowgmo.__version__, prog_name="flowgmo")
def cli() -> None:
    """Rigid bodies that fall, float, are driven and collide in water, from FLOW-3D style decks."""


@cli.command()
@click.argument("deck", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help=RESULTS)
@click.option("--overwrite", is_flag=True, help="Replace the results in the folder.")
@click.option("--restart", type=click.Path(path_type=Path), metavar="FILE", help="Go on from RESULTS/restart.h5.")
@click.option("--threads", type=click.IntRange(1), help="Threads [all cores]; the results do not depend on it.")
def run(deck: Path, output: Path | None, overwrite: bool, restart: Path | None, threads: int | None) -> None:
    """Compute the scene of a deck.

    Exit codes: 0 done, 1 the run failed, 2 the deck or the command line is wrong, 130 interrupted (go on with
    --restart).
    """
    from flowgmo.building import build_model
    from flowgmo.deck import read_deck
    from flowgmo.results_folder import prepare_folder
    from flowgmo.run import run as compute

    if threads:
        os.environ["NUMBA_NUM_THREADS"] = str(threads)
    read = read_deck(deck)
    folder = output or (restart.parent if restart else deck.with_suffix(".out"))
    model = build_model(read, folder)
    if restart and not restart.is_file():
        raise flowgmo_error(f"there is no restart file {restart}")
    prepare_folder(folder, overwrite, restart is not None)
    sys.exit(compute(model, folder, restart, shlex.join(["flowgmo", *sys.argv[1:]])))


@cli.command()
@click.argument("deck", type=click.Path(path_type=Path))
def check(deck: Path) -> None:
    """Say what is wrong with a deck, or what it would compute: bodies, effects, cells, memory, time."""
    from flowgmo.building import build_model
    from flowgmo.check import summary
    from flowgmo.deck import read_deck

    for part in summary(build_model(read_deck(deck))):
        _console().print(part)


@cli.command()
@click.argument("name", required=False)
def explain(name: str | None) -> None:
    """Explain a deck variable (default, unit, range); without a name, list all by block."""
    from flowgmo.deck.explain import explain as row
    from flowgmo.deck.explain import explain_all

    if name is None:
        click.echo(explain_all())
        return
    try:
        click.echo(row(name))
    except KeyError as error:
        near = f"Near it: {', '.join(error.args)}" if error.args else "flowgmo explain lists all"
        raise flowgmo_error(f"there is no variable {name}. {near}") from None


def flowgmo_error(text: str) -> Exception:
    """An error of the command line, exit code 2."""
    from flowgmo.errors import FlowgmoError

    return FlowgmoError(text)


def _console() -> object:
    from rich.console import Console

    return Console(highlight=False, soft_wrap=True)


def _say(text: str) -> None:
    """One error line on standard error, red on a terminal only."""
    click.secho(text, err=True, fg="red" if sys.stderr.isatty() else None)


def _prepare_streams() -> None:
    """Signs that the terminal's encoding lacks become '?', and numpy's warnings about overflow stay inside."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    if not os.environ.get("FLOWGMO_DEBUG"):
        warnings.simplefilter("ignore", RuntimeWarning)


def _without_reader() -> None:
    """Who read our output is gone (`flowgmo explain | head`): nothing more to say, also at the very end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(FAILED)


@contextmanager
def _leaving_on_ctrl_c() -> Iterator[None]:
    """Ctrl-C while nothing has been computed ends at once: libraries that load or write turn KeyboardInterrupt into
    errors of their own. A run brings its own handler (run.py)."""

    def leave(number: int, frame: object) -> None:
        os.write(2, b"flowgmo: interrupted\n")
        os._exit(INTERRUPTED)

    old = signal.signal(signal.SIGINT, leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, old)


def main() -> None:
    """Entry point."""
    with _leaving_on_ctrl_c():
        _prepare_streams()
        _main()


def _main() -> None:
    """Turns every error into a text and an exit code."""
    from flowgmo.deck.errors import DeckError
    from flowgmo.errors import FlowgmoError

    try:
        cli(standalone_mode=False)
    except click.exceptions.Abort:
        sys.exit(INTERRUPTED)
    except click.ClickException as error:
        error.show()
        sys.exit(WRONG)
    except DeckError as error:
        for notice in error.notices:
            click.echo(f"notice: {notice}", err=True)
        for problem in error.problems:
            _say(str(problem))
        count = len(error.problems)
        click.echo(f"{count} problem{'s' if count > 1 else ''}, nothing was computed", err=True)
        sys.exit(WRONG)
    except FlowgmoError as error:
        _say(f"flowgmo: {error}")
        sys.exit(getattr(error, "code", WRONG))
    except MemoryError:
        _say("flowgmo: the machine's memory is not enough for this scene")
        sys.exit(FAILED)
    except BrokenPipeError:
        _without_reader()
    except OSError as error:
        _say(f"flowgmo: {error.filename or 'a file'}: {error.strerror or error}")
        sys.exit(FAILED)
    except Exception as error:
        if os.environ.get("FLOWGMO_DEBUG"):
            traceback.print_exc()
        _say(f"flowgmo: unforeseen error, please report it: {type(error).__name__}: {error}")
        sys.exit(FAILED)


if __name__ == "__main__":
    main()
