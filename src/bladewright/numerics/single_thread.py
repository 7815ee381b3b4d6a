"""One thread for linear algebra: matrices of searches are too small to be shared out."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

P = ParamSpec("P")
T = TypeVar("T")


def single_threaded(function: Callable[P, T]) -> Callable[P, T]:
    """The function with one BLAS thread while it runs: more wait for each other, and end in another rounding.

    By two threads on two idle cores a match takes a tenth longer, and a plain fit of a curve or surface twice as long
    (design/matching.md).
    """

    @wraps(function)
    def alone(*args: P.args, **kwargs: P.kwargs) -> T:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return alone
