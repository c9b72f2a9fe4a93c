"""The small parts of the contact engine: bounds of motions, swept boxes, the ledger of work."""

from types import SimpleNamespace

import numpy as np
import pytest
from arenas import arena_of, kinds, loose, scene_of
from flowgmo_scenes import Scene, ball, deck, solid

from flowgmo.collision.bounds import build_bounds
from flowgmo.collision.contact import CONTACT, RESPONSE, TWIST
from flowgmo.collision.extents import pairs_of_boxes, sweep_boxes
from flowgmo.collision.ledger import Ledger
from flowgmo.collision.paths import HELD, PATH
from flowgmo.collision.watch import SEARCHES, Watch
from flowgmo.errors import StepTooLong
from flowgmo.state import FROM_PRESCRIBED, LOST_IN_FRICTION

# ---- bounds.py


@pytest.mark.parametrize("name", kinds())
def test_no_motion_exceeds_its_bounds(name):
    """Rates of rate and velocity of rows .5 ms apart stay below the bounds, which the search for events steps by.

    Measured: |dω/dt| at most .51 of its bound, accelerations 1.00 (gravity, sinusoid), |ω| .99. A bound that is too
    low lets bodies pass through each other.
    """
    s = Scene(scene_of(name, collide=False))
    assert s.world.arrays["motion"][0] == kinds()[name][0]
    bound = build_bounds(s.world.arrays, s.world.laws)[0]
    h = 5e-4
    t = h * np.arange(1, 4001)
    s.to(t[-1], None, asked=t)
    v, w = s.row("v_WB")[:, 0], s.row("w_WB")[:, 0]
    rate = np.linalg.norm(w, axis=1)
    alpha = np.linalg.norm(np.diff(w, axis=0), axis=1) / h
    acc = np.linalg.norm(np.diff(v, axis=0), axis=1) / h
    near = 1 + 1e-3  # the rate between two rows may be larger than at both
    top = np.maximum(rate[1:], rate[:-1]) * near
    most = bound["turn_gain"] + bound["unevenness"] * top**2
    assert np.all(alpha <= most * near + 1e-9)
    assert np.all(acc <= (bound["gain"] + bound["lever"] * (most + top**2)) * near + 1e-9)
    assert np.all(rate <= (bound["spread"] * rate[0] + bound["turn_gain"] * t) * near)


# ---- extents.py


@pytest.mark.parametrize("name", kinds())
@pytest.mark.parametrize("sweep", [0.02, 0.7])
def test_a_swept_box_holds_the_whole_path(name, sweep):
    """The ball around B that holds the body, at 200 times of the sweep. Fails where a path leaves its box: a contact
    that is never looked for."""
    s = Scene(scene_of(name, collide=False))  # without collisions: compiles in a second, the engine in a minute
    arena = arena_of(scene_of(name))
    boxes = np.empty((len(arena.bodies), 6))
    every = np.arange(len(arena.bodies))
    sweep_boxes(every, sweep, arena.shapes, arena.bodies, arena.motion, arena.paths, arena.bounds, 0.0, boxes)
    s.to(sweep, None, asked=np.linspace(0, sweep, 201)[1:])
    p, r = s.row("p_WB")[:, 0], arena.shapes.reach[0]
    assert np.all(p - r >= boxes[0, :3] - 1e-12) and np.all(p + r <= boxes[0, 3:] + 1e-12)


def test_a_box_of_a_held_path_bends_with_it():
    """x = v t + a t²/2 along one path, larger than its chord by a t²/8 in the middle."""
    arena = arena_of(loose(ball((0, 0, 0), r=0.1, v=(1, 0, 2))))
    arena.paths["mode"][0], arena.paths["acc"][0] = HELD, (0, 0, -4)
    boxes = np.empty((len(arena.bodies), 6))
    sweep_boxes(np.array([0]), 1.0, arena.shapes, arena.bodies, arena.motion, arena.paths, arena.bounds, 0.0, boxes)
    t = np.linspace(0, 1, 101)
    path = np.column_stack([t, 0 * t, 2 * t - 2 * t**2])
    assert np.all(path.min(axis=0) - 0.1 >= boxes[0, :3] - 1e-12) and np.all(path.max(axis=0) + 0.1 <= boxes[0, 3:])
    assert boxes[0, 5] <= 0.1 + 0.5 + 0.2  # top .5; the box may be larger by little only


def test_pairs_of_boxes_are_those_that_meet():
    """Against all pairs tried one by one; more pairs than places are counted, not written."""
    rng = np.random.default_rng(4)
    n = 60
    lo = rng.uniform(-1, 1, (n, 3))
    boxes = np.concatenate([lo, lo + rng.uniform(0, 1.0, (n, 3))], axis=1)
    allowed = rng.random((n, n)) < 0.7
    allowed &= allowed.T
    expected = [
        (i, j) for i in range(n) for j in range(i + 1, n)
        if allowed[i, j] and np.all(boxes[i, :3] <= boxes[j, 3:]) and np.all(boxes[j, :3] <= boxes[i, 3:])
    ]  # fmt: skip
    out = np.zeros((len(expected), 2), dtype=np.int64)
    order = np.arange(n)
    assert pairs_of_boxes(boxes, allowed, order, out) == len(expected) > 20
    assert sorted(map(tuple, out.tolist())) == expected
    assert pairs_of_boxes(boxes, allowed, order, out[:3]) == len(expected)


