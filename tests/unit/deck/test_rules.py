"""Every rule: the deck that breaks it, and that it is the only thing said about that deck."""

import pytest

FREE = "nobs=1, imo(1)=4, iob(1)=1, xl(1)=.1, xh(1)=.2,"  # a free body without mass
WHOLE = FREE + "iprpmvb(1)=1, massmvb(1)=2., xmcmvb0(1)=0., ymcmvb0(1)=0., zmcmvb0(1)=0.,"
TENSOR = "tjmvb(1,1,1)=1., tjmvb(1,2,2)=1., tjmvb(1,3,3)=1.,"
TWO = "nobs=2, imo(1)=4, rhomvb(1)=1000., iob(1)=1, xl(1)=.1, xh(1)=.2, iob(2)=2, xl(2)=.3, xh(2)=.4,"

# What is wrong with the deck, the variable that is named, a part of the message.
PROBLEMS = [
    # known but not computed
    ({"add_xput": "nmat=2"}, "nmat=2", "known but not computed: number of fluids. Write nmat=1, or run without"),
    ({"add_xput": "ifsft=1"}, "ifsft=1", "surface tension"),
    ({"add_xput": "ifvis=3"}, "ifvis=3", "turbulence"),
    ({"add_xput": "iaccf=1"}, "iaccf=1", "accelerated"),
    ({"add_xput": "ifin=4"}, "ifin=4", "Write ifin=1"),
    ({"mesh": "icyl=1"}, "icyl=1", "cylindrical"),
    ({"more": "imo(1)=2", "obs": "nobs=1, iob(1)=1, xl(1)=0."}, "imo(1)=2", "Write imo(1)=0"),
    ({"more": "nsprp=1"}, "nsprp=1", "springs"),
    ({"more": "ifob(1)=-1"}, "ifob(1)=-1", "special component"),
    ({"more": "nevents_gmo(1)=2"}, "nevents_gmo(1)=2", "events"),
    ({"more": "ifspin(1)=1"}, "ifspin(1)=1", "spins in place"),
    ({"bf": "nbafs=1"}, "nbafs=1", "baffles"),
    ({"parts": "npxyz=1"}, "npxyz=1", "particles"),
    ({"bcdata": "ibct(3)=7"}, "ibct(3)=7", "Write ibct(3)=1"),
    ({"bcdata": "ibct(1)=9,10,11"}, "ibct(1)=9", "(and 2 more)"),
    # dry or wet
    ({"props": "rhof=1000.", "add_xput": "igmres=0"}, "igmres=0", "relaxation of the pressure with bodies"),
    ({"fl": "flht=.5"}, "flht=0.5", "rhof"),
    ({"fl": "vlin=.5"}, "vlin=0.5", "rhof"),
    ({"fl": "nfls=1"}, "nfls=1", "rhof"),
    ({"bcdata": "ibct(6)=5, fbct(1,6)=1."}, "fbct(1,6)=1.0", "rhof"),
    ({"bcdata": "ibct(1)=6, flhtbct(1,1)=.4"}, "flhtbct(1,1)=0.4", "rhof"),
    # motion
    ({"xput": "twfin=1."}, "imo(1)=4", "Write imobs=1"),
    ({"xput": "iclid=1", "obs": "nobs=0"}, "iclid=1", "collisions need imobs=1"),
    ({"flowgmo": "axisx(1)=1."}, "axisx(1)=1.0", "needs imoaxs(1)=1"),
    ({"flowgmo": "axisy(1)=0.", "more": "imoaxs(1)=1"}, "axisy(1)=0.0", "the direction of the axis is zero"),
    ({"flowgmo": "axisx(1)=1., axisy(1)=1.", "more": "imoaxs(1)=2"}, "axisx(1)=1.0", "needs imoaxs(1)=1"),
    ({"more": "imoaxs(1)=2, dxmcmax(1)=.3"}, "dxmcmax(1)=0.3", "limits of travel need imoaxs(1)=0"),
    ({"more": "anglmax(1)=30."}, "anglmax(1)=30.0", "need a fixed axis"),
    ({"more": "imoaxs(1)=4, anglmin(1)=30."}, "anglmin(1)=30.0", "need a fixed axis"),
    ({"more": "imoaxs(1)=2, iomycal(1)=0"}, "iomycal(1)=0", "Write imo(1)=3"),
    ({"more": "imoaxs(1)=4, iomxcal(1)=0, iomycal(1)=0, iomzcal(1)=0"}, "iomxcal(1)=0", "Write imo(1)=3"),
    # mass
    ({"obs": FREE}, "rhomvb(1)", "has no density"),
    ({"obs": FREE + "rhosub(1)=0."}, "rhomvb(1)", "has no density"),
    ({"obs": FREE + "massmvb(1)=2."}, "massmvb(1)=2.0", "Write iprpmvb(1)=1"),
    ({"obs": WHOLE.replace("massmvb(1)=2.", "") + TENSOR}, "massmvb(1)", "missing"),
    ({"obs": WHOLE.replace("zmcmvb0(1)=0.,", "") + TENSOR}, "zmcmvb0(1)", "missing"),
    ({"obs": WHOLE + TENSOR[16:]}, "tjmvb(1,1,1)", "missing"),
    ({"obs": WHOLE + "imoaxs(1)=3"}, "tjaxs(1)", "missing"),
    ({"obs": WHOLE + TENSOR + "rhomvb(1)=5."}, "massmvb(1)=2.0", "Keep one"),
    ({"obs": WHOLE + TENSOR + "tjmvb(1,1,2)=.1, tjmvb(1,2,1)=.2"}, "tjmvb(1,1,2)=0.1", "not symmetric"),
    ({"obs": WHOLE + TENSOR + "tjmvb(1,1,2)=2."}, "tjmvb(1,1,1)=1.0", "positive definite"),
    ({"obs": FREE + "massmvb(1)=2., rhosub(1)=1."}, "massmvb(1)=2.0", "Keep one"),
    ({"obs": WHOLE.replace("imo(1)=4", "imo(1)=3") + TENSOR[16:]}, "tjmvb(1,1,1)", "missing"),
    # geometry and names
    ({"more": "iob(2)=2"}, "iob(2)=2", "belongs to no component"),
    ({"more": "xl(2)=2."}, "xl(2)=2.0", "Write iob(2)=m"),
    ({"obs": TWO.replace("nobs=2", "nobs=3")}, "obsid(3)", "no solid subcomponent"),
    ({"obs": TWO, "more": "ioh(2)=0"}, "obsid(2)", "no solid subcomponent"),
    ({"more": "yl(1)=1., yh(1)=1."}, "yl(1)=1.0", "not below yh(1)=1"),
    ({"more": "ral(1)=2., rah(1)=1."}, "ral(1)=2.0", "not below"),
    ({"more": "rsl(1)=2., rsh(1)=1."}, "rsl(1)=2.0", "not below"),
    ({"more": "angll(1)=20., anglh(1)=10."}, "angll(1)=20.0", "not below"),
    ({"more": "conel(1)=20., coneh(1)=10."}, "conel(1)=20.0", "not below"),
    ({"more": "rtorin(1)=2., rtorout(1)=1."}, "rtorin(1)=2.0", "torus"),
    ({"more": "igen(1)=3"}, "fstl(1)", "no file stlf01.inp"),
    ({"more": "igen(1)=3, fstl(1)='gone.stl'"}, "fstl(1)='gone.stl'", "no file gone.stl"),
    ({"more": "obsid(1)='my box!'"}, "obsid(1)='my box!'", "Write obsid(1)='my_box'"),
    ({"more": "obsid(1)='..'"}, "obsid(1)='..'", "a name has letters"),
    ({"obs": TWO, "more": "obsid(1)='A', obsid(2)='a'"}, "obsid(2)='a'", "component 1 has this name"),
    ({"obs": TWO, "more": "obsid(1)='obs2'"}, "obsid(2)", "component 1 has this name"),
    # mesh and sides
    ({"mesh": "px=0.,1.,1."}, "px(3)=1.0", "does not lie beyond px(2)=1"),
    ({"mesh": "px(1)=2., px(2)=1."}, "px(2)=1.0", "does not lie beyond"),
    ({"mesh": "px(1)=0., px(2)=1., px(4)=2."}, "px(3)", "this plane is missing"),
    ({"mesh": "nxcelt=0"}, "nxcelt=0", "must be >= 1"),
    ({"mesh": "px=0.,1.,2., nxcell=3,4, nxcelt=8"}, "nxcelt=8", "Write nxcelt=7"),
    ({"mesh": "px=0.,1.,2., nxcell(1)=3"}, "nxcell(2)", "is missing"),
    ({"mesh": "px=0.,1., nxcell=3,4"}, "nxcell(2)=4", "so 1 intervals"),
    ({"mesh": "px=0.,1.,2., nxcelt=1"}, "nxcelt=1", "Write nxcelt=2 or more"),
    ({"bcdata": "ibct(1)=4", "obs": "nobs=0"}, "ibct(1)=4", "Xmin is periodic and Xmax is not"),
    ({"bcdata": "ibct(5)=4,4"}, "ibct(5)=4", "moving bodies with periodic sides"),
    # time
    ({"add_xput": "delt=2."}, "delt=2.0", "longer than the run"),
    ({"add_xput": "dtmin=1."}, "dtmin=1.0", "larger than the first one"),
    ({"add_xput": "tedit=1.,.5"}, "tedit(2)=0.5", "Let the end times increase"),
    ({"add_xput": "teditdt=1.,1."}, "teditdt(2)=1.0", "Let the end times increase"),
    ({"more": "tobs=0.,1.,1."}, "tobs(3)=1.0", "Let the times increase"),
    ({"more": "tobs(1)=0., tobs(3)=1."}, "tobs(2)", "this time is missing"),
]

