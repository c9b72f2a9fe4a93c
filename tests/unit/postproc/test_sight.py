"""What pictures show: the box of the camera, the floor, colours of many bodies, views of long rows."""

import h5py
import numpy as np
import pytest

from postproc.look import CROWD_COLOUR, body_colours, body_names, camera, scale_colour, silhouette
from postproc.palette import COLOURS, SCALE
from postproc.results import Results
from postproc.scene import Scene, Surface
from postproc.sight import Frame, frame_of, swept_box
from postproc.strip import BESIDE

CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
FACES = np.array([[0, 1, 2]])


@pytest.fixture
def staged(tmp_path):
    """A function that makes a scene of cubes by hand: {name: (positions, orientations, size)}, and solids."""

    def make(bodies, domain, solids=(), floor=False, rows=21):
        t = np.linspace(0, 1, rows)
        surfaces = []
        with h5py.File(tmp_path / "history.h5", "w") as file:
            file.attrs.update({"format": "flowgmo history", "gravity": [0.0, 0.0, -9.81], "domain": domain})
            file["time"] = t
            file["deck"] = f"&bcdata\n  ibct(1)=3 ! deck\n  ibct(5)={2 if floor else 3} ! deck\n/"
            for number, (name, (p, q, size)) in enumerate(bodies.items(), start=1):
                group = file.create_group(f"bodies/{name}")
                group.attrs["number"] = number
                group["position"], group["orientation"], group["velocity"] = p, q, np.zeros((rows, 3))
                surfaces.append(Surface(number, name, False, p[0] + CUBE * size, FACES, 0.0))
        for number, (lo, hi) in enumerate(solids, start=len(bodies) + 1):
            points = (np.array(lo) + np.array(hi)) / 2 + CUBE * (np.array(hi) - np.array(lo))
            surfaces.append(Surface(number, f"solid{number}", True, points, FACES, 0.0))
        scene = Scene.__new__(Scene)  # without snapshots on disk
        scene.results, scene.times, scene.files, scene._start = Results(tmp_path), t[[0, -1]], [], surfaces
        return scene

    return make


def still(p, rows=21):
    return np.tile(p, (rows, 1)).astype(float), np.tile([1.0, 0, 0, 0], (rows, 1)), 0.1


def spun(random, rows=21):
    """A cuboid that wanders and tumbles."""
    p = np.cumsum(random.normal(size=(rows, 3)), axis=0) * 0.05
    axis = random.normal(size=3)
    angle = random.uniform(0.01, 3) * np.sin(np.linspace(0, 6, rows))
    q = np.column_stack([np.cos(angle / 2), np.sin(angle / 2)[:, None] * axis / np.linalg.norm(axis)])
    return p, q, random.uniform(0.05, 0.6, size=3)


@pytest.mark.parametrize("results", ["anvil", "crowd"])
def test_the_box_holds_every_body_in_every_frame(results, request):
    """As far as it is in the domain; one of the crowd leaves it."""
    scene = Scene(Results(request.getfixturevalue(results)))
    box, domain = frame_of(scene).bounds, scene.bounds
    for t in np.linspace(scene.times[0], scene.end, 101):
        for surface in scene.at(t):
            inside = surface.points.clip(domain[0], domain[1])
            assert (inside >= box[0] - 1e-9).all() and (inside <= box[1] + 1e-9).all()


@pytest.mark.parametrize("seed", range(20))
def test_bodies_that_tumble_never_leave_the_box_also_between_rows(staged, seed):
    """Five poses between any two rows. The bound is geometry: no tolerance but rounding (1e-12 of the size 1)."""
    random = np.random.default_rng(seed)
    scene = staged({"a": spun(random), "b": spun(random)}, [[-50.0] * 3, [50.0] * 3])
    swept, frame = swept_box(scene), frame_of(scene).bounds
    for t in np.linspace(0, 1, 101):
        for surface in scene.at(t):
            assert (surface.points >= swept[0] - 1e-12).all() and (surface.points <= swept[1] + 1e-12).all()
    assert (frame[0] <= swept[0]).all() and (frame[1] >= swept[1]).all()


def test_a_body_that_does_not_turn_is_bounded_exactly(staged):
    scene = staged({"a": still([0.0, 0, 0])}, [[-50.0] * 3, [50.0] * 3])
    assert np.allclose(swept_box(scene), [[-0.05] * 3, [0.05] * 3], rtol=1e-12)


