"""Rules of the liquid: the deck that breaks each, and that it is the only thing said about that deck."""

import pytest

WET = "rhof=1000.,"
FREE = "twfin=1., itb=1, gz=-9.81,"  # a free surface
FULL = "twfin=1., gz=-9.81,"
STILL = "nobs=0"
HALF = "flht=.5"


@pytest.fixture
def wet(error):
    """The problems of a wet deck without bodies."""
    return lambda **blocks: error(**{"xput": FREE, "obs": STILL, "props": WET, **blocks}).problems


PROBLEMS = [
    # the start
    ({"fl": "iflinittyp=1"}, "iflinittyp=1", "the height of the liquid at the start is missing. Give flht in &fl"),
    ({"fl": "iflinittyp=2"}, "iflinittyp=2", "the volume of the liquid at the start is missing"),
    ({"fl": "vlin=.2", "xput": "itb=1"}, "vlin=0.2", "there is none. Give gz"),
    ({"fl": "nfls=1, fxl(2)=.5"}, "fxl(2)=0.5", "no region 2 of the liquid, nfls=1. Write nfls=2"),
    ({"fl": "flht=.5, fzh(1)=.5"}, "fzh(1)=0.5", "nfls=0"),
    # a surface, or none
    ({"xput": FULL, "fl": HALF}, "flht=0.5", "with itb=0 all open space is full. Write itb=1"),
    ({"xput": FULL, "fl": "vlin=.5"}, "vlin=0.5", "Write itb=1"),
    ({"xput": FULL, "fl": "nfls=2, fioh(2)=0"}, "fioh(2)=0", "Write itb=1"),
    ({"xput": FULL, "fl": "nfls=2, freg(2)=.5"}, "freg(2)=0.5", "Write itb=1"),
    ({"xput": FULL, "bcdata": "ibct(2)=5, fbct(1,2)=0."}, "fbct(1,2)=0.0", "Write itb=1"),
    ({"xput": FREE + "ifvof=0", "fl": HALF}, "ifvof=0", "this does not move it. Write ifvof=6"),
    # pressures
    ({"fl": HALF, "props": WET + "ipgauge=0"}, "ipgauge=0", "Write p_reference="),
    ({"fl": HALF + ", pvoid=1e5", "props": WET + "ipgauge=0", "bcdata": "ibct(6)=5"}, "ipgauge=0", "units='si'"),
    # sides
    ({"fl": HALF, "bcdata": "ibct(1)=2, ubct(1,1)=.5"}, "ubct(1,1)=0.5", "into the side Xmin"),
    ({"fl": HALF, "bcdata": "ibct(4)=2, vbct(1,4)=-.5"}, "vbct(1,4)=-0.5", "into the side Ymax"),
    ({"fl": HALF, "bcdata": "wbct(1,6)=.5"}, "wbct(1,6)=0.5", "Write ibct(6)=6"),
    (
        {"fl": HALF, "bcdata": "ibct(5)=2, timbct=0.,1., wbct(1,5)=0.,.1"},
        "wbct(2,5)=0.1",
        "which lets nothing through",
    ),
    ({"fl": HALF, "bcdata": "ibct(1)=5, ihpbct(1)=1"}, "ihpbct(1)=1", "Give flhtbct(1,1)"),
    ({"fl": HALF, "bcdata": "ibct(1)=6, timbct=0.,2.,1."}, "timbct(3)=1.0", "Let the times increase"),
    ({"fl": HALF, "bcdata": "ibct(1)=6, timbct=0.,2., ubct(1,1)=1.,2.,3."}, "ubct(3,1)=3.0", "3 values and 2 times"),
    ({"fl": HALF, "bcdata": "ibct(3)=4"}, "ibct(3)=4", "Ymin is periodic and Ymax is not"),
    ({"fl": HALF, "bcdata": "ibct(2)=11, flrbct(1,2)=1."}, "ibct(2)=11", "Write ibct(2)=1, 2, 3, 4, 5, 6 or 8, or run"),
    # values
    ({"fl": HALF, "props": "rhof=-1000."}, "rhof=-1000.", "must be > 0"),
    ({"fl": HALF, "props": "rhof=0."}, "rhof=0.", "must be > 0"),
    ({"fl": HALF, "props": WET + "mu1=-1."}, "mu1=-1.", "must be >= 0"),
    ({"fl": HALF, "xput": FREE + "iorder=2"}, "iorder=2", "not computed"),
    ({"fl": HALF, "xput": FREE + "con=0."}, "con=0.", "must be > 0"),
    ({"fl": HALF, "xput": FREE + "ifsft=1", "props": WET + "sigma=.07"}, "ifsft=1", "surface tension"),
    ({"fl": HALF, "xput": FREE + "fclean=.1"}, "fclean=0.1", "not computed"),
]

