"""Damaged decks: whatever happens to the text of a deck, it ends in a Model or a DeckError, in less than 1 s.

The damage is what editors, file transfers, and tired people do: flipped bytes, lost, doubled, and swapped lines and
characters, a cut end, garbage in between. A crash here would be a traceback before a user's eyes.
"""

import random
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from flowgmo.building import build_model
from flowgmo.deck import DeckError, read_deck
from flowgmo.model import Model

COLLISIONS = """Two bricks above a floor, dry
 &xput
  remark='!! bricks', twfin=2.0, delt=1e-3, gz=-9.81, imobs=1, iclid=1, strngmob=0.5, frcmob=0.3,
  tpltd(1)=0.5, thpltd(1)=0.01,
 /
 &flowgmo
  touch=1e-8, hertz=1.0, sleep=.false.
 /
 &bcdata
  ibct(1)=1, ibct(2)=1, ibct(3)=1, ibct(4)=1, ibct(5)=2, ibct(6)=3,
 /
 &mesh
  px=0.,1., nxcelt=10, py=0.,1., nycelt=10, pz=0.,2., nzcelt=20,
 /
 &obs
  nobs=2, imo=4,4, rhomvb=2*2000.,
  obsid(1)='low', iob(1)=1, xl(1)=.4, xh(1)=.6, yl(1)=.4, yh(1)=.6, zl(1)=.5, zh(1)=.6,
  obsid(2)='high', iob(2)=2, xl(2)=.45, xh(2)=.65, yl(2)=.4, yh(2)=.6, zl(2)=.8, zh(2)=.9,
  wtobs(1,2)=-1.0, crstrng(2)=.6, iclidob(1,2)=1,
 /
"""

DRIVEN = """A driven crank and a pendulum, dollar blocks
 $xput
  twfin=10., gz=-9.81, imobs=1,
 $end
 $mesh
  px(1)=0., px(2)=3., px(3)=5., nxcell(1)=12, nxcell(2)=8, py(1)=0., py(2)=.5, pz(1)=0., pz(2)=1.,
 $end
 $obs
  nobs=3,
  obsid(1)='crank', imo(1)=3, imoaxs(1)=2, xaxs0(1)=1., zaxs0(1)=.5,
  tobs(1:3)=0., 1., 2., omytobs(1:3,1)=0., 3.1415, 0.,
  iob(1)=1, xl(1)=.9, xh(1)=1.1, zl(1)=.45, zh(1)=.55,
  obsid(2)='pendulum', imo(2)=4, imoaxs(2)=1, iprpmvb(2)=1, massmvb(2)=12., tjaxs(2)=.9,
  xmcmvb0(2)=3., ymcmvb0(2)=.25, zmcmvb0(2)=.3, anglmin(2)=45., anglmax(2)=45.,
  iob(2)=2, rsl(2)=.1, rsh(2)=.2, trnx(2)=3., trny(2)=.25, trnz(2)=.3,
  imo(3)=4, iprpmvb(3)=1, massmvb(3)=1., xmcmvb0(3)=4., ymcmvb0(3)=.2, zmcmvb0(3)=.7,
  tjmvb(3,1,1)=1., tjmvb(3,2,2)=1., tjmvb(3,3,3)=1., igf(3)=1, fxtobs(1,3)=1.,
  iob(3)=3, cx2(3)=1., cy2(3)=1., cz2(3)=1., cc(3)=-.01, trnx(3)=4., trny(3)=.2, trnz(3)=.7,
 $end
 &flowgmo axisx(2)=1., axisz(2)=1. /
"""

MINIMAL = """Nothing but a box
&xput /
&mesh /
"""

