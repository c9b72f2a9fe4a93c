"""FluidPlan: each of its fields from its deck line; what is off is None; what fills the domain or the machine."""

import dataclasses

import numpy as np
import pytest
from flowgmo_wet import FREE, FULL, MESH, wet

from flowgmo.building import memory
from flowgmo.flow_plan import CELL_BYTES, CleanUp, PressurePlan, StepPlan, mesh_bytes


def test_defaults(build):
    """The least a wet deck says: liquid without viscosity, compressibility, or surface."""
    fluid = build(wet(xput=FULL, fl="")).fluid
    assert (fluid.rho, fluid.mu, fluid.compressibility, fluid.order) == (1000.0, None, None, 3)
    assert not (fluid.free_surface or fluid.no_slip or fluid.implicit_viscosity) and fluid.tracking is None
    assert fluid.steps == StepPlan(adapt=1, courant=0.45, surface_courant=1.0, growth=1.2)
    assert fluid.pressure == PressurePlan(tolerance=1.0, most_iterations=100, plain_sor=False)
    assert fluid.clean_up == CleanUp(snap=1e-4, smallest_volume=0.05, sliver=None)
    assert fluid.void_pressure == 0.0 and fluid.planes == fluid.loads == ()
    assert fluid.start.height is fluid.start.volume is None and fluid.start.regions == ()
    assert fluid.start.velocity.tolist() == [0, 0, 0] and not fluid.start.hydrostatic


def test_every_line(build):
    """Values other than the defaults arrive, each in its field."""
    xput = FREE + (
        "ifvisc=1, impvis=2, iwsh=0, iorder=1, ifvof=4, autot=2., con=.3, confs=.7, epsadj=.1, igmres=0, ipdis=1,"
        "delt=1e-3, dtmin=1e-7, tdtmax(1)=5e-3,"
    )
    props = "rhof=998.2, mu1=1e-3, rcsql=1e-9, pvoid=0.".replace(", pvoid=0.", ",")
    limits = "eps=1e-3, vfclean=.1, itmax=70"
    model = build(wet(xput=xput, props=props, limits=limits, obs="iavrck=1, avrck=-2.,"))
    fluid = model.fluid
    assert (fluid.rho, fluid.mu, fluid.compressibility, fluid.order) == (998.2, 1e-3, 1e-9, 1)
    assert fluid.free_surface and fluid.implicit_viscosity and not fluid.no_slip and fluid.tracking == "donor"
    assert fluid.steps == StepPlan(adapt=2, courant=0.3, surface_courant=0.7, growth=1.2)
    assert fluid.pressure == PressurePlan(tolerance=0.1, most_iterations=70, plain_sor=True)
    assert fluid.clean_up == CleanUp(snap=1e-3, smallest_volume=0.1, sliver=2.0)
    assert any("iavrck=1: slivers get more volume" in notice for notice in model.notices)
    assert fluid.start.hydrostatic and fluid.start.height == 0.5
    assert (model.clock.dt, model.clock.dt_min, model.clock.dt_max.spacing.tolist()) == (1e-3, 1e-7, [5e-3])


def test_off_is_absent(build):
    """A zero coefficient is an effect that is not there, and the user is told where the deck seems to want it."""
    model = build(wet(xput=FREE + "ifvisc=1, impvis=1,"))
    assert model.fluid.mu is None and not model.fluid.no_slip and not model.fluid.implicit_viscosity
    assert any("ifvisc=1: the viscosity is zero" in notice for notice in model.notices)
    model = build(wet(props="rhof=1., mu1=2., rcsql=0.,", obs="avrck=-3.1,"))
    assert model.fluid.mu is None and model.fluid.compressibility is None and model.fluid.clean_up.sliver is None
    assert any("ifvisc=0 switches viscosity off" in notice for notice in model.notices)
    assert any("slivers keep their volume" in notice for notice in model.notices)
    assert build(wet(props="", fl="")).fluid is None


def test_old_names_and_two_numbers_for_one_way(build):
    assert build(wet(xput=FREE + "ifvisc=1,", props="rhof=1., mui=2.,")).fluid.mu == 2.0
    for number, way in ((3, "donor"), (4, "donor"), (5, "plic"), (6, "plic")):
        assert build(wet(xput=FREE + f"ifvof={number},")).fluid.tracking == way


def test_the_courant_number_has_a_bound(build):
    """.9 of a cell; beside bodies that move .45, a tenth less than 1/2, up to which one carrying keeps 0 <= F <= 1
    (Weymouth & Yue 2010). What is not taken as the deck has it is said, between .45 and .5 too."""
    model = build(wet(xput=FREE + "con=.9,"))
    assert model.fluid.steps.courant == 0.9 and not any("con=" in n for n in model.notices)
    model = build(wet(xput=FREE + "con=1.5,"))
    assert model.fluid.steps.courant == 0.9 and any("con=1.5: taken as con=0.9" in n for n in model.notices)
    body = "nobs=1, imo(1)=3, iob(1)=1, rsh(1)=.2,"
    model = build(wet(xput=FREE + "con=.9, imobs=1,", obs=body))
    assert model.fluid.steps.courant == 0.45 and any("con=0.9: taken as con=0.45" in n for n in model.notices)


