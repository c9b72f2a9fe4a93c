"""What bodies in the liquid cost, as counts: V-cycles, cells that are sorted anew, and what is absent. No times."""

import numpy as np
import pytest
from flowgmo_spheres import CLOSED, Counted, spheres
from flowgmo_wet import wet

from flowgmo import wet_loads
from flowgmo.flow.columns import columns_where
from flowgmo.flow.immersed import added_mass as module
from flowgmo.flow.immersed.added_mass import added_mass
from flowgmo.flow.liquid import DUST


def box(imo, z, more=""):
    return wet(
        "twfin=1., delt=.002, itb=1, ipdis=1, gz=-9.81, imobs=1,", props="rhof=1000.,", fl="flht=.45,", bcdata=CLOSED,
        mesh="px=0.,1., py=0.,1., pz=0.,1., nxcelt=24, nycelt=22, nzcelt=24,",
        obs=f"nobs=1, imo(1)={imo}, iob(1)=1, xl(1)=-.15, xh(1)=.15, yl(1)=-.12, yh(1)=.12, zl(1)=-.1, zh(1)=.1, "
        f"roty(1)=15., trnx(1)=.3, trny(1)=.5, trnz(1)={z}, {more}",
    )  # fmt: skip


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize(("n", "ratio", "bound"), [
    (1, 0.001, 8), (1, 0.5, 8), (1, 10.0, 8), (20, 0.001, 60), (20, 0.1, 18), (20, 2.0, 18),
])  # fmt: skip
def test_v_cycles_of_spheres_that_are_let_go(n, ratio, bound, full):
    """Mean of 6 steps, measured: 7.0, 3.3, 2.7, 21.7, 8.8, 3.2 under a surface, less in a full tank; most 10, 4, 4, 26,
    11, 4. A worse preconditioner, or bodies that take turns with the liquid, would show at small densities."""
    cycles = Counted(spheres(n, ratio, full=full, cells=32, across=12 if n == 1 else 6)).steps(6)
    assert np.mean(cycles) <= bound


def test_what_is_sorted_anew_grows_with_the_surface():
    """Cells over squares of diameters: measured 4.75 to 5.1; by volume the largest would have four times the least."""
    shares = []
    for across in (6, 12, 24):
        scene = Counted(spheres(1, 0.5, full=False, cells=48, across=across))
        scene.steps(2)
        shares.append(scene.changed / across**2)
    assert max(shares) < 1.6 * min(shares)


def test_lines_that_are_searched_for_regions():
    """Those of the cells that changed, of 32 x 32 lines."""
    scene = Counted(spheres(1, 0.5, full=False, cells=32, across=8))
    scene.steps(2)
    again = scene.world.liquid.projector.sealed.regions.again
    assert again.any()
    assert again.sum() <= 11**2


def test_what_walls_carry_along_is_found_once_a_step(monkeypatch):
    """A row of the history lies in every step, and each is linear between two ends: found at one, kept for the next.
    Energy and momentum share it. Before, three times a step."""
    calls = []
    found = wet_loads.beside_bodies
    monkeypatch.setattr(wet_loads, "beside_bodies", lambda *of: calls.append(1) or found(*of))
    scene = Counted(box(4, 0.45, "rhomvb(1)=500.,"))
    scene.steps(4)
    assert len(calls) == 4


def test_columns_of_liquid_are_found_again_only_where_uncovered_cells_change_them():
    """In steps that uncover cells the columns are those of the liquid as it is. Measured: 3 of 12 steps uncover some,
    under the box, where columns end; before, all were found again in every step."""
    scene = Counted(box(4, 0.5, "rhomvb(1)=500., wtobs(1,1)=1.,"))
    liquid, anew, uncovered = scene.world.liquid, [], []
    find = liquid.find_columns

    def noted(F, changed=None):
        before = liquid.near
        find(F, changed)
        assert np.array_equal(liquid.near, columns_where(F, DUST))
        if changed is not None:
            uncovered.append(len(changed[0]))
            anew.append(liquid.near is not before)

    liquid.find_columns = noted
    scene.steps(12)
    assert sum(uncovered) > 0
    assert 0 < sum(anew) <= len(anew) < 12


def couplings(scene):
    """What is handed to the solver in a step, beside matrix and right-hand side."""
    found, solver = [], scene.world.liquid.projector.solver
    solve = solver.solve

    def noted(*arguments):
        found.extend(arguments[7:])
        return solve(*arguments)

    solver.solve = noted
    scene.step()
    solver.solve = solve
    return found


def test_prescribed_bodies_and_bodies_in_air_have_no_part_in_the_equation():
    assert len(couplings(Counted(box(4, 0.45, "rhomvb(1)=500.,")))) == 1
    assert couplings(Counted(box(3, 0.45, "utobs(1,1)=.3,"))) == []
    assert couplings(Counted(box(4, 0.8, "rhomvb(1)=500.,"))) == []


def test_added_mass_of_rough_solutions(monkeypatch):
    """Box aslant at the surface, near a wall: measured 1.6e-5 of its size with 13 V-cycles; by - J . q alone the terms
    beside the diagonal would be wrong by 2e-3."""
    scene = Counted(box(4, 0.45, "rhomvb(1)=500.,"))
    scene.steps(3)
    bodies, projector = scene.world.wet_bodies, scene.world.liquid.projector
    args = bodies.coupling.fluxes[0], projector.respond, projector.q.shape, 1000.0
    scene.cycles = 0
    rough = added_mass(*args)
    cycles = scene.cycles
    monkeypatch.setattr(module, "DIGITS", 1e-9)
    exact = added_mass(*args)
    size = np.sqrt(np.outer(exact.diagonal(), exact.diagonal()))
    assert np.array_equal(rough, rough.T)
    assert (np.abs(rough - exact) <= 1e-4 * size).all()
    assert (np.abs(exact - np.diag(exact.diagonal())) / size).max() > 0.01
    assert cycles <= 24


def test_added_mass_of_a_ball_takes_three_solutions():
    """Its turns move no liquid: their fluxes, 1e-16 of those of its ways, are round-off. Six would be solved for it."""
    scene = Counted(spheres(1, 0.5, full=False, cells=24, across=8))
    scene.steps(1)
    bodies, projector = scene.world.wet_bodies, scene.world.liquid.projector
    solved = []

    def solve(*arguments):
        solved.append(arguments)
        return projector.respond(*arguments)

    A = added_mass(bodies.coupling.fluxes[0], solve, projector.q.shape, 1000.0)
    assert len(solved) == 3
    assert (A.diagonal()[:3] > 0.0).all()
    assert not A[3:].any() and not A[:, 3:].any()
