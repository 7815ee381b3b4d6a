"""What cannot stand in a flow path is refused in one paragraph: value, limit, cure."""

import numpy as np
import pytest

from bladewright.blade.design.flow_path import FlowPath
from bladewright.blade.flow_path.stream_surface_map import Conformal, DiscreteConformal
from bladewright.blade.flow_path.stream_surfaces import stream_surfaces
from bladewright.errors import DesignError
from machines.flow_paths import CYLINDER, UNEVEN, on, through

V = np.array([0.0, 0.21, 0.5, 0.83, 1.0])


def section_past(machine, u):
    lines = machine.bladed().lines(V, Conformal())
    return lines.position(np.array([u]))


REFUSED = {
    "past its end": (
        lambda: section_past(CYLINDER.changed("trailing_edge", through((1.9, 1), (1.9, 2))), 1.2),
        r"at v = [\d.]+ reaches 14.7% of its meridional extent past the downstream end of the flow path: .* lengthen",
    ),
    "abscissa past its end": (
        lambda: CYLINDER.bladed().lines(V, Conformal()).u_at(np.full((len(V), 1), -1.2)),
        "at v = 1 reaches 140% of its meridional extent past the upstream end of the flow path",
    ),
    "far from its edge": (
        lambda: section_past(CYLINDER.changed({"trailing_edge": through((0.3, 1), (0.3, 2))}), 2.2),
        "reaches more than 100% of its meridional extent downstream of its edge",
    ),
    "edge missed": (
        lambda: CYLINDER.changed("leading_edge", through((0.0, 1.0), (0.0, 1.7))).bladed().lines(V, Conformal()),
        r"leading_edge does not meet .* v = 0.83: they pass 0.096.* m apart, where .* ends at \(0, 1.735\) m",
    ),
    "edge outside": (
        lambda: CYLINDER.changed("leading_edge", through((-1.2, 1.0), (-1.2, 2.0))).bladed().lines(V, Conformal()),
        r"they pass 0.2 m apart, where the stream line starts at \(x, r\) = \(-1, 1\) m; lengthen hub and shroud",
    ),
    "edge met twice": (
        lambda: (
            CYLINDER.changed("leading_edge", on((-0.5, 2.1), (0.0, -0.5), (0.5, 2.1), degree=2))
            .bladed()
            .lines(V, Conformal())
        ),
        "leading_edge meets the stream line at v = 0 2 times, at",
    ),
    "edges swapped": (
        lambda: (
            CYLINDER.changed({"leading_edge": CYLINDER.trailing_edge, "trailing_edge": CYLINDER.leading_edge})
            .bladed()
            .lines(V, Conformal())
        ),
        "leading_edge and trailing_edge cross or are swapped: at v = 0",
    ),
    "edges swapped at which the path is matched": (
        lambda: UNEVEN.changed({"leading_edge": UNEVEN.trailing_edge, "trailing_edge": UNEVEN.leading_edge}).surfaces(),
        "leading_edge and trailing_edge cross, or are swapped",
    ),
    "v outside": (lambda: CYLINDER.bladed().lines(np.array([1.1]), Conformal()), "asked at v = 1.1"),
    "not counted": (
        lambda: CYLINDER.bladed().lines(V, DiscreteConformal()),
        "needs all of them given by points with spacing 'conformal'",
    ),
    "uneven": (
        lambda: stream_surfaces(
            FlowPath(
                hub=through((-3, 1), (-1, 0.4), (0, 0.5), (1, 0.5)),
                shroud=through((-3, 1.5), (-1, 0.9), (0, 1), (1, 1)),
                stream_surfaces=(through((0, 0.75), (1, 0.75)),),
            ),
            1.0,
        ),
        "fold over .* take matched = 'edges'",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_paragraph(case):
    make, said = REFUSED[case]
    with pytest.raises(DesignError, match=said) as refusal:
        make()
    assert "\n" not in str(refusal.value)
