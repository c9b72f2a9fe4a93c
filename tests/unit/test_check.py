"""`flowgmo check` of a wet deck: what the liquid is, what it needs, about how long it takes."""

import io
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from flowgmo.building import build_model
from flowgmo.check import summary
from flowgmo.deck import parse_deck

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))
from flowgmo_wet import FREE, FULL, wet


@pytest.fixture
def said():
    """What `check` prints, each run of blanks as one."""

    def check(**blocks):
        console = Console(file=io.StringIO(), width=200)
        for part in summary(build_model(parse_deck(wet(**blocks), Path("deck.nml")))):
            console.print(part)
        return " ".join(console.file.getvalue().split())

    return check


def test_the_liquid_and_its_sides(said):
    text = said(
        props="rhof=1000., mu1=.5,",
        xput=FREE + "ifvisc=1,",
        fl="flht=.5, nfls=2, fioh(2)=0, frsh(2)=.1,",
        bcdata="ibct=6,5,1,1,1,5, timbct=0.,1., ubct(1,1)=1.,2., fbct(1,6)=0., ihpbct(2)=1, flhtbct(1,2)=.4,",
    )
    assert "liquid of density 1000, viscosity 0.5; at the start up to z = 0.5, and region 1 (whole space), " in text
    assert "without region 2 (sphere, radius 0.1)" in text
    assert "Xmin: velocity (1, 0, 0), liquid fraction 1 of what enters, at t = 0 of 2 times" in text
    assert "Xmax: stagnation pressure 0 above the void's, liquid up to z = 0.4" in text
    assert "Zmax: stagnation pressure 0 above the void's, liquid fraction 0 of what enters" in text
    assert "no viscosity; at the start everywhere" in said(xput=FULL, fl="")


def test_cells_and_memory(said):
    """3000 cells, 24 x 14 x 19 with ghosts at 400 bytes."""
    text = said()
    assert "3000 cells, 33 % with liquid at the start" in text and "at most 2.44 MiB beside the program" in text
    assert "100 % with liquid" in said(xput=FULL, fl="") and "10 % with liquid" in said(fl="vlin=.3,")
    hollow = said(fl="flht=.75, nfls=1, fioh(1)=0, fxl(1)=.5, fxh(1)=1.5,")
    assert "25 % with liquid" in hollow  # what regions take away counts


@pytest.mark.parametrize(
    "steps, blocks",
    [
        (36, {}),  # level: waves alone, sqrt(.1 / (pi g)) = .057
        (283, {"fl": "nfls=1, fxh(1)=.5, fzh(1)=1.,"}),  # falls by 1: .45 .1 / (sqrt(2 g) 3/2) = .0068
        (283, {"fl": "nfls=1, fxh(1)=.5, fzh(1)=1.,", "xput": FREE.replace("gz", "gx=0., gz")}),
        (200, {"fl": "flht=.5, nfls=1, frsh(1)=.2, ftrnx(1)=1., ftrny(1)=.5, ftrnz(1)=.8,"}),  # a drop .5 above
        (200, {"fl": "flht=.5,", "bcdata": "ibct(1)=5, ihpbct(1)=1, flhtbct(1,1)=1.,"}),  # water stands .5 higher there
        (283, {"fl": "flht=.5,", "bcdata": "ibct(6)=5, fbct(1,6)=1.,"}),  # and comes in from above
        (36, {"fl": "flht=.5,", "bcdata": "ibct(6)=5, fbct(1,6)=0.,"}),
        (200, {"xput": FREE + "tdtmax(1)=.01,"}),
        (667, {"fl": "flht=.5, ui=10.,"}),  # .45 .1 / (10 3/2)
        (2000, {"xput": FREE + "autot=0., delt=1e-3,"}),
        (240, {"xput": FULL + "ifvisc=1,", "fl": "", "props": "rhof=2., mu1=.4,"}),  # .1^2 / (6 nu) = .0083
        (35, {"xput": FULL + "ifvisc=1, impvis=1, delt=.0571,", "fl": "", "props": "rhof=2., mu1=.4,"}),
    ],
)
def test_number_of_steps(said, steps, blocks):
    """Guessed from what bounds them; points that look for liquid lie .0375 apart in height."""
    text = said(**{"xput": FREE + "tdtmax(1)=.1,", **blocks})
    found = int(text.split("about ")[1].split(" steps")[0])
    assert found == pytest.approx(steps, rel=0.06)


def test_time(said):
    """One second to start, a step 2 ms and 1000 wet cells .9 us each: as the decks take, to a factor of 2."""
    text = said(xput=FREE + "autot=0., delt=1e-3,")
    assert "about 2000 steps" in text and "about 6.8 s of wall time on two cores" in text
    assert "about 4.5 s of wall time" in said(xput=FULL + "autot=0., delt=1e-3,", fl="")


def test_speeds_that_are_out_of_all_measure(said):
    """No division by a step of zero."""
    text = said(xput=FREE + "dtmin=0.,", fl="flht=.5, ui=1e308, vi=1e308,")
    assert "2147483647 steps" in text


def test_no_kernel_is_loaded(tmp_path):
    """A wet deck is checked as lightly as a dry one: neither numba nor scipy nor a picture library."""
    (tmp_path / "a.nml").write_text(wet(obs="nobs=1, iob(1)=1, zh(1)=.1,", fl="flht=.5, nfls=1, frsh(1)=.3,"))
    code = (
        "import sys; sys.argv = ['flowgmo', 'check', sys.argv[1]]\n"
        "from flowgmo.cli import main\n"
        "try:\n main()\nexcept SystemExit as end:\n assert not end.code, end.code\n"
        "heavy = {'numba', 'llvmlite', 'scipy', 'pyvista', 'vtk', 'vtkmodules', 'matplotlib', 'meshio'}\n"
        "print('loaded:', sorted(heavy & set(sys.modules)))"
    )
    out = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "a.nml")], capture_output=True, text=True, timeout=60
    )
    assert out.returncode == 0 and out.stdout.splitlines()[-1] == "loaded: []", out.stdout + out.stderr
