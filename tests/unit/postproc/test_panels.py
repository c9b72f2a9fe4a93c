"""What a report shows: which quantities, of which bodies, in which panels; angles; how text and strokes fit."""

import h5py
import numpy as np
import pytest
from matplotlib import pyplot as plt

from postproc import report, style
from postproc.look import clock
from postproc.panels import panels
from postproc.results import Results
from postproc.tables import aligned
from postproc.turning import angle_turned, fixed_axis, turns

T = np.linspace(0, 2, 41)


def about(axis, angle):
    """Quaternions (n, 4) of turns by `angle` (n,) about an axis."""
    axis = np.array(axis) / np.linalg.norm(axis)
    return np.column_stack([np.cos(angle / 2), np.sin(angle / 2)[:, None] * axis])


@pytest.fixture
def written(tmp_path):
    """A function that writes a history by hand: bodies {name: {quantity: values}}, books of energy."""

    def write(bodies, energy=None, mass=None, constraint="six degrees"):
        with h5py.File(tmp_path / "history.h5", "w") as file:
            file.attrs.update({"format": "flowgmo history", "gravity": [0.0, 0.0, -9.81], "title": "A test"})
            file.attrs["domain"] = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]
            file["time"] = T
            still = {"orientation": np.tile([1.0, 0, 0, 0], (len(T), 1))}
            still |= {name: np.zeros((len(T), 3)) for name in ("position", "velocity", "angular_velocity")}
            for number, (name, given) in enumerate(bodies.items(), start=1):
                group = file.create_group(f"bodies/{name}")
                group.attrs.update({"number": number, "constraint": constraint} | ({"mass": mass} if mass else {}))
                for quantity, values in (still | given).items():
                    group[quantity] = values
            for name, values in (energy or {}).items():
                file[f"energy/{name}"] = values
        return Results(tmp_path)

    return write


def shown(results, names=None):
    """Title -> texts of the legend, and the quantities that are drawn."""
    found = panels(results, list(results.bodies) if names is None else names)
    return [(p.title, [line.text for line in p.lines], {line.source.split("/")[-1] for line in p.lines}) for p in found]


def along(axis, values):
    return np.outer(values, np.eye(3)["xyz".index(axis)])


PISTON = {"position": along("x", np.sin(T)), "velocity": along("x", np.cos(T))}
FORCE = along("x", -10 * np.sin(T)) + [0.0, 0.0, 98.1]


def test_without_energies_the_force_of_the_drive_is_shown(written):
    """Along x, where the piston goes; not its weight, which is ten times as much."""
    results = written({"piston": PISTON | {"residual_force": FORCE}})
    assert shown(results) == [
        ("Position x against time", ["piston"], {"position"}),
        ("Velocity x against time", ["piston"], {"velocity"}),
        ("Force x that keeps the motion", ["piston"], {"residual_force"}),
    ]
    assert np.array_equal(panels(results, ["piston"])[2].lines[0].y, FORCE[:, 0])


def test_where_nothing_pushes_along_the_way_the_largest_force_is_shown(written):
    steady = {"position": along("x", T), "velocity": along("x", 1 + 0 * T), "residual_force": FORCE * [0, 0, 1]}
    assert shown(written({"piston": steady}))[2][0] == "Force z that keeps the motion"


@pytest.mark.parametrize("energy", [None, {"kinetic": 0 * T, "potential": 0 * T}])
def test_without_energies_and_forces_two_panels_are_left(written, energy):
    assert [title for title, *_ in shown(written({"piston": PISTON}, energy))] == [
        "Position x against time",
        "Velocity x against time",
    ]


def test_energies_come_before_the_force_and_without_those_that_are_zero(written):
    energy = {"impacts": 0 * T, "potential": -T, "kinetic": T, "remainder": 1e-14 * T}
    results = written({"piston": PISTON | {"residual_force": FORCE}}, energy)
    assert shown(results)[2] == ("Energy", ["kinetic", "potential", "sum"], {"kinetic", "potential", "sum"})
    assert "stays the same but for 1e-14 of the largest" in panels(results, ["piston"])[2].note


def test_the_sum_of_energies_is_level_when_the_books_close(written):
    """kinetic + potential + lost - work = 3; what is lost in friction is too little to see, but counts."""
    books = {"kinetic": 3 + T, "potential": -2 * T, "impacts": 2 * T, "dissipated": 1e-3 * T}
    books |= {"work_prescribed": 0.6 * T, "work_loads": 0.401 * T, "remainder": 0 * T}
    panel = panels(written({"piston": PISTON}, books), ["piston"])[2]
    assert [line.text for line in panel.lines][-1] == "sum less work"
    assert "lost in friction" not in [line.text for line in panel.lines]
    assert np.allclose(panel.lines[-1].y, 3, rtol=1e-14)
    assert panel.note.endswith("lost − work stays the same exactly")


def test_a_body_that_moves_little_up_and_far_along_is_shown_along(written):
    """0.2 up and 1 along: a block that slides, with one that tips."""
    slides = {"position": along("x", T / 2) + along("z", T / 10), "velocity": along("x", 0.5 + 0 * T)}
    assert shown(written({"block": slides}))[0][0] == "Position x against time"
    rises = {"position": along("x", T / 2) + along("z", T / 5), "velocity": along("z", 0.2 + 0 * T)}
    assert shown(written({"block": rises}))[0][0] == "Height against time"


