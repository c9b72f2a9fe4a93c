"""Mass, mass centre and inertia of a component, integrated from its shape or given, against closed forms."""

import numpy as np
import pytest

RHO = 800.0


def deck(obs: str, more: str = "") -> str:
    mesh = "px=-5., 5., py=-5., 5., pz=-5., 5.,"
    obs = f"&obs\n nobs=1, imo(1)=4,\n {obs}\n/\n&flowgmo {more} /\n"
    return f"t\n&xput\n twfin=1., imobs=1,\n/\n&mesh\n {mesh}\n/\n{obs}"


def box_inertia(mass, a, b, c):
    return mass / 12.0 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])


def shifted(mass, inertia, d):
    """Steiner: the inertia about a point that is d away from the centre."""
    d = np.asarray(d, float)
    return inertia + mass * (d @ d * np.eye(3) - np.outer(d, d))


BOX = "xl(1)=-.1, xh(1)=.3, yl(1)=0., yh(1)=.2, zl(1)=-.3, zh(1)=.3,"  # 0.4 x 0.2 x 0.6 about (.1, .1, 0)


def test_ball(build):
    """m = 4/3 pi r^3 rho, I = 2/5 m r^2; round-off only, so a wrong density or radius cannot hide."""
    (body,) = build(deck(f"rhomvb(1)={RHO}, iob(1)=1, rsh(1)=.2, trnx(1)=.5, trnz(1)=-1.")).bodies
    mass = 4.0 / 3.0 * np.pi * 0.008 * RHO
    assert body.mass.mass == pytest.approx(mass, rel=1e-12)
    assert body.mass.inertia == pytest.approx(0.4 * mass * 0.04 * np.eye(3), rel=1e-12)
    assert body.mass.centre == pytest.approx([0.5, 0.0, -1.0], abs=1e-12)
    assert (body.origin == body.mass.centre).all()


