"""What is asked of every family that is one part: its exact outline, its derivatives, its native section."""

import jsonschema
import numpy as np
import pytest

from bladewright.errors import DesignError
from bladewright.files.families import FAMILIES
from bladewright.files.reading import design_from, parsed
from bladewright.files.schema import schema
from bladewright.files.writing import text_of
from bladewright.section.crossing import check_outline
from bladewright.section.laws import Span
from bladewright.section.planar import PlanarSection
from machines import built
from machines.sections import EXAMPLES

SCHEMA = jsonschema.Draft202012Validator(schema())
STEP = 1e-30
S = np.linspace(0.0, 1.0, 61)


@pytest.fixture(params=list(EXAMPLES))
def example(request):
    return EXAMPLES[request.param]


def outline_of(part, v=(0.0,)):
    return part.outline(Span(np.array(v)))


def everything(part, v=(0.0,), s=S):
    """All numbers (..., m, k, 2) that stacking sees of a part's sections."""
    outline, span = outline_of(part, v), Span(np.array(v))
    ends = [np.stack(start, axis=-2) for start in starts_of(outline)]
    turn = part.stagger(span)[..., None]
    parts = [*outline.points(s), outline.camber(s), *ends, np.stack([np.cos(turn), np.sin(turn)], axis=-1)]
    shape = np.broadcast_shapes(*[each.shape[:-2] for each in parts])
    return np.concatenate([np.broadcast_to(each, (*shape, *each.shape[-2:])) for each in parts], axis=-2)


def starts_of(outline):
    return [side for edge in (outline.leading_edge, outline.trailing_edge) for side in (edge.upper, edge.lower)]


def test_the_chord_line_runs_from_zero_to_one_and_the_sides_meet_at_its_ends(example):
    outline = outline_of(example.part())
    ends = np.array([0.0, 1.0])
    upper, lower = (points[0] for points in outline.points(ends))
    camber = outline.camber(ends)[0]
    if outline.on_chord_line:
        assert camber == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.0]]), abs=1e-14)
    for i, edge in enumerate((outline.leading_edge, outline.trailing_edge)):
        assert edge.upper.point[0] == pytest.approx(upper[i], abs=1e-14)
        assert edge.lower.point[0] == pytest.approx(lower[i], abs=1e-14)
        if edge.kind == "blunt":
            face = upper[i] - lower[i]
            share = np.dot(camber[i] - lower[i], face) / np.dot(face, face)
            assert 0.0 < share < 1.0
            assert lower[i] + share * face == pytest.approx(camber[i], abs=1e-12)
        else:
            assert upper[i] == pytest.approx(camber[i], abs=1e-14)
            assert lower[i] == pytest.approx(camber[i], abs=1e-14)


def test_the_edges_derivatives_are_those_of_the_points_beside_them(example):
    outline = outline_of(example.part())
    inner = [joint.s for joint in outline.joints]
    starts = starts_of(outline)
    for start, end, reach in ((starts[:2], 0.0, min([*inner, 0.5])), (starts[2:], 1.0, 1.0 - max([*inner, 0.5]))):
        # a branch of an edge's ellipse stands about as far behind its joint as the joint behind the edge
        size = min(0.5 * reach, 0.08)
        nodes = size * (1.0 - np.cos(np.pi * (np.arange(14) + 0.5) / 14)) / 2.0
        sign = 1.0 if end == 0.0 else -1.0
        at = end + sign * nodes
        order = np.argsort(at)
        sides = [np.empty((14, 2)) for _ in range(2)]
        for side, points in zip(sides, outline.points(at[order]), strict=True):
            side[order] = points[0]
        for side, exact in zip(sides, start, strict=True):
            scaled = 2.0 * nodes / size - 1.0
            fitted = [np.polynomial.Chebyshev.fit(scaled, side[:, k], 13, domain=[-1, 1]) for k in (0, 1)]
            for number, power in ((1, sign), (2, 1.0)):
                found = [each.deriv(number)(-1.0) * (2.0 / size) ** number * power for each in fitted]
                # differentiating interpolation at 14 nodes loses about 13^2 a time, over `size`
                allowed = 1e-14 * (400.0 / size) ** number + 1e-7 * np.max(np.abs(exact[number]))
                assert np.array(found) == pytest.approx(exact[number][0], abs=allowed)


def test_a_round_edge_has_opposite_first_and_equal_second_derivatives(example):
    outline = outline_of(example.part())
    for edge in (outline.leading_edge, outline.trailing_edge):
        if edge.kind != "round":
            continue
        assert np.linalg.norm(edge.upper.first) > 0.0
        assert edge.upper.first == pytest.approx(-edge.lower.first, rel=1e-12, abs=1e-14)
        size = np.max(np.abs(edge.upper.second))
        assert edge.upper.second == pytest.approx(edge.lower.second, abs=1e-11 * size)


def test_joints_lie_inside_in_order_and_lose_derivatives(example):
    outline = outline_of(example.part())
    places = [0.0, *(joint.s for joint in outline.joints), 1.0]
    assert np.all(np.diff(places) > 0.0)
    assert all(0 <= joint.derivatives < 5 for joint in outline.joints)


def test_no_outline_crosses_itself_and_the_upper_side_lies_on_the_left(example):
    check_outline(outline_of(example.part()), [""])
    assert built(example.design).area > 0.0


