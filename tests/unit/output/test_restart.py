"""restart.h5: bit for bit, and clear words for every file that does not fit."""

from dataclasses import fields, replace

import h5py
import numpy as np
import pytest

from flowgmo.output import OutputError, RestartError, read_restart, write_restart
from flowgmo.output.deck_text import assignments
from flowgmo.state import State, initial_state


@pytest.fixture
def model(scenes):
    return scenes.all_kinds()


@pytest.fixture
def state(model):
    """Every field with bits that text would lose."""
    state, random = initial_state(model), np.random.default_rng(7)
    for name, values in (("held_parts", state.held_parts), ("held_values", state.held_values)):
        setattr(state, name, np.zeros((5, values.shape[1]), values.dtype))  # five contacts that stay
    for field in fields(State):
        value = getattr(state, field.name)
        if isinstance(value, np.ndarray) and value.dtype.kind == "f":
            value[...] = random.normal(size=value.shape) * np.pi
        elif isinstance(value, np.ndarray):
            value[...] = random.integers(-1, 2, value.shape)
        elif isinstance(value, float):
            setattr(state, field.name, np.pi * 1e-7)
        elif isinstance(value, bool):  # before int, which it is one of
            setattr(state, field.name, not value)
        elif isinstance(value, int):
            setattr(state, field.name, 2**40 + 1)
    state.v_WB[0] = [-0.0, 5e-324, 1e308]
    return state


def test_round_trip_keeps_every_bit(tmp_path, model, state):
    write_restart(tmp_path / "restart.h5", model, state)
    back = read_restart(tmp_path / "restart.h5", model)
    for field in fields(State):
        old, new = getattr(state, field.name), getattr(back, field.name)
        assert type(old) is type(new), field.name
        if isinstance(old, np.ndarray):
            assert old.dtype == new.dtype and old.tobytes() == new.tobytes(), field.name
        else:
            assert old == new, field.name


def test_the_arrays_read_can_be_written_to(tmp_path, model, state):
    write_restart(tmp_path / "restart.h5", model, state)
    read_restart(tmp_path / "restart.h5", model).p_WB[0] = 1.0


def test_the_old_file_survives_a_failed_write(tmp_path, model, state):
    path = tmp_path / "restart.h5"
    write_restart(path, model, state)
    state_of_before = path.read_bytes()
    broken = replace(state, p_WB=np.array([object()]))
    with pytest.raises((OutputError, TypeError)):
        write_restart(path, model, broken)
    assert path.read_bytes() == state_of_before
    assert [p.name for p in tmp_path.iterdir()] == ["restart.h5"]


def test_end_and_output_may_change(tmp_path, model, state):
    write_restart(tmp_path / "restart.h5", model, state)
    deck = model.resolved_deck.replace("twfin = 2.0", "twfin = 9.0").replace("tpltd(1)=0.2", "tpltd(1)=0.5")
    assert deck != model.resolved_deck
    read_restart(tmp_path / "restart.h5", replace(model, resolved_deck=deck))


def test_another_deck_is_refused_with_what_differs(tmp_path, model, state):
    write_restart(tmp_path / "restart.h5", model, state)
    deck = model.resolved_deck.replace("gz = -9.81", "gz = -1.62")
    with pytest.raises(RestartError, match=r"GZ was -9\.81, is -1\.62"):
        read_restart(tmp_path / "restart.h5", replace(model, resolved_deck=deck))


def test_other_bodies_are_refused(tmp_path, scenes, model, state):
    write_restart(tmp_path / "restart.h5", model, state)
    with pytest.raises(RestartError, match="holds 4 bodies, the deck has 2"):
        read_restart(tmp_path / "restart.h5", scenes.anvil())
    renamed = replace(model, bodies=(replace(model.bodies[0], name="egg"), *model.bodies[1:]))
    with pytest.raises(RestartError, match=r"component 1 was ball \(coupled, six degrees\), is egg"):
        read_restart(tmp_path / "restart.h5", renamed)


def test_missing_foreign_and_damaged_files(tmp_path, model, state):
    path = tmp_path / "restart.h5"
    with pytest.raises(RestartError, match="there is no restart file"):
        read_restart(path, model)
    path.write_bytes(b"something else")
    with pytest.raises(RestartError, match="not a readable restart file"):
        read_restart(path, model)
    with h5py.File(path, "w") as file:
        file["x"] = 1
    with pytest.raises(RestartError, match="not a restart file of flowgmo"):
        read_restart(path, model)
    write_restart(path, model, state)
    whole = path.read_bytes()
    for part in (100, len(whole) // 2, len(whole) - 200):
        path.write_bytes(whole[:part])
        with pytest.raises(RestartError):
            read_restart(path, model)


@pytest.mark.parametrize(
    "damage, told",
    [
        (lambda f: f.attrs.update({"format_version": 99}), "restart format 99"),
        (lambda f: f.__delitem__("state/p_WB"), "not a readable restart file"),
        (lambda f: f["state/v_WB"].__setitem__((0, 0), np.nan), "v_WB is not finite"),
        (lambda f: (f.__delitem__("state/angle"), f.__setitem__("state/angle", np.zeros(2))), "angle has shape"),
        (
            lambda f: (
                f.__delitem__("state/held_parts"),
                f.__setitem__("state/held_parts", np.zeros((4, 2), dtype="i8")),
            ),
            "held_parts has shape",
        ),
        (lambda f: f["state/held_values"].__setitem__((1, 3), np.inf), "held_values is not finite"),
    ],
)
def test_damage_inside(tmp_path, model, state, damage, told):
    write_restart(tmp_path / "restart.h5", model, state)
    with h5py.File(tmp_path / "restart.h5", "r+") as file:
        damage(file)
    with pytest.raises(RestartError, match=told):
        read_restart(tmp_path / "restart.h5", model)


def test_assignments_of_a_deck():
    text = """Title's 6-DOF, a = 1
     &xput
       twfin = 1.5,   ! deck
       Delt=1.e-3 , gx = 0.0  ! default, the vendor's: = TWFIN/1000
     /
     &obs obsid(1) = 'it''s ! a = b', utobs(1, 2) = 1.0, 2.0,
        3.0
     /
     &mesh px(1)=0.0 /
     &mesh px(1)=2.0 /
    """
    assert assignments(text) == {
        "twfin": "1.5",
        "delt": "1.e-3",
        "gx": "0.0",
        "obsid(1)": "'it''s ! a = b'",
        "utobs(1,2)": "1.0 2.0 3.0",
        "px(1)": "0.0 | 2.0",
    }
