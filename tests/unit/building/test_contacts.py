"""Who may collide with whom, and how; what is refused, and in which words."""

import numpy as np
import pytest

from flowgmo.mesh import SIDE_NAMES

A, B, C = 0, 1, 2
OPEN, WALL, MIRROR = 3, 2, 1


def ball(m, x, r=0.1, more=""):
    place = ", ".join(f"trn{axis}({m})={value}" for axis, value in zip("xyz", x, strict=True))
    return f"imo({m})=4, rhomvb({m})=1000., iob({m})={m}, rsh({m})={r}, {place}, {more}"


def driven(m, x, more=""):
    return ball(m, x, more=more).replace(f"imo({m})=4, rhomvb({m})=1000.", f"imo({m})=3")


def box(m, lo, hi, more=""):
    limits = ", ".join(
        f"{axis}{end}({m})={value}"
        for end, corner in (("l", lo), ("h", hi))
        for axis, value in zip("xyz", corner, strict=True)
    )
    return f"imo({m})=0, iob({m})={m}, {limits}, {more}"


def deck(*bodies, sides=(OPEN,) * 6, xput="", own=""):
    kinds = ", ".join(f"ibct({k + 1})={kind}" for k, kind in enumerate(sides))
    obs = ", ".join(bodies).replace(", ", ",\n ")
    return (
        f"t\n&xput\n twfin=1., imobs=1, iclid=1, {xput}\n/\n&bcdata {kinds} /\n&mesh\n px=-1., 1., py=-1., 1., "
        f"pz=-1., 1.,\n/\n&obs\n nobs={len(bodies)},\n {obs}\n/\n&flowgmo {own} /\n"
    )


def side(name, bodies):
    return bodies + SIDE_NAMES.index(name)


def test_everyone_with_everyone(build):
    """Bodies with bodies, coupled bodies with walls and mirrors; open sides let bodies leave."""
    sides = (WALL, OPEN, MIRROR, 8, OPEN, OPEN)
    plan = build(
        deck(ball(1, (-0.5, 0, 0)), ball(2, (0.5, 0, 0)), box(3, (-1, -1, -1), (1, 1, -0.5)), sides=sides)
    ).contacts
    expected = np.zeros((9, 9), dtype=bool)
    for i, j in ((A, B), (A, C), (B, C), (A, side("Xmin", 3)), (A, side("Ymin", 3)), (B, side("Xmin", 3))):
        expected[i, j] = expected[j, i] = True
    expected[B, side("Ymin", 3)] = expected[side("Ymin", 3), B] = True
    assert (plan.allowed == expected).all()
    assert plan.balls == (0, 1) and plan.flats == (2,) and plan.touch == 1e-9


def test_neither_coupled(build):
    """Two driven bodies, or a driven one and a wall, pass through each other, whatever the overlap."""
    assert build(deck(driven(1, (0, 0, 0)), driven(2, (0.05, 0, 0)), sides=(WALL,) * 6)).contacts is None


@pytest.mark.parametrize(
    ("flag", "allowed"),
    [
        ("", True),
        ("iclidob(1,2)=1, iclidob(2,1)=1", True),
        ("iclidob(1,2)=0", False),
        ("iclidob(2,1)=0", False),
        ("iclidob(1,2)=1, iclidob(2,1)=0", False),
        ("iclidob(1,1)=0", False),
        ("iclidob(2,2)=0", False),
    ],
)
def test_pair_flags(build, flag, allowed):
    """A 0 in either order excludes the pair, (m,m) the body; the other body keeps its walls."""
    model = build(deck(ball(1, (-0.5, 0, 0)), ball(2, (0.5, 0, 0), more=flag), sides=(WALL,) * 6))
    assert model.contacts.allowed[A, B] == model.contacts.allowed[B, A] == allowed
    assert model.contacts.allowed[A, 2:].all() == ("(1,1)" not in flag)
    assert model.contacts.allowed[B, 2:].all() == ("(2,2)" not in flag)


def test_no_collisions_at_all(build):
    """With ICLID=0 overlaps do not matter, and what the deck says about pairs is noted."""
    text = deck(ball(1, (0, 0, 0), more="crstrng(1)=.5"), ball(2, (0.1, 0, 0))).replace("iclid=1", "iclid=0")
    model = build(text)
    assert model.contacts is None and not model.has("collisions")
    assert any("crstrng(1)=0.5" in notice and "iclid=0" in notice for notice in model.notices)