# The deck, the variable that is named, a part of the message: decks that run.
NOTICES = [
    ({"xput": "imobs=1, strngmob=.5, frcmob=.3"}, "strngmob=0.5", "without iclid=1; bodies pass through each other"),
    ({"xput": "imobs=1, frcmob=.3"}, "frcmob=0.3", "Write iclid=1, or iclid=0 if that is meant"),
    ({"xput": "imobs=1", "more": "crstrng(1)=.5"}, "crstrng(1)=0.5", "iclid=0 switches all collisions off"),
    ({"xput": "imobs=1", "more": "cfrc(1)=.5"}, "cfrc(1)=0.5", "iclid=0 switches all collisions off"),
    ({"xput": "imobs=1", "more": "iclidob(1,1)=1"}, "iclidob(1,1)=1", "iclid=0 switches all collisions off"),
    ({"obs": TWO, "more": "iclidob(1,2)=0, iclidob(2,1)=1"}, "iclidob(1,2)=0", "a 0 in either order"),
    ({"more": "uamp(1)=.5"}, "uamp(1)=0.5", "no effect with iupre(1)=0"),
    ({"more": "imo(2)=3, iob(2)=2, xl(2)=0., iumcal(2)=0", "obs": TWO[:-30]}, "iumcal(2)=0", "no effect with imo(2)=3"),
    ({"more": "imoaxs(1)=4, iumcal(1)=0"}, "iumcal(1)=0", "cannot move that way"),
    ({"more": "igf(1)=0, fxtobs(1,1)=2."}, "fxtobs(1,1)=2.0", "igf(1)=1"),
    ({"more": "imoaxs(1)=2, omxtobs(1,1)=1."}, "omxtobs(1,1)=1.0", "cannot move that way"),
    ({"more": "imoaxs(1)=4, utobs(1,1)=1."}, "utobs(1,1)=1.0", "cannot move that way"),
    ({"more": "tobs(2)=1., utobs(1,1)=1.,2."}, "utobs(1,1)=1.0", "iumcal(1)=0 makes it a table"),
    (
        {"more": "tobs(2)=.1, utobs(1,1)=1.,2., iumcal(1)=0"},
        "utobs(1,1)=1.0",
        "the table ends at t = 0.1, before twfin",
    ),
    ({"add_xput": "ifvof=5"}, "ifvof=5", "taken as ifvof=6"),
    ({"add_xput": "ifvof=3"}, "ifvof=3", "taken as ifvof=4"),
    ({"obs": WHOLE + TENSOR.replace("3)=1.", "3)=3.")}, "tjmvb(1,1,1)=1.0", "no body has such a tensor"),
]

