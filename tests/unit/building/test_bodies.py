"""Constraint, reference point, drives, start, stops and loads of one component."""

import numpy as np
import pytest

from flowgmo.bodies.body import Sinusoid

MASS = "iprpmvb(1)=1, massmvb(1)=2., xmcmvb0(1)=.5, ymcmvb0(1)=0., zmcmvb0(1)=0.,"
TENSOR = "tjmvb(1,1,1)=2., tjmvb(1,2,2)=3., tjmvb(1,3,3)=4.,"
BALL = "iob(1)=1, rsh(1)=.1, trnx(1)=.5,"
FREE = f"imo(1)=4, {MASS} {TENSOR} {BALL}"
DRIVEN = f"imo(1)=3, {BALL}"


@pytest.fixture
def body(build):
    """Component 1 of a deck with these lines in &obs (and &flowgmo)."""

    def one(obs, own=""):
        mesh = "px=-5., 5., py=-5., 5., pz=-5., 5.,"
        obs = obs.replace(", ", ",\n ")
        return build(
            f"t\n&xput\n twfin=10., imobs=1,\n/\n&mesh\n {mesh}\n/\n&obs\n nobs=1,\n {obs}\n/\n&flowgmo {own} /\n"
        ).bodies[0]

    return one


def test_solid(body):
    solid = body("iob(1)=1, rsh(1)=.1")
    assert solid.kind == "solid" and not solid.moves and solid.mass is None and solid.drives == ()
    assert solid.name == "obs1"


@pytest.mark.parametrize(("imoaxs", "axis"), [(1, [1, 0, 0]), (2, [0, 1, 0]), (3, [0, 0, 1])])
def test_fixed_axis(body, imoaxs, axis):
    made = body(f"imo(1)=4, imoaxs(1)={imoaxs}, zaxs0(1)=2., {MASS} tjaxs(1)=1., {BALL}")
    assert made.constraint == "fixed axis" and made.axis.tolist() == axis and made.point.tolist() == [0, 0, 2]


def test_axis_of_any_direction_is_unit(body):
    made = body(f"imo(1)=4, imoaxs(1)=1, {MASS} tjaxs(1)=1., {BALL}", "axisx(1)=3., axisz(1)=4.")
    assert made.axis == pytest.approx([0.6, 0.0, 0.8], abs=1e-15)


def test_reference_point_of_a_driven_body(body):
    """Given, else the mass centre, else the centre of the shape; a single coordinate may be given."""
    assert body(DRIVEN).reference == pytest.approx([0.5, 0.0, 0.0], abs=1e-12)
    assert body(f"{DRIVEN} xref0(1)=1., yref0(1)=2., zref0(1)=3.").reference.tolist() == [1.0, 2.0, 3.0]
    assert body(f"{DRIVEN} zref0(1)=3.").reference == pytest.approx([0.5, 0.0, 3.0], abs=1e-12)
    heavy = f"imo(1)=3, iprpmvb(1)=1, massmvb(1)=1., xmcmvb0(1)=.2, ymcmvb0(1)=.3, zmcmvb0(1)=.4, {TENSOR} {BALL}"
    assert body(heavy).reference.tolist() == [0.2, 0.3, 0.4]
    assert body(f"{heavy} yref0(1)=1.").reference.tolist() == [0.2, 1.0, 0.4]


def test_reference_point_of_a_driven_body_without_end(body):
    """Middle of what lies inside the domain (here -5 .. 5): x and y 0, z from -5 to 1."""
    assert body("imo(1)=3, iob(1)=1, zh(1)=1.").reference.tolist() == [0.0, 0.0, -2.0]


def test_velocity_of_the_mass_centre_follows_from_the_reference_point(body):
    """v_B = v + w x (B - reference): a wheel driven at its rim."""
    heavy = f"imo(1)=3, {MASS} {TENSOR} {BALL} xref0(1)=0., utobs(1,1)=1., omztobs(1,1)=4."
    made = body(heavy)
    assert made.velocity.tolist() == [1.0, 2.0, 0.0] and made.spin.tolist() == [0.0, 0.0, 4.0]
    assert made.origin.tolist() == [0.5, 0.0, 0.0]


def test_start_of_a_free_body_is_the_first_entry(body):
    """Also when the table starts later than t = 0."""
    made = body(f"{FREE} tobs(1)=5., tobs(2)=6., utobs(1,1)=1., utobs(2,1)=9., omytobs(1,1)=2.")
    assert made.velocity.tolist() == [1.0, 0.0, 0.0] and made.spin.tolist() == [0.0, 2.0, 0.0]
    assert all(drive.coupled for drive in made.drives)