def test_a_pair_takes_the_smaller_coefficients(build):
    """Each of the two separately; walls bring STRNGMOB and FRCMOB, bodies without their own have these too."""
    bodies = (
        ball(1, (-0.5, 0, 0), more="crstrng(1)=.9, cfrc(1)=.1"),
        ball(2, (0.5, 0, 0), more="crstrng(2)=.4, cfrc(2)=.3"),
    )
    plan = build(deck(*bodies, ball(3, (0, 0, 0.5)), sides=(WALL,) * 6, xput="strngmob=.6, frcmob=.2")).contacts
    wall = side("Zmin", 3)
    assert plan.restitution[A, B] == plan.restitution[B, A] == 0.4 and plan.friction[A, B] == 0.1
    assert plan.restitution[A, C] == 0.6 and plan.friction[B, C] == 0.2
    assert plan.restitution[A, wall] == 0.6 and plan.friction[A, wall] == 0.1
    assert plan.restitution[B, wall] == 0.4 and plan.friction[B, wall] == 0.2


def test_a_mirror_is_elastic_and_smooth(build):
    """Whatever body and walls are."""
    sides = (MIRROR, WALL, WALL, WALL, WALL, WALL)
    text = deck(ball(1, (0, 0, 0), more="crstrng(1)=.3, cfrc(1)=.5"), sides=sides, xput="strngmob=.2, frcmob=.4")
    plan = build(text).contacts
    assert plan.restitution[A, 1] == 1.0 and plan.friction[A, 1] == 0.0
    assert plan.restitution[A, 2] == 0.2 and plan.friction[A, 2] == 0.4


def test_overlap_of_two_balls(problems):
    """Both named, with the depth r + r - d."""
    (text,) = problems(deck(ball(1, (0, 0, 0), more="obsid(1)='red'"), ball(2, (0.15, 0, 0), more="obsid(2)='blue'")))
    assert "red and blue overlap at the start by 0.05" in text and "obsid(2)='blue'" in text
    assert "Move one of them, or write iclidob(1,2)=0" in text and text.startswith("deck.nml:")


def test_overlap_of_a_ball_and_a_box(problems):
    """Depth r - d = 0.1 - 0.07."""
    (text,) = problems(deck(ball(1, (0, 0, 0.07)), box(2, (-1, -1, -1), (1, 1, 0))))
    assert "obs1 and obs2 overlap at the start by 0.03." in text and "imo(2)=0" in text


def test_all_overlaps_together(problems):
    found = problems(deck(*(ball(m, (0.15 * m, 0, 0)) for m in (1, 2, 3))))
    assert len(found) == 2 and "obs1 and obs2" in found[0] and "obs2 and obs3" in found[1]


def test_touching_is_no_overlap(build):
    """Up to 1e-6 of the smaller body's size (2 r): above it an error, below it none."""
    build(deck(ball(1, (0, 0, 0)), ball(2, (0.2, 0, 0))))
    build(deck(ball(1, (0, 0, 0)), ball(2, (0.2 - 1e-7, 0, 0))))
    with pytest.raises(Exception, match="overlap at the start by 3e-07"):
        build(deck(ball(1, (0, 0, 0)), ball(2, (0.2 - 3e-7, 0, 0))))


def test_a_pierced_side_is_left_out(build):
    """Every two-dimensional deck: the body reaches through both sides; the other sides act."""
    text = deck(ball(1, (0, 0, 0), r=0.3), sides=(WALL,) * 6).replace("py=-1., 1.,", "py=-.1, .1,")
    model = build(text)
    assert model.contacts.allowed[A, 1:].tolist() == [True, True, False, False, True, True]
    found = [notice for notice in model.notices if "pierces" in notice]
    assert len(found) == 2 and "ibct(3)=2" in found[0] and "Ymin by 0.2 at the start" in found[0]


def test_a_hinge_is_left_out(build):
    """A ball that turns about an axis inside a post: a notice names both; the second post is hit."""
    bodies = (
        ball(1, (0, 0, 0), more="imoaxs(1)=2, obsid(1)='bob'"),
        box(2, (0.05, -0.5, -0.5), (0.3, 0.5, 0.5), more="obsid(2)='post'"),
        box(3, (-0.9, -0.5, -0.5), (-0.8, 0.5, 0.5)),
    )
    model = build(deck(*bodies))
    assert not model.contacts.allowed[A, B] and model.contacts.allowed[A, C]
    (text,) = [notice for notice in model.notices if "hinge" in notice]
    assert "bob" in text and "post" in text and "iclidob(1,2)" in text