# ---- ledger.py


def pushed(movable):
    """A body (0) on another one (1), a contact at (1, 0, 0) that pushes 0 up by an impulse over [2, 2.5]."""
    responses = np.zeros(8, RESPONSE)
    arena = SimpleNamespace(
        n=2, responses=responses, movable=np.array([*movable, 0, 0, 0, 0, 0, 0]), bodies=np.zeros(8),
        paths=np.zeros(8, PATH),
    )  # fmt: skip
    contact = np.zeros(1, CONTACT)
    contact["a"], contact["b"], contact["point"], contact["impulse"] = 0, 1, (1, 0, 0), (3, 0, 4)
    start, ends = np.zeros(8, TWIST), np.zeros(8, TWIST)
    start["v"][0], ends["v"][0] = (1, 0, 0), (5, 0, 1)
    start["w"][1], ends["w"][1] = (0, 0, 0), (0, -2, 0)  # at x = 1 it moves up by 2
    ledger = Ledger(arena)
    ledger.open(contact, np.array([[2.0, 6.0]]), start, ends, 2.0, 2.5)
    return ledger


@pytest.mark.parametrize("t", [1.0, 2.0, 2.1, 2.37, 2.5, 9.0])
def test_the_work_of_a_constant_force_on_a_driven_side(t):
    """-∫ F·u_b dt with u linear in time, at any time of the leg and after it: given by b's driver, and lost if the
    movable side, whose path books what it gains, does not get it."""
    ledger, books = pushed((1, 0)), np.zeros(4)
    ledger.add_until(t, books)
    tau = min(max(t - 2.0, 0.0), 0.5)
    expected = 8.0 * 2.0 * tau**2 / (2 * 0.5)  # F_z up on a, -F_z on b, whose point moves up by 2 at the end
    assert books[FROM_PRESCRIBED] == pytest.approx(expected, rel=1e-14, abs=1e-15)
    assert books[LOST_IN_FRICTION] == books[FROM_PRESCRIBED]
    np.testing.assert_allclose(ledger.forces(), [[6.0, 0, 8.0], [-6.0, 0, -8.0]])


def test_two_movable_sides_book_on_their_paths():
    """The ledger books nothing then, but counts what contacts take by right until the leg is cut: ∫ (2 + 8 t) dt."""
    ledger, books = pushed((1, 1)), np.zeros(4)
    ledger.close(2.25, books)
    assert not books.any()
    assert ledger.arena.paths["excess"][0] == pytest.approx(2.0 * 0.25 + 0.5 * 8.0 * 0.25**2, rel=1e-14)


def test_a_driven_side_gives_its_work():
    """What b's driver gives is -F·u_b: at the end F_z 8, mean u_z 1, over .5. Closing books it and forgets the leg."""
    ledger, books = pushed((1, 0)), np.zeros(4)
    ledger.close(2.5, books, np.array([0, 0, 0, 0, 0, 0, 0, 1]))
    assert not books.any()
    ledger.close(2.5, books, np.array([0, 1, 0, 0, 0, 0, 0, 0]))
    assert books[FROM_PRESCRIBED] == pytest.approx(8 * 1 * 0.5, rel=1e-14)
    again = books.copy()
    ledger.close(2.5, books)
    np.testing.assert_array_equal(books, again)
    assert not ledger.forces().any()


# ---- watch.py


def test_search_that_has_no_end_says_so():
    """A cube that turns by 1e9 in the step beside a ball that it never meets: each look may turn it a little only, and
    without a bound there would be 1e9 of them. Measured: .8 s."""
    cube = solid((-0.1,) * 3, (0.1,) * 3, "rhomvb(#)=1000., omztobs(1,#)=1e11,").replace("imo(#)=0", "imo(#)=4")
    arena = arena_of(deck(cube, ball((0.22, 0.22, 0.0))))
    watch = Watch(arena)
    arena.paths["mode"][arena.movers] = HELD
    with pytest.raises(StepTooLong, match="no end to the search"):
        watch.start(np.zeros(0, CONTACT), 0.0, 1e-2, arena.wakeful)
        watch.next()


def test_search_that_is_long_goes_on_to_its_end():
    """As above, 2500 times slower: more than SEARCHES, each of which comes a good part further. Blocks of decks/domino
    that slide past each other just apart take as many."""
    cube = solid((-0.1,) * 3, (0.1,) * 3, "rhomvb(#)=1000., omztobs(1,#)=4e7,").replace("imo(#)=0", "imo(#)=4")
    arena = arena_of(deck(cube, ball((0.22, 0.22, 0.0))))
    watch, calls = Watch(arena), []
    arena.paths["mode"][arena.movers] = HELD
    find = watch._events
    watch._events = lambda *args: (calls.append(1), find(*args))[1]
    watch.start(np.zeros(0, CONTACT), 0.0, 1e-2, arena.wakeful)
    assert watch.next()[0] == np.inf
    assert len(calls) > SEARCHES