@pytest.mark.parametrize("courant, taken", [(0.3, 0.3), (0.45, 0.45), (0.46, 0.45), (0.5, 0.45), (0.51, 0.51)])
def test_what_a_courant_number_acts_as_is_said(build, courant, taken):
    model = build(wet(xput=FREE + f"con={courant},"))
    told = [n for n in model.notices if f"con={courant}: taken as con=0.45, a tenth less than 0.5" in n]
    assert model.fluid.steps.courant == taken and len(told) == (taken != courant)


@pytest.mark.parametrize(
    "blocks, words",
    [
        ({"xput": FREE + "autot=2.,"}, "autot=2.0: taken as autot=1: one whose pressure takes more than itmax"),
        ({"xput": FREE + "autot=0.,"}, "autot=0.0: steps are delt, and shorter where longer ones would not be stable"),
        ({"limits": "itdtmx=5"}, "itdtmx=5: this shortens no step"),
        ({"obs": "nobs=1, iob(1)=1, zh(1)=.1, ibuoyo(1)=1"}, "ibuoyo(1)=1: recorded of bodies that the liquid moves"),
        ({"obs": "nobs=1, iob(1)=1, zh(1)=.1, ifrco(1)=1, ipref(1)=2"}, "ipref(1)=2: the load on a component that"),
        ({"obs": "nobs=1, iob(1)=1, zh(1)=.1, ifrco(1)=1, prefmbw(1)=5."}, "prefmbw(1)=5.0: the load on a component"),
    ],
)
def test_what_is_computed_otherwise_is_said(build, blocks, words):
    assert any(words in notice for notice in build(wet(**blocks)).notices)
    plain = build(wet(obs="nobs=1, iob(1)=1, zh(1)=.1, ifrco(1)=1", xput=FREE + "autot=1.,"))
    assert not plain.notices


def test_steps_of_a_constant_length(build):
    """AUTOT=0: no step is longer than DELT; in a dry scene that is so anyway."""
    steps = build(wet(xput=FREE + "autot=0., delt=1e-3, tdtmax=5e-4, 1., teditdt=.1,")).clock
    assert steps.dt_max.spacing.tolist() == [5e-4, 1e-3] and steps.dt_max.ends.tolist() == [0.1]
    assert build(wet(xput=FREE + "autot=1., delt=1e-3,")).clock.dt_max.spacing.tolist() == [1e10]
    assert build(wet(xput=FREE + "autot=0., delt=1e-3,", props="", fl="")).clock.dt_max.spacing.tolist() == [1e10]


def test_effects_of_the_liquid(build):
    """Each with the line that turns it on; a dry scene has none of them."""
    xput = "twfin=2., itb=1, gz=-9.81,\n ifvisc=1, impvis=1,"
    obs = "nobs=1, iob(1)=1, zh(1)=.1,\n ifrco(1)=1,"
    model = build(wet(xput=xput, props="mu1=1.,\n rhof=1000.,\n rcsql=1e-9,", obs=obs))
    assert {e.name: e.because for e in model.effects} == {
        "gravity": "line 3: gz=-9.81",
        "viscosity": "line 4: ifvisc=1",
        "liquid": "line 8: rhof=1000.0",
        "free surface": "line 3: itb=1",
        "loads": "line 19: ifrco(1)=1",
    }
    assert [e.name for e in build(wet(xput=FULL, fl="")).effects] == ["gravity", "liquid"]
    assert not any(build(wet(props="", fl="")).effects)


def test_a_plan_is_frozen(build):
    fluid = build(wet()).fluid
    with pytest.raises(dataclasses.FrozenInstanceError):
        fluid.rho = 2.0


# ---- gauges


def test_planes_and_loads(build):
    """Planes keep their numbers; loads are of stationary components that ask for it."""
    model = build(
        wet(
            flowgmo="planex(2)=.5, planezl(2)=.1, planezh(2)=.4, planez(5)=.3,",
            obs="nobs=2, iob=1,2, zh(1)=.1, xl(2)=1.9, ifrco(2)=1, ifwetar(2)=1, xfrco(2)=.3,",
            grafic="xloc=.1,.2,.3, yloc=3*.5, zloc=3*.2, if_probe_enabled(2)=0,",
        )
    )
    first, second = model.fluid.planes
    assert (first.number, first.axis, first.position) == (2, 0, 0.5) and (second.number, second.axis) == (5, 2)
    assert (first.lo[2], first.hi[2]) == (0.1, 0.4) and np.isinf([first.lo[1], first.hi[1]]).all()
    (load,) = model.fluid.loads
    assert load.body == 2 and load.point.tolist() == [0.3, 0, 0] and load.wetted_area
    assert model.output.probe_numbers == (1, 3) and model.output.probes[:, 0].tolist() == [0.1, 0.3]