# Values that look like more than they are: off defaults, liquid details in a dry deck, switched off parameters.
SILENT = [
    {"add_xput": "nmat=1, ifsft=0, icmprs=0, ifin=1, iaccf=0, ifvis=0, iorder=2, itb=1, ifvisc=1, con=.3, autot=2."},
    {"props": "sigma=.07, cangle=60., mu1=1e-3, tunits='k', cv1=4000., rhof2=1.2"},
    {"bcdata": "ibct(6)=5, fbct(1,6)=0., pbct(1,6)=0., flhtbct(1,6)=-1e8"},
    {"bcdata": "ibct(1)=4,4", "obs": "nobs=0"},
    {"more": "nsprp=0, ifob(1)=0, nevents_gmo(1)=0, avrck=-3.1, igf(1)=1, fxtobs(1,1)=2."},
    {"more": "imoaxs(1)=2, anglmin(1)=10., anglmax(1)=20., xaxs0(1)=3."},
    {"more": "imoaxs(1)=1", "flowgmo": "axisx(1)=1., axisz(1)=1."},
    {"more": "imoaxs(1)=2", "flowgmo": "axisy(1)=1."},
    {"more": "iumcal(1)=0, utobs(1,1)=2., ifsubcompenabled(2)=0, xl(2)=1."},
    {"obs": WHOLE + TENSOR + "tjmvb(1,1,2)=.1"},
    {"obs": FREE + "rhosub(1)=3."},
    {"mesh": "px=0.,1.,3., nxcell=3,4, nxcelt=7, size=.1"},
    {"more": "tobs(2)=1., utobs(1,1)=1.,2., iumcal(1)=0"},
    {"more": "tobs(2)=.1, utobs(1,1)=1.,0., iumcal(1)=0"},
    {"flowgmo": "impact='euler', dpfrac=.02, search='grid', multiple='sequential', hertz=1., resting='micro'"},
    {"xput": "imobs=1, iclid=0, strngmob=.5, frcmob=.3"},
    {"xput": "imobs=1, frcmob=.3", "obs": "nobs=0"},
    {"add_xput": "tedit(1)=0, teditdt(1)=0.0, tdtmax(1)=0.0001"},
]