def test_of_a_crowd_the_fastest_and_bodies_that_differ_have_curves(written):
    """Ten travel 1 to 10, one that is still going to stop starts fastest; six and fewer are all shown."""
    crowd = {f"b{k}": {"position": along("x", k * T / 2), "velocity": along("x", 0 * T)} for k in range(1, 11)}
    crowd["b4"] = {"position": along("x", 2 * T), "velocity": along("x", np.where(T == 0, 5.0, 0.0))}
    assert report._interesting(written(crowd)) == ["b1", "b4", "b6", "b10"]
    few = {name: crowd[name] for name in list(crowd)[:6]}
    assert report._interesting(written(few)) == list(few)


def test_a_body_that_only_turns_shows_its_turn(written):
    top = {"orientation": about([0, 1, 0], 3 * T), "angular_velocity": along("y", 3 + 0 * T)}
    results = written({"top": top}, {"kinetic": 1 + 0 * T})
    assert shown(results) == [
        ("Angle turned about the axis", ["top"], {"orientation"}),
        ("Angular velocity", ["x", "y", "z"], {"angular_velocity"}),
        ("Energy", ["kinetic"], {"kinetic"}),
    ]
    angle, speed, _ = panels(results, ["top"])
    assert (angle.unit, angle.lines[0].y[-1]) == ("degrees", pytest.approx(np.degrees(6)))
    assert [line.y[0] for line in speed.lines] == [0, 3, 0]


def test_a_hinged_body_shows_its_turn_though_it_travels(written):
    swing = PISTON | {"orientation": about([0, 1, 0], T), "angular_velocity": along("y", 1 + 0 * T)}
    assert shown(written({"rod": swing}, constraint="fixed axis"))[0][2] == {"orientation"}
    assert shown(written({"rod": swing}))[0][2] == {"position"}


def test_two_bodies_that_turn_share_the_panels(written):
    one = {"orientation": about([0, 1, 0], T), "angular_velocity": along("y", 1 + 0 * T)}
    two = {"orientation": about([0, 0, 1], 2 * T), "angular_velocity": along("z", 2 + 0 * T)}
    results = written({"one": one, "two": two})
    assert shown(results)[1] == ("Angular velocity about the axis", ["one", "two"], {"angular_velocity"})
    assert [line.y[0] for line in panels(results, ["one", "two"])[1].lines] == [1, 2]


def test_one_that_travels_among_those_that_turn_has_all_shown_as_travel(written):
    top = {"orientation": about([0, 1, 0], T), "angular_velocity": along("y", 1 + 0 * T)}
    assert shown(written({"top": top, "piston": PISTON}))[0][2] == {"position"}


def test_a_driven_body_that_turns_shows_its_torque(written):
    drum = {"orientation": about([0, 0, 1], T), "angular_velocity": along("z", 1 + 0 * T)}
    results = written({"drum": drum | {"residual_torque": along("z", T), "residual_force": FORCE}})
    assert shown(results)[2] == ("Torque that keeps the motion", ["x", "y", "z"], {"residual_torque"})


def test_nothing_that_moves(written):
    assert shown(written({})) == []


@pytest.mark.parametrize("inertia, answer", [(0.4, False), (1.0, False), (3.0, True)])
def test_rolling_is_travel_until_most_energy_turns(written, inertia, answer):
    """A mass of 2 at speed 1 that turns with w = 1: kinetic energy 1 + inertia."""
    moving = {"position": along("x", T), "velocity": along("x", 1 + 0 * T), "angular_velocity": along("y", 1 + 0 * T)}
    results = written({"ball": moving | {"kinetic_energy": 1 + inertia + 0 * T}}, mass=2.0)
    assert turns(results, "ball") is answer


def test_reports_of_these_histories_are_drawn(written, tmp_path):
    results = written({"drum": {"orientation": about([0, 0, 1], T), "angular_velocity": along("z", 1 + 0 * T)}})
    assert report.report(results, tmp_path / "r.png").stat().st_size > 1000


def test_angle_about_a_leaning_axis_counts_on(written):
    """Five turns forth and three back, 200 degrees from row to row: more than a quaternion alone can tell."""
    t = np.arange(24.0)
    axis = np.array([1.0, -2.0, 2.0]) / 3
    angle = np.radians(200) * np.minimum(t, 18 - t / 2)
    w = np.gradient(angle, t)[:, None] * axis
    q = about(axis, angle)
    assert np.allclose(fixed_axis(w), -axis) or np.allclose(fixed_axis(w), axis)
    sign = fixed_axis(w) @ axis
    assert np.allclose(angle_turned(t, q, w), sign * np.degrees(angle))
    assert np.allclose(angle_turned(t, -q, w), sign * np.degrees(angle))