@pytest.mark.parametrize(
    ("blocks", "says"),
    [
        ({"flowgmo": "planex(1)=.5, planez(1)=.5"}, ["planez(1)=0.5", "planex(1) is given too"]),
        ({"flowgmo": "planex(1)=2.5"}, ["planex(1)=2.5", "outside the mesh, 0 to 2"]),
        ({"flowgmo": "planex(1)=.5, planezl(1)=1.6"}, ["planezl(1)=1.6", "leave nothing"]),
        ({"flowgmo": "planex(1)=.5, planezl(1)=.5, planezh(1)=.4"}, ["planezl(1)=0.5", "leave nothing"]),
        ({"flowgmo": "planezl(3)=.5"}, ["planezl(3)=0.5", "there is no plane 3"]),
        ({"grafic": "xloc(2)=.1, yloc(2)=.5"}, ["zloc(2)", "a coordinate of probe 2 is missing"]),
        ({"grafic": "xloc(2)=.1, yloc(2)=.5, zloc(2)=2."}, ["zloc(2)=2.0", "outside the mesh, 0 to 1.5"]),
    ],
)
def test_gauges_that_cannot_be(problems, blocks, says):
    (found,) = problems(wet(**blocks))
    assert all(word in found for word in says), found


# ---- what the domain and the machine can hold


@pytest.mark.parametrize(
    ("mesh", "says"),
    [
        ("px=0., 1., py=0., 1., pz=0., 1.,", ["&mesh px(2)=1.0", "one cell, in which nothing flows"]),
        (MESH.replace("nycelt=10", "nycelt=1"), ["&bcdata ibct(4)=5", "one cell in y", "Write ibct(4)=1"]),
    ],
)
def test_too_few_cells(problems, mesh, says):
    (found,) = problems(wet(mesh=mesh, bcdata="ibct(4)=5, fbct(1,4)=0."))
    assert all(word in found for word in says), found


def test_directions_with_one_cell(build):
    """What cannot act there is said."""
    model = build(wet(xput=FREE + "gy=1.,", fl="flht=.5, vi=2.,", mesh=MESH.replace("nycelt=10", "nycelt=1")))
    assert sum("one cell in y, so that this moves no liquid" in notice for notice in model.notices) == 2


@pytest.mark.parametrize("shape", ["zl(1)=-.1,", "rsh(1)=3.,", "xl(1)=0., xh(1)=2., yl(1)=0., yh(1)=1.,"])
def test_a_solid_that_fills_the_mesh(problems, shape):
    (found,) = problems(wet(obs=f"nobs=1, iob(1)=1, obsid(1)='rock', {shape}"))
    assert "obsid(1)='rock'" in found and "fills the whole mesh" in found


@pytest.mark.parametrize("shape", ["zl(1)=.001,", "rsh(1)=2.5,", "xl(1)=-1., xh(1)=2., roty(1)=-2.,"])
def test_a_solid_that_leaves_room(build, shape):
    """Filled to the lid: the ball leaves a corner there only."""
    assert build(wet(fl="flht=1.5,", obs=f"nobs=1, iob(1)=1, {shape}")).fluid is not None


def test_more_memory_than_there_is(problems, build, monkeypatch):
    """Refused before an array is made: the mesh of 10^10 cells is planes only. The ghosts count."""
    (found,) = problems(wet(mesh="px=0., 1., py=0., 1., pz=0., 1.,\n size=4e-4,"))
    assert "&mesh size=0.0004: 15,625,000,000 cells need 5.8" in found and "Write a mesh of at most" in found
    block = build(wet()).mesh.blocks[0]
    assert mesh_bytes(block) == 24 * 14 * 19 * CELL_BYTES
    monkeypatch.setattr(memory, "machine_memory", lambda: mesh_bytes(block))
    assert build(wet()).fluid is not None
    monkeypatch.setattr(memory, "machine_memory", lambda: mesh_bytes(block) - 1)
    assert "nxcelt=20" in problems(wet())[0]
    assert build(wet(props="", fl="")).fluid is None  # a dry scene has no such arrays


def test_the_machine_says_how_much_it_has(monkeypatch, tmp_path):
    """The smallest of what is known; a container's limit may be 'max'."""
    limit = tmp_path / "memory.max"
    monkeypatch.setattr(memory, "CONTAINER", (str(limit), str(tmp_path / "none")))
    there = memory.machine_memory()
    limit.write_text("max\n")
    assert there is not None and there > 2**28 and memory.machine_memory() == there
    limit.write_text("1000000\n")
    assert memory.machine_memory() == 1_000_000