NOTICES = [
    ({"fl": HALF, "xput": "twfin=1., itb=1,"}, "itb=1", "gives no gravity. Give gz in &xput"),
    ({"fl": HALF, "props": WET + "units='metric'"}, "units='metric'", "Write units='si', 'cgs', 'eng', or 'cust'"),
    ({"fl": HALF, "props": WET + "units='cgs'"}, "gz=-9.81", "of the Earth in m/s^2, and the deck has units='cgs'"),
    ({"fl": HALF, "xput": "twfin=1., itb=1, gy=-981.", "props": WET + "units='SI'"}, "gy=-981.0", "units='cgs', or"),
    ({"fl": "flht=.5, iflinittyp=0, nfls=1"}, "flht=0.5", "no effect with iflinittyp=0. Write iflinittyp=1"),
    ({"fl": "flht=.5, vlin=.2"}, "vlin=0.2", "no effect with iflinittyp=1"),
    ({"fl": HALF, "bcdata": "ubct(1,3)=.5"}, "ubct(1,3)=0.5", "no effect at the side Ymin with ibct(3)=1"),
    ({"fl": HALF, "bcdata": "ibct(3)=5, vbct(1,3)=.5"}, "vbct(1,3)=0.5", "with ibct(3)=5"),
    ({"fl": HALF, "bcdata": "ibct(3)=2, ubct(1,3)=.5"}, "ubct(1,3)=0.5", "only with ifvisc=1 and iwsh=1"),
    ({"fl": HALF, "bcdata": "ibct(3)=6, pbct(1,3)=9."}, "pbct(1,3)=9.0", "no effect at the side Ymin"),
    ({"fl": HALF, "bcdata": "ibct(3)=8, fbct(1,3)=0."}, "fbct(1,3)=0.0", "no effect at the side Ymin"),
    ({"fl": HALF, "bcdata": "ibct(3)=5, flhtbct(1,3)=.4"}, "flhtbct(1,3)=0.4", "Write ihpbct(3)=1"),
    (
        {"fl": HALF, "bcdata": "ibct(3)=5, ihpbct(3)=1, flhtbct(1,3)=.4, fbct(1,3)=.5"},
        "fbct(1,3)=0.5",
        "which follows the height",
    ),
    (
        {"fl": HALF, "xput": FREE + "gx=1.", "bcdata": "ibct(3)=5, ihpbct(3)=1, flhtbct(1,3)=.4"},
        "ihpbct(3)=1",
        "gravity points elsewhere too",
    ),
]

