"""Inner functions end up in the kernels that call them, whatever the order and the way of the calls.

compiler.py links the code of inner functions once for each kernel, callers first. A function left out would be a call
into nowhere: numba notices only for its own functions, ours would crash.
"""

import gc

import numpy as np
import pytest
from numba import njit
from numba.core.errors import NumbaError

from flowgmo.kernel import inner, kernel, pipelines


@inner
def square(x):
    return x * x


@inner
def fourth(x):
    return square(square(x))


@inner
def zeros_of(x):
    """Calls into numba's own library, which is linked the same way."""
    a = np.zeros(3)
    a[1] = max(min((square(x), x)), 0.5)
    return a


@inner
def both(x):
    return fourth(x) + zeros_of(x)[1]


@kernel
def low_first(x):
    return square(x) + fourth(x) + both(x)


@kernel
def high_first(x):
    return both(x) + fourth(x) + square(x)


@njit
def plain(x):
    return both(x)


@kernel
def mixed(a, k):
    """The same operations on other types: each must find its own signature."""
    return a[k] + k * 2 + a[k] * 2.0 + square(k) + square(a[k])


@kernel
def nonsense(x):
    return x + "text"


def test_functions_called_on_several_ways_are_linked():
    """square is called by all others; the order in which a kernel meets them does not matter."""
    assert low_first(2.0) == 4.0 + 16.0 + 18.0
    assert high_first(2.0) == low_first(2.0)


def test_a_function_compiled_by_numba_alone_can_call_them():
    assert plain(2.0) == 18.0


def test_signatures_that_are_remembered_are_those_of_the_types():
    """Integers stay integers beside floats: 3 + 4 + 6 + 4 + 9."""
    assert mixed(np.array([1.0, 2.0, 3.0]), 2) == 3.0 + 4 + 6.0 + 4 + 9.0
    assert mixed(np.array([1, 2, 3]), 2) == 26
    assert isinstance(mixed(np.array([1, 2, 3]), 2), float)  # a[k] * 2.0


def test_inner_functions_have_no_machine_code_of_their_own():
    """A first start takes half the time for it."""
    low_first(2.0)
    for result in fourth.overloads.values():
        assert not result.library._final_module.get_function(result.fndesc.mangled_name).is_declaration
        assert result.library.get_pointer_to_function(result.fndesc.llvm_func_name) == 0


def test_garbage_collection_goes_on_after_a_kernel_and_after_a_failure():
    assert gc.isenabled()
    with pytest.raises(NumbaError):
        nonsense(1.0)
    assert gc.isenabled()


def test_other_versions_of_numba_take_their_own_way():
    """Hooks of a version that was never tried could compile nonsense; numba's own compiler is twice as slow."""
    assert pipelines("0.69.0") == pipelines("1.0") == pipelines("0.6.8") == ({}, {}, {})
    assert "pipeline_class" in pipelines("0.68.1")[0]