WET = """ Light box above a free surface
 second title line
 &xput
    twfin=2.0, itb=1, nmat=1, ifvof=4, ifvisc=1, gz=-9.81, imobs=1, iclid=1,
 /
 &limits
    eps=1.e-4, itmax=100,
 /
 &props
    units='si', fluid1='water', rhof=1000.0, mu1=1.e-3,
 /
 &bcdata
    ibct(5)=2, ibct(6)=5, pbct(1,6)=0.0, fbct(1,6)=0.0,
 /
 &mesh
    px(1)=0.0, px(2)=1.0, nxcelt=50, py(1)=0.0, py(2)=1.0, nycelt=50, pz(1)=0.0, pz(2)=1.2, nzcelt=60,
 /
 &obs
    nobs=1, obsid(1)='box', imo(1)=4, rhomvb(1)=600.0,
    iob(1)=1, xl(1)=0.40, xh(1)=0.60, yl(1)=0.40, yh(1)=0.60, zl(1)=0.70, zh(1)=0.90,
 /
 &fl
    iflinittyp=1, flht=0.5,
 /
 &details f3d_version_number='12', /
 free text after the last block
 #start tables:
 #fluid1:
 1.0 2.0
 #end start tables
"""

BALLS = """Balls, a ram and an anvil: all that can collide
 &xput
  twfin=2.0, delt=1e-3, gz=-9.81, imobs=1, iclid=1, strngmob=0.5, frcmob=0.3, tpltd(1)=0.5, thpltd(1)=0.01,
 /
 &bcdata
  ibct(1)=1, ibct(2)=1, ibct(3)=2, ibct(4)=2, ibct(5)=2, ibct(6)=3,
 /
 &mesh
  px=0.,.4,1., nxcell(1)=4, nxcell(2)=6, sizex(2)=.05, py=0.,1., nycelt=10, pz=0.,2., sizez(1)=.1, sizez(2)=.2,
 /
 &obs
  nobs=4, obsid(1)='one', imo(1)=4, rhomvb(1)=1000., iob(1)=1, rsh(1)=.1, trnx(1)=.3, trny(1)=.5, trnz(1)=.5,
  obsid(2)='two', imo(2)=4, iprpmvb(2)=1, massmvb(2)=2., xmcmvb0(2)=.3, ymcmvb0(2)=.5, zmcmvb0(2)=.8,
  tjmvb(2,1,1)=.01, tjmvb(2,2,2)=.01, tjmvb(2,3,3)=.01, iob(2)=2, rsh(2)=.1, trnx(2)=.3, trny(2)=.5, trnz(2)=.8,
  imo(3)=3, iob(3)=3, rsh(3)=.1, trnx(3)=.8, trny(3)=.5, trnz(3)=.5, iupre(3)=1, uamp(3)=.1, ufre(3)=2.,
  imo(4)=0, iob(4)=4, xl(4)=0., xh(4)=1., yl(4)=0., yh(4)=1., zl(4)=-.2, zh(4)=.1, roty(4)=0.,
  cfrc(1)=.2, crstrng(2)=.9, iclidob(1,3)=0,
 /
"""

DAM = """A column of water falls past a box, with a stream from the right
 &xput
  remark='a free surface, and what the sides bring', twfin=3.,
  gz=-9.81,
  itb=1, ifvisc=1, con=.45, ipdis=1, delt=1e-3,
  tpltd(1)=.5,
 /
 &props
  units='si', tunits='c',
  rhof=1000.,
  mu1=1e-3,
 /
 &bcdata
  remark='a stream from the right',
  ibct=2,6,4,4,2,5,
  fbct(1,6)=0., pbct(1,6)=0.,
  timbct=0.,1.,
  ubct(1,2)=-1.,-2.,
  ihpbct(2)=1, flhtbct(1,2)=.5,
 /
 &mesh
  px=0.,3.22, nxcelt=161,
  py=0.,1., nycelt=50,
  pz=0.,1., nzcelt=50,
 /
 &obs
  nobs=1, obsid(1)='box', iob(1)=1,
  ifrco(1)=1,
  xl(1)=.6635, xh(1)=.8245,
  yl(1)=.295, yh(1)=.698, zl(1)=0., zh(1)=.161,
 /
 &fl
  flht=.1, nfls=2,
  fxl(1)=1.992, fzh(1)=.55, ureg(1)=.1,
  fioh(2)=0, frsh(2)=.1, ftrnx(2)=2.5,
  fluidregionname(2)='bubble',
 /
 &grafic
  xloc(1)=.9, yloc(1)=.5, zloc(1)=.1,
 /
 &flowgmo
  planex(1)=1.5, planezh(1)=.5,
 /
 &parts
 /
"""