def test_a_small_body_in_a_large_domain_is_shown_large_upon_its_floor(staged):
    """A cube of 0.1 in a domain of 10: the box was the domain, the cube 1 % of the picture."""
    domain = [[-5.0, -5, 0], [5.0, 5, 5]]
    frame = frame_of(staged({"a": still([0.0, 0, 0.06])}, domain, floor=True))
    assert not frame.whole and np.ptp(frame.bounds, axis=0).max() < 0.2
    assert frame.bounds[0, 2] == 0.0 and (frame.floor[:, 2] == 0).all()
    assert (frame.floor.min(axis=0)[:2] < -0.05).all() and (frame.floor.max(axis=0)[:2] > 0.05).all()
    assert frame_of(staged({"a": still([0.0, 0, 0.06])}, domain)).floor is None  # an open side is no floor
    far = frame_of(staged({"a": still([0.0, 0, 3])}, domain, floor=True))
    assert far.floor is None and far.bounds[0, 2] > 2


def test_a_domain_that_is_near_is_shown_whole(staged):
    frame = frame_of(staged({"a": still([0.0, 0, 0])}, [[-0.07] * 3, [0.07] * 3]))
    assert frame.whole and np.allclose(frame.bounds, [[-0.07] * 3, [0.07] * 3])


def test_one_that_leaves_the_domain_does_not_make_the_others_tiny(staged):
    p = np.outer(np.linspace(0, 1000, 21), [1.0, 0, 0])
    away = (p, np.tile([1.0, 0, 0, 0], (21, 1)), 0.1)
    frame = frame_of(staged({"a": away, "b": still([0.0, 0.5, 0])}, [[-1.0] * 3, [1.0] * 3]))
    assert np.ptp(frame.bounds, axis=0).max() <= 2.0


def test_solids_beside_a_body_are_shown_and_a_great_slab_as_far_as_it_is_near(staged):
    domain = [[-50.0] * 3, [50.0] * 3]
    post = frame_of(staged({"a": still([0.0, 0, 0])}, domain, [([0.06, -0.01, -0.01], [0.08, 0.01, 0.06])])).bounds
    assert post[1, 0] >= 0.08 and post[1, 2] >= 0.06
    slab = frame_of(staged({"a": still([0.0, 0, 0])}, domain, [([-40, -40, -1], [40, 40, -0.06])])).bounds
    assert slab[0, 2] < -0.06 and np.ptp(slab, axis=0).max() < 0.3


def test_walls_are_read_from_the_deck_in_the_file(staged):
    assert staged({"a": still([0.0, 0, 0])}, [[-1.0] * 3, [1.0] * 3], floor=True).results.walls == {"Zmin"}
    assert staged({"a": still([0.0, 0, 0])}, [[-1.0] * 3, [1.0] * 3]).results.walls == set()


def test_many_bodies_have_colours_along_a_scale_and_a_legend_of_some(staged):
    """32 bodies had 8 colours four times each and no legend."""
    scene = staged({f"block{k}": still([k, 0.0, 0]) for k in range(1, 33)}, [[0.0, -1, -1], [33.0, 1, 1]])
    colours = body_colours(scene.moving, [])
    assert len(set(colours.values())) == 32 and (colours[1], colours[32]) == (SCALE[0], SCALE[-1])
    head, *names = body_names(scene, colours)
    assert head[0] == "colours of 32 bodies" and [names[0][0], names[-1][0]] == ["block1", "block32"]
    assert all(colour == colours[int(name[5:])] for name, colour in names)
    chosen = body_colours(scene.moving, [3, 7])
    assert (chosen[3], chosen[7], chosen[1]) == (COLOURS[0], COLOURS[1], CROWD_COLOUR)
    assert body_names(scene, chosen) == []


def test_the_scale_of_colours_goes_through_its_stops():
    assert [scale_colour(k / (len(SCALE) - 1)) for k in range(len(SCALE))] == list(SCALE)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_long_row_lies_across_the_picture(axis):
    """Its ratio of width to height is that of a picture of its own width; a cube is one of four beside each other."""
    long = np.array([[0.0, 0, 0], np.where(np.arange(3) == axis, 100.0, 6.0)])
    wide, high = silhouette("iso", Frame(long))
    assert wide > BESIDE[1][1] * high
    wide, high = silhouette("iso", Frame(np.array([[0.0] * 3, [1.0] * 3])))
    assert wide < BESIDE[0][1] * high
    assert np.linalg.norm(camera("iso", Frame(long))[0]) == pytest.approx(1)
