"""Values: what f90nml makes of a literal is what the literal says."""

from hypothesis import given, settings
from hypothesis import strategies as st

from flowgmo.deck.row import show
from flowgmo.deck.values import FORMS, convert, repeated

TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("C",)), max_size=20)
VALUES = {
    "real": st.floats(allow_nan=False, allow_infinity=False),
    "int": st.integers(-(2**31) + 1, 2**31 - 1),
    "char": TEXTS.map(str.strip),
    "logical": st.booleans(),
}
PAIRS = st.sampled_from(sorted(VALUES)).flatmap(lambda kind: st.tuples(st.just(kind), VALUES[kind]))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    st.lists(st.sampled_from(sorted(VALUES)).flatmap(lambda kind: st.tuples(st.just(kind), VALUES[kind])), max_size=30)
)
def test_round_trip(pairs: list) -> None:
    """Any value, written as a literal, mixed with others, comes back as the same value of the same type."""
    literals = [(kind, show(value)) for kind, value in pairs]
    assert all(FORMS[kind][0].fullmatch(literal) for kind, literal in literals)
    found = convert(literals)
    assert found == [value for _, value in pairs] and [type(v) for v in found] == [type(v) for _, v in pairs]


def test_long_lists() -> None:
    """More literals than one list of f90nml is given."""
    assert convert([("int", str(k)) for k in range(4321)]) == list(range(4321))


def test_repeats() -> None:
    assert repeated("3*2.0") == (3, "2.0") and repeated("3*") == (3, None) and repeated("'2*3'") == (1, "'2*3'")
    assert repeated("2*'a*b'") == (2, "'a*b'")