SEEDS = (COLLISIONS, DRIVEN, MINIMAL, WET, DAM)
BUILDABLE = (BALLS, COLLISIONS.replace("iclid=1", "iclid=0"), DRIVEN, MINIMAL, DAM)
GARBAGE = (
    "&",
    "/",
    "'",
    '"',
    "!",
    "$end",
    "&obs",
    "=",
    "(",
    "9999999999",
    "1e999",
    "nan",
    "\0",
    "é",
    "3*",
    ",,,",
    "imo(",
)


def damage(text: str, dice: random.Random) -> bytes:
    """The text after one to four accidents."""
    for _ in range(dice.randint(1, 4)):
        kind = dice.randrange(8)
        lines = text.split("\n")
        place, line = dice.randrange(max(1, len(text))), dice.randrange(len(lines))
        if kind == 0:
            text = (
                text[:place] + chr(ord(text[place : place + 1] or "a") ^ (1 << dice.randrange(7))) + text[place + 1 :]
            )
        elif kind == 1:
            text = "\n".join(lines[:line] + lines[line + 1 :])
        elif kind == 2:
            text = "\n".join(lines[: line + 1] + lines[line:])
        elif kind == 3:
            text = text[:place]
        elif kind == 4:
            text = text[:place] + text[place : place + 2][::-1] + text[place + 2 :]
        elif kind == 5:
            text = text[:place] + dice.choice(GARBAGE) + text[place:]
        elif kind == 6:
            text = text[:place] + text[place + dice.randint(1, 5) :]
        else:
            other = dice.randrange(len(lines))
            lines[line], lines[other] = lines[other], lines[line]
            text = "\n".join(lines)
    raw = bytearray(text.encode("utf-8", "surrogatepass"))
    if raw and dice.random() < 0.1:
        raw[dice.randrange(len(raw))] = dice.randrange(256)
    return bytes(raw)


def read_and_build(path: Path) -> Model:
    """All that stands before a run."""
    return build_model(read_deck(path), path.with_suffix(".out"))


def check_damaged(
    count: int,
    folder: Path,
    read: Callable[[Path], object] = read_deck,
    first: int = 0,
    seeds: tuple[str, ...] = SEEDS,
) -> int:
    """Read `count` damaged decks; returns how many were still sound. `read` may be any later stage too."""
    path, sound = folder / "damaged.nml", 0
    for number in range(first, first + count):
        dice = random.Random(number)
        path.write_bytes(damage(dice.choice(seeds), dice))
        start = time.perf_counter()
        try:
            read(path)
            sound += 1
        except DeckError as error:
            assert error.problems, f"deck {number}: an error without a problem"
            assert all(str(problem) for problem in error.problems)
        except Exception as error:
            raise AssertionError(f"deck {number}: {error!r}\n{path.read_bytes()!r}") from error
        assert time.perf_counter() - start < 1.0, f"deck {number} took a second"
    return sound


@pytest.mark.parametrize("seed", SEEDS)
def test_undamaged(seed: str, tmp_path: Path) -> None:
    """The decks to be damaged are sound."""
    path = tmp_path / "deck.nml"
    path.write_text(seed)
    read_deck(path)


def test_500_damaged_decks(tmp_path: Path) -> None:
    """About a third survives the damage (remarks, digits, blanks); none crashes."""
    assert check_damaged(500, tmp_path) > 20


@pytest.mark.slow
def test_10000_damaged_decks(tmp_path: Path) -> None:
    """The same with other dice, twenty times as many."""
    check_damaged(10_000, tmp_path, first=1000)


@pytest.mark.parametrize("seed", BUILDABLE)
def test_undamaged_is_built(seed: str, tmp_path: Path) -> None:
    path = tmp_path / "deck.nml"
    path.write_text(seed)
    assert isinstance(read_and_build(path), Model)


def test_500_damaged_decks_are_built_or_refused(tmp_path: Path) -> None:
    """The full path to a Model: geometry, masses, contacts, mesh, output times (about 180 survived when written)."""
    assert check_damaged(500, tmp_path, read_and_build, first=20_000, seeds=BUILDABLE) > 20


@pytest.mark.slow
def test_10000_damaged_decks_are_built_or_refused(tmp_path: Path) -> None:
    check_damaged(10_000, tmp_path, read_and_build, first=30_000, seeds=BUILDABLE)
