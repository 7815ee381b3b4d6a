"""Linear algebra of fits by one thread, and by as many as before after them."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import bladewright as bw
from bladewright.numerics.single_thread import single_threaded
from machines import example

SECTION = example("turbine-section")
POINTS = np.concatenate([curve(np.linspace(0.01, 0.99, 60)) for curve in SECTION.build().curves.values()])

ABSCISSAS = np.linspace(0.0, 1.0, 80)
PATCH = np.stack([*(np.ravel(each) for each in np.meshgrid(ABSCISSAS[::8], ABSCISSAS[::8])), np.zeros(100)], axis=-1)


def threads():
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_a_function_has_one_thread_and_those_before_it_as_many_as_before_also_where_it_fails():
    @single_threaded
    def failing():
        seen.append(threads())
        raise ArithmeticError

    seen = []
    with threadpool_limits(limits=2, user_api="blas"):
        assert threads() == {2}
        with pytest.raises(ArithmeticError):
            failing()
        assert (seen, threads()) == ([{1}], {2})


MATCHES = {
    "fit": lambda told: bw.fit(POINTS, SECTION, free="stagger", progress=told),
    "fit_curve": lambda told: bw.fit_curve(np.stack([ABSCISSAS, np.sin(ABSCISSAS)], axis=-1), progress=told),
    "fit_surface": lambda told: bw.fit_surface(PATCH, progress=told),
    "fit_profile": lambda told: bw.fit_profile(POINTS, progress=told),
}


@pytest.mark.parametrize(
    "match",
    [pytest.param(match, marks=[pytest.mark.slow] if name == "fit_profile" else []) for name, match in MATCHES.items()],
    ids=MATCHES,
)
def test_matches_have_one_thread(match):
    seen = []
    with threadpool_limits(limits=2, user_api="blas"):
        match(lambda _: seen.append(threads()))
        assert threads() == {2}
    assert seen
    assert all(each == {1} for each in seen)