SILENT = [
    {"fl": HALF},
    {"fl": "vlin=.3"},
    {"fl": "nfls=1, fzh(1)=.5"},
    {"fl": "nfls=1, fzh(1)=.5, fioh(2)=0", "props": ""},  # dry: regions do not act
    {"xput": FULL},
    {"xput": FULL, "fl": "flht=1., nfls=1, ureg(1)=2."},
    {"fl": HALF, "bcdata": "ibct(6)=5, fbct(1,6)=0., pbct(1,6)=0., flhtbct(1,6)=-1e8"},
    {"fl": HALF, "bcdata": "ibct(1)=6, timbct=0.,1., ubct(1,1)=0.,1., wbct(1,1)=.1, fbct(1,1)=1.,0."},
    {"fl": HALF, "bcdata": "ibct(1)=2, vbct(1,1)=.5", "xput": FREE + "ifvisc=1", "props": WET + "mu1=1."},
    {"fl": HALF, "bcdata": "ibct(1)=4,4"},
    {"fl": HALF, "props": WET + "units='cgs'", "xput": "twfin=1., itb=1, gz=-981."},
    {"fl": HALF, "props": WET + "units='cgs'", "xput": "twfin=1., itb=1, gz=-10.6"},
    {"fl": HALF, "props": WET + "units='cust'"},
    {"fl": HALF, "xput": "twfin=1., itb=1, gz=0.,"},
    {"fl": HALF, "props": WET + "ipgauge=0, units='si'"},
    {"fl": HALF + ", pvoid=1e5", "props": WET + "ipgauge=0", "bcdata": "ibct(6)=5, pbct(1,6)=1e5"},
    {"fl": HALF, "xput": FREE + "igmres=0, ifdynconv=0, epsi=1e-3, omega=1.7", "limits": "itmax=50"},
]


@pytest.mark.parametrize(("blocks", "variable", "part"), PROBLEMS)
def test_problem(wet, blocks: dict, variable: str, part: str) -> None:
    """Exactly one problem, at the variable."""
    problems = wet(**blocks)
    assert [problem.variable for problem in problems] == [variable], [str(problem) for problem in problems]
    assert part in str(problems[0])


@pytest.mark.parametrize(("blocks", "variable", "part"), NOTICES)
def test_notice(read, blocks: dict, variable: str, part: str) -> None:
    """Exactly one notice, and the deck is read."""
    notices = read(**{"xput": FREE, "obs": STILL, "props": WET, **blocks}).notices
    assert [notice.variable for notice in notices] == [variable], [str(notice) for notice in notices]
    assert part in str(notices[0])


@pytest.mark.parametrize("blocks", SILENT)
def test_silent(read, blocks: dict) -> None:
    deck = {"xput": FREE, "obs": STILL, "props": WET, **blocks}
    if not deck["props"]:
        deck["fl"] = ""
    assert read(**deck).notices == []


def test_a_table_from_a_file(read, wet, tmp_path) -> None:
    """What a file says counts like the deck's own values: into a wall, and as a height."""
    table = tmp_path / "u.csv"
    table.write_text("0 0.\n1 .3\n")
    into = {"fl": HALF, "bcdata": f"ibct(1)=2, fubct(1)='{table}', iubctc(1)=2"}
    assert [p.variable for p in wet(**into)] == [f"fubct(1)='{table}'"]
    height = f"ibct(1)=5, ihpbct(1)=1, fflhtbct(1)='{table}', iflhtbctc(1)=2"
    deck = read(xput=FREE, obs=STILL, props=WET, fl=HALF, bcdata=height)
    assert deck.notices == [] and deck.series("FLHTBCT", 1).y.tolist() == [0.0, 0.3]


@pytest.mark.parametrize(("fl", "mode"), [("flht=.5", 1), ("vlin=.5", 2), ("flht=.5, vlin=.5", 1), ("nfls=1", 0)])
def test_the_start_follows_what_is_given(read, fl: str, mode: int) -> None:
    """IFLINITTYP need not be written; where it is, it counts."""
    assert read(xput=FREE, obs=STILL, props=WET, fl=fl)["IFLINITTYP"] == mode
    assert read(xput=FREE, obs=STILL, props=WET, fl=fl + ", iflinittyp=0")["IFLINITTYP"] == 0


def test_ignoring_leaves_bodies_and_liquid(read) -> None:
    """Both are computed together."""
    ignore = {"flowgmo": "ignore_unsupported=.true.", "props": WET, "add_xput": "itb=1, gz=-9.81, ifsft=1", "fl": HALF}
    for deck in (read(**ignore), read(**ignore, obs="nobs=1, iob(1)=1, xl(1)=0.", xput="")):
        assert deck.given("RHOF")
        assert [notice.variable for notice in deck.notices] == ["ifsft=1"]