def test_outside_the_domain(problems):
    (text,) = problems(deck(ball(1, (1.5, 0, 0)), sides=(WALL,) * 6))
    assert "obs1 starts outside the domain, beyond its side Xmax, which is a wall" in text and "imo(1)=4" in text


MASS = (
    "iprpmvb(1)=1, massmvb(1)=1., xmcmvb0(1)={0}, ymcmvb0(1)=0., zmcmvb0(1)=0., "
    "tjmvb(1,1,1)={1}, tjmvb(1,2,2)=1., tjmvb(1,3,3)=1."
)
ROUGH = "cfrc(1)=.5, cfrc(2)=.5,"
GIVEN = "iob(1)=1, rsh(1)=.1, imo(1)=4,"


GENERAL = {
    "a box": box(1, (0, 0, 0), (0.1, 0.1, 0.1)).replace("imo(1)=0", "imo(1)=4, rhomvb(1)=1."),
    "stops": ball(1, (0, 0, 0), more="dxmcmin(1)=.5"),
    "a fixed point": ball(1, (0, 0, 0), more="imoaxs(1)=4"),
    "a rough ball on an axis": ball(1, (0, 0, 0), more=f"imoaxs(1)=3, {ROUGH}"),
    "driven components": ball(1, (0, 0, 0), more="iumcal(1)=0"),
    "mass centre off the middle": f"{GIVEN} {MASS.format(0.05, 1.0)}",
    "different moments": f"{GIVEN} {MASS.format(0.0, 1.2)}",
    "driven about two axes": driven(1, (0, 0, 0), more="omxtobs(1,1)=1., omytobs(1,1)=1."),
    "a driven plate": driven(1, (0, 0, 0)).replace("rsh(1)=0.1", "xl(1)=-.1, xh(1)=.1"),
}
CLOSED = {
    "a ball": ball(1, (0, 0, 0)),
    "a smooth ball on an axis": ball(1, (0, 0, 0), more="imoaxs(1)=3"),
    "mass data of a ball": f"{GIVEN} {MASS.format(0.0, 1.0)}, {ROUGH}",
    "driven about one axis": driven(1, (0, 0, 0), more="omxtobs(1,1)=1."),
    "sinusoids of no amplitude": driven(1, (0, 0, 0), more="omxtobs(1,1)=1., iomypre(1)=1, iomzpre(1)=1"),
    "driven about an axis away": driven(1, (0, 0, 0), more="imoaxs(1)=3, xaxs0(1)=-.3, omztobs(1,1)=1."),
}


@pytest.mark.parametrize(("name", "closed"), [*((n, False) for n in GENERAL), *((n, True) for n in CLOSED)])
def test_closed_forms_only_where_they_do(build, name, closed):
    """Whoever collides is accepted. Closed forms (collision/balls) for free solid balls and flats: taken for anything
    else their result would be wrong without a word."""
    plan = build(deck((CLOSED if closed else GENERAL)[name], ball(2, (0.5, 0, 0)))).contacts
    assert plan.allowed[A, B] and plan.closed_form == closed


@pytest.mark.parametrize("knob", ["impact='euler'", "search='grid'", "multiple='sequential'", "resting='micro'"])
def test_a_chosen_method_is_used_for_balls_too(build, knob):
    """The closed forms know none of these: with them the knob would be ignored."""
    plan = build(deck(ball(1, (0, 0, 0)), ball(2, (0.5, 0, 0)), own=knob)).contacts
    name, value = knob.split("=")
    assert getattr(plan, name) == value.strip("'") and not plan.closed_form


def test_three_balls_that_touch_need_the_general_engine(build):
    """Several may be hit at once; two that touch are one pair, and closed forms do."""
    row = [ball(m, (0.2 * (m - 2), 0, 0)) for m in (1, 2, 3)]
    assert build(deck(*row[:2])).contacts.closed_form
    assert not build(deck(*row)).contacts.closed_form


def test_a_body_that_is_left_out(build):
    """iclidob(m,m)=0: nothing collides with it, and it does not decide about the closed forms."""
    text = deck(ball(1, (0, 0, 0), more="imoaxs(1)=4, iclidob(1,1)=0"), ball(2, (0.5, 0, 0)), sides=(WALL,) * 6)
    plan = build(text).contacts
    assert not plan.allowed[A].any() and plan.closed_form


def test_two_bodies_without_names_that_are_left_out(problems):
    """IFCOMPENABLED=0 would leave a hole in the numbers: a clear not yet, no crash."""
    (text,) = problems(deck(ball(1, (0, 0, 0)), "ifcompenabled(2)=0"))
    assert "ifcompenabled(2)=0" in text and "not computed yet" in text