def test_angle_without_an_axis_is_that_to_the_start():
    q = np.concatenate([about([1, 0, 0], np.array([0.0, 1.0])), about([0, 1, 0], np.array([2.0, 4.0]))])
    w = np.array([[1.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0]])
    assert fixed_axis(w) is None and fixed_axis(0 * w) is None
    assert np.allclose(angle_turned(np.arange(4.0), q, w), np.degrees([0, 1, 2, 2 * np.pi - 4]))


@pytest.mark.parametrize("width, size", [(9, 13), (13, 16)])
@pytest.mark.parametrize("letters", ["WWWW MMMM ", "A title of ordinary words, and numbers 1.25 ", "unbroken"])
@pytest.mark.parametrize("repeat", [1, 2, 12])
def test_titles_stay_on_the_page(width, size, letters, repeat):
    figure = plt.figure(figsize=(width, 4), layout="constrained")
    style.headline(figure, letters * repeat, size)
    right = figure._suptitle.get_window_extent().x1 / figure.bbox.width
    lines = figure._suptitle.get_text().splitlines()
    plt.close(figure)
    assert right < 1.0 and len(lines) <= 3


def test_a_dollar_is_a_dollar():
    figure = plt.figure(figsize=(9, 4))
    style.headline(figure, "Costs $5 or $6_a", 13)
    figure.canvas.draw()
    plt.close(figure)
    assert figure._suptitle.get_text() == r"Costs \$5 or \$6_a"


def strokes_of(*panels):
    return {key: look["ls"] for key, look in style.strokes(*(dict(enumerate(panel)) for panel in panels)).items()}


def test_a_curve_upon_another_is_broken():
    wide, same, other = np.sin(T), np.sin(T) + 1e-4, np.cos(T)
    found = strokes_of([wide, same, other])
    assert sorted([found[0], found[1]]) == ["-", "--"] and found[2] == "-"
    assert strokes_of([0 * T, np.sin(T), 0 * T]) == {0: "-", 1: "-", 2: "--"}
    assert style.strokes() == {} and style.strokes({}) == {}


def test_a_body_has_one_stroke_in_all_panels():
    """Its velocities coincide with another's, its positions do not: broken in both. Zeros throughout break nothing."""
    apart, level = [np.sin(T), 2 + np.sin(T), 4 + T], [np.cos(T), np.cos(T), 1 + 0 * T]
    found = strokes_of(apart, level)
    assert sorted([found[0], found[1]]) == ["-", "--"] and found[2] == "-"
    assert set(strokes_of(apart, [0 * T] * 3).values()) == {"-"}
    assert sorted(strokes_of([0 * T] * 3).values()) == ["-", "--", ":"]


def test_a_report_and_a_plot_have_a_body_look_alike_in_all_their_panels(written, monkeypatch, tmp_path):
    """Colour, stroke by the legend's text of every curve that is drawn, panel by panel."""
    from postproc.plot import plot

    one = {"position": along("z", np.sin(T)), "velocity": along("z", np.cos(T))}
    two = {"position": along("z", 3 + np.sin(T)), "velocity": along("z", np.cos(T))}
    results = written({"one": one, "two": two, "three": {"position": along("z", T), "velocity": along("z", T)}})
    kept = []
    monkeypatch.setattr(style, "save", lambda figure, path: kept.append(figure) or path)
    report.report(results, tmp_path / "r.png")
    plot(results, ["position", "velocity"], tmp_path / "p.png", component="z")
    for figure in kept:
        curves = [
            {line.get_label(): (line.get_color(), line.get_linestyle()) for line in axes.lines} for axes in figure.axes
        ]
        plt.close(figure)
        assert len(curves) == 2 and set(curves[0]) == {"one", "two", "three"} and curves[0] == curves[1]
        assert len(set(curves[0].values())) == 3


def test_a_level_line_is_level():
    figure, axes = plt.subplots()
    axes.plot(T, 1 + 1e-13 * T)
    style.fit_values(axes)
    low, high = axes.get_ylim()
    plt.close(figure)
    assert low < 0.8 and high > 1.2


def test_numbers_and_times_keep_their_decimals():
    assert aligned(np.array([0.6, 1.64891]), 5) == ["0.6000", "1.6489"]
    assert aligned(np.array([0.1]), 5) == ["0.10000"] and aligned(np.array([3e9]), 4) == ["3e+09"]
    assert aligned(np.zeros(2), 4) == ["0", "0"] and aligned(np.zeros(0), 4) == []
    assert [clock(t, 3.0, "s") for t in (0, 0.33333, 3)] == ["t = 0.000 s", "t = 0.333 s", "t = 3.000 s"]
    assert (
        clock(39.1, 117.3, "s") == "t = 39.1 s" and clock(0.1, 0.3, "") == "t = 0.100" and clock(0, 0, "s") == "t = 0 s"
    )


def test_columns_of_a_legend():
    assert style.columns_that_fit([1.0, 1.0, 1.0], 3.0) == 3
    assert style.columns_that_fit([1.0, 1.0, 1.0], 2.5) == 2
    assert style.columns_that_fit([5.0, 1.0], 2.5) == 1


def test_short_names_keep_their_ends():
    assert style.short("a_long_ball_1", 10) == "a_lon…ll_1" and style.short("ball", 10) == "ball"