def test_start_of_a_driven_component_is_its_law_at_zero(body):
    made = body(f"{FREE} ivmcal(1)=0, tobs(1)=-1., tobs(2)=1., vtobs(1,1)=0., vtobs(2,1)=8.")
    assert made.velocity.tolist() == [0.0, 4.0, 0.0]
    assert [drive.coupled for drive in made.drives] == [True, False, True, True, True, True]


def test_sinusoid_phase_is_in_radians(body):
    """The deck's degrees end here; frequency is in cycles."""
    made = body(f"{DRIVEN} iwpre(1)=1, wamp(1)=2., wfre(1)=3., wphs(1)=90.")
    assert made.drives[2].law == Sinusoid(2.0, 3.0, np.pi / 2)
    assert made.velocity == pytest.approx([0.0, 0.0, 2.0], abs=1e-15)


def test_table_is_kept(body):
    made = body(f"{DRIVEN} tobs(1)=0., tobs(2)=1., tobs(3)=4., utobs(1,1)=1., utobs(2,1)=2., utobs(3,1)=-1.")
    assert made.drives[0].law.t.tolist() == [0, 1, 4] and made.drives[0].law.y.tolist() == [1, 2, -1]
    assert made.drives[1].law.is_zero


def test_fixed_axis_has_one_drive(body):
    """OMY about y; it stands in drives[3], the others are nothing. v = w x r of the centre at (.5, 0, 0)."""
    made = body(f"imo(1)=4, imoaxs(1)=2, {MASS} tjaxs(1)=1., {BALL} omytobs(1,1)=3., omxtobs(1,1)=7., utobs(1,1)=9.")
    assert [drive.coupled for drive in made.drives] == [False, False, False, True, False, False]
    assert made.spin.tolist() == [3.0, 0.0, 0.0]
    assert made.velocity == pytest.approx([0.0, 0.0, -1.5], abs=1e-15)


def test_fixed_point_has_three_drives(body):
    made = body(f"imo(1)=4, imoaxs(1)=4, {FREE[len('imo(1)=4, ') :]} omztobs(1,1)=2., utobs(1,1)=9., iomxcal(1)=0")
    assert [drive.coupled for drive in made.drives] == [False] * 4 + [True, True]
    assert made.axis is None and made.point.tolist() == [0, 0, 0]
    assert made.velocity == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)


def test_travel_stops_are_signed(body):
    """The deck gives ways without signs."""
    stops = body(f"{FREE} dxmcmin(1)=.1, dxmcmax(1)=.2, dzmcmax(1)=0.").stops
    assert stops.lo.tolist() == [-0.1, -np.inf, -np.inf] and stops.hi.tolist() == [0.2, np.inf, 0.0]
    assert stops.any and not body(FREE).stops.any
    assert not body(f"{FREE} dxmcmin(1)=1e19").stops.any  # the deck's way to write none


def test_angle_stops_are_in_radians(body):
    hinged = f"imo(1)=4, imoaxs(1)=3, {MASS} tjaxs(1)=1., {BALL}"
    stops = body(f"{hinged} anglmin(1)=90., anglmax(1)=180.").stops
    assert stops.angle_lo == pytest.approx(-np.pi / 2, rel=1e-15) and stops.angle_hi == pytest.approx(np.pi, rel=1e-15)
    assert body(f"{hinged} anglmax(1)=180.").stops.angle_lo == -np.inf


def test_total_load(body):
    made = body(f"{FREE} igf(1)=1, irefgf(1)=2, fxtobs(1,1)=3., tztobs(1,1)=4.")
    assert made.loads.in_body_axes and made.loads.points == ()
    assert [law.y.tolist() for law in made.loads.force] == [[3.0], [0.0], [0.0]]
    assert [law.y.tolist() for law in made.loads.torque] == [[0.0], [0.0], [4.0]]
    assert body(f"{FREE} fxtobs(1,1)=3.").loads is None  # igf=0: noted, no load


def test_loads_at_points(body):
    """Points without coordinates are the mass centre; each has its own axes."""
    made = body(f"{FREE} igf(1)=2, fytobsm(1,1,2)=5., fztobsm(1,1,4)=6., xfpnt(1,4)=9., irefgfm(1,4)=2")
    first, second = made.loads.points
    assert first.point.tolist() == [0.5, 0.0, 0.0] and second.point.tolist() == [9.0, 0.0, 0.0]
    assert (first.in_body_axes, second.in_body_axes) == (False, True)
    assert first.force[1].y.tolist() == [5.0] and second.force[2].y.tolist() == [6.0]
    assert all(law.is_zero for law in made.loads.force + made.loads.torque)