def test_box_about_its_middle(build):
    (body,) = build(deck(f"rhomvb(1)={RHO}, iob(1)=1, {BOX}")).bodies
    mass = RHO * 0.4 * 0.2 * 0.6
    assert body.mass.mass == pytest.approx(mass, rel=1e-12)
    assert body.mass.centre == pytest.approx([0.1, 0.1, 0.0], abs=1e-12)
    assert body.mass.inertia == pytest.approx(box_inertia(mass, 0.4, 0.2, 0.6), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("rotation", ["rotz(1)", "grotz(1)"])
def test_turned_box(build, rotation):
    """The tensor is in axes that are parallel to space at the start: R I R^T of the box turned by 30 degrees."""
    (body,) = build(deck(f"rhomvb(1)={RHO}, iob(1)=1, {BOX} {rotation}=30.")).bodies
    mass, c, s = RHO * 0.048, np.cos(np.pi / 6), np.sin(np.pi / 6)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert body.mass.inertia == pytest.approx(R @ box_inertia(mass, 0.4, 0.2, 0.6) @ R.T, rel=1e-9, abs=1e-9)
    assert body.mass.centre == pytest.approx(R @ [0.1, 0.1, 0.0], abs=1e-12)


def test_two_boxes_of_two_densities(build):
    """Mass and centre by sums, inertia by Steiner about the common centre."""
    two = "iob(2)=1, xl(2)=.3, xh(2)=.4, yl(2)=0., yh(2)=.2, zl(2)=-.3, zh(2)=.3, rhosub(2)=3000.,"
    (body,) = build(deck(f"rhomvb(1)={RHO}, iob(1)=1, {BOX} {two}")).bodies
    m1, m2 = RHO * 0.048, 3000.0 * 0.1 * 0.2 * 0.6
    c1, c2 = np.array([0.1, 0.1, 0.0]), np.array([0.35, 0.1, 0.0])
    centre = (m1 * c1 + m2 * c2) / (m1 + m2)
    inertia = shifted(m1, box_inertia(m1, 0.4, 0.2, 0.6), c1 - centre)
    inertia = inertia + shifted(m2, box_inertia(m2, 0.1, 0.2, 0.6), c2 - centre)
    assert body.mass.mass == pytest.approx(m1 + m2, rel=1e-9)
    assert body.mass.centre == pytest.approx(centre, abs=1e-9)
    assert body.mass.inertia == pytest.approx(inertia, rel=1e-9, abs=1e-9)


def test_density_of_a_subcomponent_alone(build):
    """RHOSUB without RHOMVB is a density too."""
    (body,) = build(deck(f"rhosub(1)={RHO}, iob(1)=1, rsh(1)=.2")).bodies
    assert body.mass.mass == pytest.approx(4.0 / 3.0 * np.pi * 0.008 * RHO, rel=1e-12)


def test_hollow_box(build):
    """A hole takes mass away: box minus box."""
    hole = "iob(2)=1, ioh(2)=0, xl(2)=0., xh(2)=.2, yl(2)=.05, yh(2)=.15, zl(2)=-.1, zh(2)=.1,"
    (body,) = build(deck(f"rhomvb(1)={RHO}, iob(1)=1, {BOX} {hole}")).bodies
    m1, m2 = RHO * 0.048, RHO * 0.2 * 0.1 * 0.2
    assert body.mass.mass == pytest.approx(m1 - m2, rel=1e-9)
    expected = box_inertia(m1, 0.4, 0.2, 0.6) - box_inertia(m2, 0.2, 0.1, 0.2)
    assert body.mass.inertia == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_given_tensor(build):
    """One element of a mirrored pair holds on both sides of the diagonal."""
    given = (
        "iprpmvb(1)=1, massmvb(1)=2., xmcmvb0(1)=.1, ymcmvb0(1)=.2, zmcmvb0(1)=.3, tjmvb(1,1,1)=2., tjmvb(1,2,2)=3., "
        "tjmvb(1,3,3)=4., tjmvb(1,1,2)=.5, tjmvb(1,3,1)=-.25, iob(1)=1, rsh(1)=.1,"
    )
    (body,) = build(deck(given)).bodies
    assert body.mass.mass == 2.0 and body.mass.centre.tolist() == [0.1, 0.2, 0.3]
    assert body.mass.inertia.tolist() == [[2.0, 0.5, -0.25], [0.5, 3.0, 0.0], [-0.25, 0.0, 4.0]]


def test_moment_about_a_fixed_axis(build):
    """TJAXS is kept as it is given: no tensor, no second Steiner term."""
    given = (
        "imoaxs(1)=2, xaxs0(1)=1., iprpmvb(1)=1, massmvb(1)=2., xmcmvb0(1)=0., ymcmvb0(1)=0., zmcmvb0(1)=0., "
        "tjaxs(1)=7.5, iob(1)=1, rsh(1)=.1,"
    )
    (body,) = build(deck(given)).bodies
    assert body.mass.axis_moment == 7.5 and body.mass.inertia is None
    assert body.axis.tolist() == [0.0, 1.0, 0.0] and body.point.tolist() == [1.0, 0.0, 0.0]


def test_integrated_moment_about_a_fixed_axis(build):
    """A ball 0.7 away from its axis: 2/5 m r^2 + m d^2 reaches the equations of motion."""
    from flowgmo.bodies.arrays import pack

    model = build(deck(f"imoaxs(1)=3, xaxs0(1)=.7, rhomvb(1)={RHO}, iob(1)=1, rsh(1)=.2,"))
    mass = 4.0 / 3.0 * np.pi * 0.008 * RHO
    arrays, _ = pack(model.bodies, model.gravity)
    assert arrays["hinge_moment"][0] == pytest.approx(mass * (0.4 * 0.04 + 0.49), rel=1e-12)


def test_driven_body_without_mass(build):
    text = deck("iob(1)=1, rsh(1)=.1").replace("imo(1)=4", "imo(1)=3")
    (body,) = build(text).bodies
    assert body.mass is None and body.loads is None


@pytest.mark.parametrize(
    ("obs", "says"),
    [
        ("iob(1)=1, rsh(1)=.1", ["deck.nml:8: &obs rhomvb(1)", "no density", "Write rhomvb(1)="]),
        ("massmvb(1)=2., iob(1)=1, rsh(1)=.1", ["deck.nml:10: &obs massmvb(1)=2.0", "iprpmvb(1)=1"]),
        ("rhomvb(1)=1., iob(1)=1, zl(1)=0.", ["deck.nml:10: &obs rhomvb(1)=1.0", "limiters", "massmvb(1)"]),
        ("iprpmvb(1)=1, massmvb(1)=2., iob(1)=1, rsh(1)=.1", ["xmcmvb0(1)", "tjmvb(1,1,1)", "missing"]),
        (
            "iprpmvb(1)=1, massmvb(1)=1., xmcmvb0(1)=0., ymcmvb0(1)=0., zmcmvb0(1)=0., tjmvb(1,1,1)=-1., "
            "tjmvb(1,2,2)=1., tjmvb(1,3,3)=1., iob(1)=1, rsh(1)=.1",
            ["deck.nml:10: &obs tjmvb(1,1,1)=-1.0", "not positive definite"],
        ),
        ("rhomvb(1)=1., iob(1)=1, rsh(1)=.1, xl(1)=.5", ["deck.nml:10: &obs", "component 1"]),
        ("rhomvb(1)=1., iob(1)=1, rsh(1)=.1, iob(2)=1, ioh(2)=0, rsh(2)=.2", ["deck.nml:10: &obs", "no volume"]),
    ],
)
def test_impossible_bodies(problems, obs, says):
    """Every one is named by file, line and variable, and says what to write."""
    found = "\n".join(problems(deck(obs)))
    assert all(word in found for word in says), found


def test_impossible_tensor(problems):
    """No body has one principal moment above the sum of the others."""
    given = (
        "iprpmvb(1)=1, massmvb(1)=1., xmcmvb0(1)=0., ymcmvb0(1)=0., zmcmvb0(1)=0., tjmvb(1,1,1)=1., tjmvb(1,2,2)=1., "
        "tjmvb(1,3,3)=3., iob(1)=1, rsh(1)=.1"
    )
    (text,) = problems(deck(given))
    assert "no body has the principal moments 1, 1, 3" in text


@pytest.mark.parametrize(
    "obs",
    [
        "rhomvb(1)=1e300, iob(1)=1, rsh(1)=1e100",
        "rhomvb(1)=1e-320, iob(1)=1, rsh(1)=.1",
        "rhomvb(1)=1e-307, iob(1)=1, rsh(1)=.01",
    ],
)
def test_mass_beyond_numbers(problems, obs):
    """Mass or moments that overflow or vanish: a problem of the deck, no unforeseen error and no run full of nan."""
    (text,) = problems(deck(obs))
    assert "deck.nml:10: &obs rhomvb(1)" in text and "other units" in text


def test_density_of_a_part_that_is_switched_off(build):
    """It is no mass: the driven body runs without one."""
    text = deck("iob(1)=1, rsh(1)=.1, iob(2)=1, rsh(2)=.2, rhosub(2)=5., ifsubcompenabled(2)=0")
    (body,) = build(text.replace("imo(1)=4", "imo(1)=3")).bodies
    assert body.mass is None and body.shape.as_sphere()[1] == 0.1
