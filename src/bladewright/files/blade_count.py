"""How many blades stand beside each other without intersecting, for files whose number says nothing of it."""

from collections.abc import Callable

from bladewright.errors import DesignError


def standing_apart(most: int, check: Callable[[int], None]) -> int:
    """The largest number of blades, at most `most`, at which `check` does not refuse the design's blade_count.

    Raises DesignError where it refuses something else.
    """

    def apart(count: int) -> bool:
        try:
            check(count)
        except DesignError as error:
            if "blade_count" in str(error):
                return False
            raise
        return True

    if apart(most):
        return most
    low, high = 1, most
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if apart(middle) else (low, middle)
    return low