def test_native_curves_follow_the_outline(example):
    section, design = built(example.design), example.design
    outline, turn = outline_of(example.part()), example.part().stagger(Span(np.zeros(1)))[0]
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    for name, points in zip(("upper", "lower"), outline.points(S), strict=True):
        exact = design.chord * 1e-3 * points[0] @ rotation.T + [
            design.leading_edge_x * 1e-3,
            design.leading_edge_y * 1e-3,
        ]
        # compared at five places in each knot span, between which the error may be a little larger
        assert section.curves[name](S) == pytest.approx(exact, abs=2.0 * design.tolerance * design.chord * 1e-3)
    # sixth-order curves of what is smooth between its joints need no more
    assert len(section.curves["upper"].control_points) < 250


def test_the_section_has_the_chord_stagger_and_angles_asked_for(example):
    section = built(example.design)
    assert section.reference_chord == pytest.approx(example.design.chord * 1e-3, rel=1e-14)
    if section.outline.on_chord_line:
        assert section.chord == pytest.approx(example.design.chord * 1e-3, rel=1e-14)
    if example.metal_angles is not None:
        # slopes of curves within 1e-10 of the exact ones, on spans of a hundredth
        found = np.degrees([section.metal_angle_in, section.metal_angle_out])
        assert found == pytest.approx(example.metal_angles, abs=1e-5)


def test_the_section_is_as_thick_as_asked_for(example):
    if example.maximum_thickness is not None:
        # found on 201 places of the camber line, with a parabola between
        thickest = built(example.design).maximum_thickness[0]
        assert thickest == pytest.approx(example.maximum_thickness * example.design.chord * 1e-3, rel=1e-4)


def test_every_parameter_moves_the_sections_and_its_complex_step_is_its_derivative(example):
    part, values = example.part(), example.part().parameters()
    paths = list(values)
    batch = {path: values[path] + STEP * 1j * row for path, row in zip(paths, np.eye(len(paths)), strict=True)}
    analytic = np.imag(everything(part.changed(batch))) / STEP
    largest = np.max(np.abs(analytic), axis=(1, 2, 3))
    assert {path for path, size in zip(paths, largest, strict=True) if size == 0.0} == set(example.dead)
    # all at once, each by a share of its own of what moves the numbers alike, so that none can be wrong unseen
    shares = np.random.default_rng(5).uniform(0.5, 1.0, len(paths))
    direction = np.divide(shares, largest, out=np.zeros_like(shares), where=largest > 0.0)
    found = np.tensordot(direction, analytic, axes=1)
    step = 1e-5 * min(max(1e-2, abs(values[path])) / way for path, way in zip(paths, direction, strict=True) if way)
    low, high = (
        everything(
            part.changed({path: values[path] + sign * step * way for path, way in zip(paths, direction, strict=True)})
        )
        for sign in (-1.0, 1.0)
    )
    # central differences err by step^2 and by rounding over the step; second derivatives at edges are large numbers
    rounding = 4e-15 * np.max(np.abs(everything(part))) / step
    assert found == pytest.approx((high - low) / (2.0 * step), abs=5e-7 * np.sum(shares) + rounding)


def test_a_batch_of_designs_is_each_of_them(example):
    part = example.part()
    values = part.parameters()
    for path in (next(iter(values)), list(values)[-1]):
        pair = np.array([values[path], values[path] * (1.0 + 1e-3) + 1e-6])
        batch = everything(part.changed(path, pair))
        singles = [everything(part.changed(path, float(value))) for value in pair]
        assert batch == pytest.approx(np.stack(singles), abs=1e-12 * np.max(np.abs(batch)))


def test_laws_along_the_span_give_the_section_of_their_values_at_each_place(example):
    part = example.part()
    values = part.parameters()
    other = {path: value * (1.0 + 1e-3) + 1e-6 for path, value in values.items()}
    found = everything(part.changed({path: (values[path], other[path]) for path in values}), v=(0.0, 0.5, 1.0))
    for i, share in enumerate((0.0, 0.5, 1.0)):
        single = part.changed({path: value + share * (other[path] - value) for path, value in values.items()})
        # s is one for all sections, and does not depend on the numbers of any
        assert found[i] == pytest.approx(everything(single)[0], abs=1e-11 * np.max(np.abs(found[i])))


def test_built_curves_carry_a_complex_step_at_held_knots(example):
    design, section = example.design, built(example.design)
    path, value = next(iter(example.part().parameters().items()))
    path = f"section.{path}"

    def points(at):
        built = design.changed(path, at).build(knots=section.knots)
        return np.concatenate([curve(S) for curve in (*built.curves.values(), built.camber)])

    analytic = np.imag(points(value + STEP * 1j)) / STEP
    step = 1e-5 * max(1e-2, abs(value))
    central = (points(value + step) - points(value - step)) / (2.0 * step)
    assert analytic == pytest.approx(central, abs=1e-6 * np.max(np.abs(analytic)))


@pytest.mark.parametrize("name", [name for name, each in EXAMPLES.items() if type(each.design) in FAMILIES.values()])
def test_a_file_holds_a_design_to_the_bit_and_the_schema_takes_it(name):
    design = EXAMPLES[name].design
    document = parsed(text_of(design), name)
    assert repr(design_from(document, name)) == repr(design)
    SCHEMA.validate(document)


def test_every_family_of_files_that_is_one_part_has_an_example():
    kinds = {kind for kind in FAMILIES.values() if issubclass(kind, PlanarSection)}
    assert kinds <= {type(each.design) for each in EXAMPLES.values()}


def test_a_single_section_refuses_a_law_along_the_span(example):
    path, value = next(iter(example.part().parameters().items()))
    with pytest.raises(DesignError, match=r"section\..*law along the span"):
        example.design.changed(f"section.{path}", (value, value))


def test_neighbours_that_meet_are_refused(example):
    with pytest.raises(DesignError, match=r"pitch is .*larger pitch"):
        example.design.changed("pitch", 1e-3 * example.design.chord).build()
