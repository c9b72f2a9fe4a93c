"""What a report shows of bodies that move in a liquid: way, turn, force and its parts, torque, wetted area, energy."""

import h5py
import numpy as np
import pytest

from postproc.body_panels import body_panels
from postproc.panels import panels
from postproc.report import report
from postproc.results import Results

T = np.linspace(0, 2, 41)


def along(axis, values):
    return np.outer(values, np.eye(3)["xyz".index(axis)])


@pytest.fixture
def written(tmp_path):
    """A function that writes a history by hand: bodies {name: {quantity: values}}, books of energy."""

    def write(bodies, energy=None, liquid=True):
        folder = tmp_path / str(len(list(tmp_path.iterdir())))
        folder.mkdir()
        with h5py.File(folder / "history.h5", "w") as file:
            file.attrs.update({"format": "flowgmo history", "gravity": [0.0, 0.0, -9.81], "title": "A test"})
            file.attrs["domain"] = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]
            file["time"] = T
            still = {"orientation": np.tile([1.0, 0, 0, 0], (len(T), 1))}
            still |= {name: np.zeros((len(T), 3)) for name in ("position", "velocity", "angular_velocity")}
            if liquid:
                still |= {name: np.zeros((len(T), 3)) for name in ("force", "torque", "force_pressure")}
                still |= {"wetted_area": 1 + 0 * T}
                for name in ("volume", "volume_error", "kinetic_energy", "potential_energy"):
                    file[f"fluid/{name}"] = 1 + 0 * T
            for number, (name, given) in enumerate(bodies.items(), start=1):
                group = file.create_group(f"bodies/{name}")
                group.attrs.update({"number": number, "constraint": "six degrees"})
                for quantity, values in (still | given).items():
                    group[quantity] = values
                    group[quantity].attrs["unit"] = "N" if "force" in quantity else "m"
            for name, values in (energy or {}).items():
                file[f"energy/{name}"] = values
        return Results(folder)

    return write


def found(results):
    names = list(results.bodies)
    return {panel.title: panel for panel in body_panels(results, names, panels(results, names))}


HEAVE = {"position": along("z", 0.5 + np.sin(T)), "velocity": along("z", np.cos(T))}


def test_what_is_shown_above_is_not_shown_again(written):
    """A body that heaves: its height is above, and nothing goes sideways; of the force there is z alone."""
    shown = found(written({"buoy": HEAVE | {"force": along("z", 9 + T), "force_pressure": along("z", 9 + T)}}))
    assert list(shown) == ["Force z"]
    assert [line.text for line in shown["Force z"].lines] == ["buoy"] and shown["Force z"].unit == "N"


def test_ways_count_from_the_start(written):
    moving = {"position": along("z", 0.5 + np.sin(T)) + along("x", 3 - T), "velocity": along("x", -1 + 0 * T)}
    shown = found(written({"buoy": moving}))
    assert list(shown) == ["Way x", "Velocity x"]
    assert np.allclose(shown["Way x"].lines[0].y, -T)


def test_the_force_on_one_body_is_split(written):
    """Film and shear where they can be seen; 1e-3 of the force cannot."""
    parts = {"force": along("z", 5 + T), "force_pressure": along("z", 4 + T)}
    one = HEAVE | parts | {"force_shear": along("z", 1 + 0 * T), "force_film": along("x", 1e-3 + 0 * T)}
    lines = found(written({"ball": one}))["Force z"].lines
    assert [line.text for line in lines] == ["whole", "pressure", "shear"]
    assert np.allclose(lines[0].y, lines[1].y + lines[2].y)


def test_of_several_bodies_shear_and_film_have_panels(written):
    one = HEAVE | {"force": along("z", 5 + T), "force_film": along("z", T), "torque": along("y", T)}
    shown = found(written({"one": one, "two": HEAVE | {"force_film": along("z", 0 * T)}}))
    assert list(shown) == ["Force z", "Film force z", "Torque y"]
    assert [line.text for line in shown["Film force z"].lines] == ["one", "two"]


def test_torques_that_are_rounding_beside_the_force_are_left_out(written):
    """Force 7 on 1 m^2; 3 % of 7 N m."""
    for torque, there in ((0.1, False), (0.5, True)):
        one = HEAVE | {"force": along("z", 5 + T), "torque": along("x", torque + 0 * T)}
        assert ("Torque x" in found(written({"one": one}))) is there


def test_turns_and_wetted_area(written):
    half = T / 2
    turning = {"orientation": np.column_stack([np.cos(half), 0 * T, np.sin(half), 0 * T])}
    turning |= {"angular_velocity": along("y", 1 + 0 * T), "wetted_area": 1 + T}
    shown = found(written({"log": HEAVE | turning}))
    assert list(shown) == ["Angle about the axis", "Angular velocity y", "Wetted area"]
    assert shown["Angle about the axis"].lines[0].y[-1] == pytest.approx(np.degrees(2.0))
    shown = found(written({"log": HEAVE | turning, "post": HEAVE}))
    assert list(shown) == ["Angle about the axis", "Angular speed", "Wetted area"]


def test_what_a_drive_gives_is_shown_where_mass_has_a_part_in_it(written):
    light = HEAVE | {"force": along("z", 5 + T), "residual_force": along("z", -5 - T)}
    assert list(found(written({"plate": light}))) == ["Force z"]
    heavy = light | {"residual_force": along("z", -5 + T), "residual_torque": along("x", T)}
    assert list(found(written({"plate": heavy}))) == ["Force z", "Drive force z", "Drive torque x"]


def test_a_dry_scene_has_none(written):
    assert found(written({"ball": HEAVE}, liquid=False)) == {}


def test_the_remainder_of_the_books_is_drawn_where_it_is_seen(written):
    """In a liquid the method loses energy: the line is the change of the sum."""
    books = {"kinetic": T, "potential": 7 - 0.5 * T, "work_prescribed": 0.2 * T, "remainder": 0.3 * T}
    results = written({"ball": HEAVE}, books)
    panel = panels(results, ["ball"])[2]
    assert panel.title == "Energy of bodies and liquid"
    lines = {line.text: line.y for line in panel.lines}
    assert list(lines) == ["kinetic", "potential", "work of drives", "remainder"]
    assert lines["potential"][0] == 0.0, "from the start, or 7 would be all that is seen"
    assert np.allclose(lines["kinetic"] + lines["potential"] - lines["work of drives"], lines["remainder"])
    assert "remainder: what the books miss" in panel.note


def test_the_report_of_a_crowd_and_of_one_is_drawn(written, tmp_path):
    crowd = {f"b{k}": HEAVE | {"force": along("z", k + T), "torque": along("y", k * T)} for k in range(1, 9)}
    for bodies in (crowd, {"b1": crowd["b1"] | {"force_film": along("z", T)}}):
        assert report(written(bodies), tmp_path / "r.png").stat().st_size > 1000
