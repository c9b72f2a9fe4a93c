"""Contacts of the moment, found again after a motion, and the islands that they form (gather.py)."""

import numpy as np
import pytest
from arenas import G, arena_of
from flowgmo_scenes import deck, solid

from flowgmo.collision.contact import CONTACT
from flowgmo.collision.gather import KEPT, islands, no_contacts
from flowgmo.collision.watch import Watch


def cube(height):
    """A cube of edge .2 over the plane z = 0 by `height`, which is a wall of the domain."""
    text = solid((-0.1, -0.1, height), (0.1, 0.1, 0.2 + height)).replace("imo(#)=0", "imo(#)=4, rhomvb(#)=1000.")
    return arena_of(deck(text, lo=(-1, -1, 0), hi=(1, 1, 1), sides=(3, 3, 3, 3, 2, 3), g=(0, 0, -G), e=0.5, mu=0.3))


def test_a_cube_on_a_floor_touches_with_four_corners():
    """Its lower corners, normals up (from the floor, b, to the cube, a), with the pair's e and mu, all of them new."""
    found = Watch(cube(0.0)).touching(no_contacts())
    assert sorted(map(tuple, found["point"].round(12).tolist())) == [
        (x, y, 0) for x in (-0.1, 0.1) for y in (-0.1, 0.1)
    ]
    np.testing.assert_array_equal(found["normal"], [[0, 0, 1]] * 4)
    assert set(found["a"]) == {0} and set(found["b"]) == {1 + 4} and len(set(found["feature"])) == 4
    assert np.all(found["fresh"] == 1) and np.all(found["e"] == 0.5) and np.all(found["mu"] == 0.3)
    assert np.all(np.abs(found["gap"]) < 1e-15)


def test_contacts_are_found_again():
    """After 1 mm of sliding and a turn by .01 every corner has its own impulse and age again. Fails where corners are
    mixed up: the first guess of the forces is then wrong, and rest is taken for an impact."""
    arena = cube(0.0)
    watch = Watch(arena)
    before = watch.touching(no_contacts())
    before["impulse"] = np.arange(12).reshape(4, 3) + 1.0
    before["age"], before["fresh"] = 0.3 + np.arange(4), 0
    arena.motion["p"][0] += [1e-3, -5e-4, 0]
    arena.motion["q"][0] = [np.cos(0.005), 0, 0, np.sin(0.005)]
    now = watch.touching(before)
    assert len(now) == 4 and np.all(now["fresh"] == 0)
    for old in before:
        (same,) = now[now["feature"] == old["feature"]]
        assert np.linalg.norm(same["point"] - old["point"]) < 3e-3
        assert np.array_equal(same["impulse"], old["impulse"]) and same["age"] == old["age"]


@pytest.mark.parametrize(("part", "new", "kept"), [(0.5, 0, 4), (2.0, 0, 0)])
def test_a_contact_that_opens_is_kept_for_a_while(part, new, kept):
    """A gap of KEPT reaches: one that was there stays, a new one is none until it touches; beyond it both are gone."""
    arena = cube(0.0)
    watch = Watch(arena)
    before = watch.touching(no_contacts())
    arena.motion["p"][0, 2] += part * KEPT * arena.reach[0]
    assert len(watch.touching(no_contacts())) == new
    assert len(watch.touching(before)) == kept


@pytest.mark.parametrize("seed", range(5))
def test_islands_are_joined_through_what_moves_only(seed):
    """Against sets merged until nothing changes. A floor must not join all that lie on it into one cluster."""
    rng = np.random.default_rng(seed)
    n, m = 30, 25
    contacts = np.zeros(m, CONTACT)
    contacts["a"] = rng.integers(0, n, m)
    contacts["b"] = (contacts["a"] + rng.integers(1, n, m)) % n
    movable = (rng.random(n) < 0.8).astype(np.int64)
    contacts = contacts[(movable[contacts["a"]] | movable[contacts["b"]]) == 1]
    label = np.empty(len(contacts), dtype=np.int64)
    count = islands(contacts, movable, label)
    groups = [{k} for k in range(len(contacts))]
    of = [{p for p in (c["a"], c["b"]) if movable[p]} for c in contacts]
    merged = True
    while merged:
        merged = False
        for x in groups:
            for y in groups:
                if x is not y and any(of[i] & of[j] for i in x for j in y):
                    x |= y
                    groups.remove(y)
                    merged = True
                    break
            if merged:
                break
    assert count == len(groups)
    for group in groups:
        assert len({int(label[k]) for k in group}) == 1
    assert sorted(set(label.tolist())) == list(range(count))