@pytest.mark.parametrize(("blocks", "variable", "part"), PROBLEMS)
def test_problem(error, blocks: dict, variable: str, part: str) -> None:
    """Exactly one problem, at the variable."""
    problems = error(**blocks).problems
    assert [problem.variable for problem in problems] == [variable], [str(problem) for problem in problems]
    assert part in str(problems[0])


@pytest.mark.parametrize(("blocks", "variable", "part"), NOTICES)
def test_notice(read, blocks: dict, variable: str, part: str) -> None:
    """Exactly one notice, and the deck is read."""
    notices = read(**blocks).notices
    assert [notice.variable for notice in notices] == [variable], [str(notice) for notice in notices]
    assert part in str(notices[0])


@pytest.mark.parametrize("blocks", SILENT)
def test_silent(read, blocks: dict) -> None:
    assert read(**blocks).notices == []


def test_ignore_unsupported(read) -> None:
    """All of it becomes notices, and the values that hold are those that are computed."""
    deck = read(
        flowgmo="ignore_unsupported=.true.",
        add_xput="ifsft=1, ifin=2,",
        props="rhof=1000.",
        bcdata="ibct(1)=9",
        obs="nobs=2, iob=1,2, xl=2*0., imo=2,3, nsprp=2",
    )
    assert sorted(notice.variable.partition("=")[0] for notice in deck.notices) == [
        *("ibct(1)", "ifin", "ifsft", "imo(1)", "nsprp"),
    ]
    assert (deck["IFSFT"], deck["IFIN"], deck.at("IBCT", 1), deck.at("IMO", 1)) == (0, 1, 1, 0)
    assert deck.given("RHOF")


def test_the_explicit_coupling_gets_a_notice(read) -> None:
    """Where only prescribed bodies move there is nothing to couple, and decks of the vendor may say impmob=0."""
    deck = read(props="rhof=1000.", add_xput="impmob=0,", flowgmo="wetimpact='wet',")
    assert deck["IMPMOB"] == 0 and [n.variable for n in deck.notices] == ["impmob=0", "wetimpact='wet'"]
    assert "lighter than its added mass" in str(deck.notices[0])
    assert not read(props="rhof=1000.", add_xput="impmob=0,", obs="nobs=1, imo(1)=3, iob(1)=1, xl(1)=0.").notices


def test_two_numbers_for_one_way(read) -> None:
    """What a notice says the value means is the value that holds."""
    assert read(add_xput="ifvof=5")["IFVOF"] == 6


def test_rules_do_not_stop_at_the_first(error) -> None:
    """Problems of different rules stand together."""
    found = error(obs=FREE, add_xput="ifsft=1, delt=3.,", mesh="px=1.,0.")
    assert [problem.variable for problem in found.problems] == ["ifsft=1", "delt=3.0", "px(2)=0.0", "rhomvb(1)"]
