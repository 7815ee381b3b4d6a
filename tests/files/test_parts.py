"""Fillets, cuts, discs and shroud rings in design files: read, written to the bit, explained, and refused by name."""

import tomllib

import jsonschema
import pytest

from bladewright.blade.design.cut import AtRadius, AtX, Cut
from bladewright.blade.design.disc import Disc, Outline
from bladewright.blade.design.fillet import Fillet, FilletRadii
from bladewright.blade.design.meridional_curve import ControlPolygon, StraightsAndArcs, ThroughPoints
from bladewright.designs import Point
from bladewright.errors import DesignError
from bladewright.files.examples import example_text
from bladewright.files.keys import tables
from bladewright.files.reading import design_from
from bladewright.files.schema import schema
from bladewright.files.templates import template_text
from bladewright.files.writing import text_of, updated
from machines import sectioned, unified

THIRD = 1.0 / 3.0
LINE = (Point(-THIRD, 60.1), Point(20.7, 61.0), Point(41.3, 60.0))
EVERYTHING = {
    "density": 7800.1,
    "hub_fillet": Fillet(radius=FilletRadii(leading_edge=1.5, upper=2 + THIRD, trailing_edge=1.0, lower=2.5)),
    "shroud_fillet": Fillet(kind="ellipse", on_blade=1.1, on_wall=2.2),
    "cut": Cut(
        hub=ThroughPoints(points=LINE),
        tip=StraightsAndArcs(corners=LINE, radii=(2.1,)),
        leading_edge=AtX(x=THIRD),
        trailing_edge=AtRadius(radius=93.1),
    ),
    "disc": Disc(outline=Outline(points=(*LINE, Point(45.0, 70.0)), radii=(THIRD, 0.0))),
    "shroud_ring": Disc(thickness=3.3, upstream=THIRD),
}
OTHERS = {
    "hub_fillet": Fillet(kind="curvature", radius=(1.0, 2 + THIRD, 1.5)),
    "shroud_fillet": Fillet(
        radius=FilletRadii(leading_edge=1.0, suction_side=2.0, trailing_edge=1.0, pressure_side=THIRD)
    ),
    "cut": Cut(tip=ControlPolygon(control_points=LINE, degree=2)),
    "shroud_ring": Disc(outline=Outline(points=LINE)),
}
ANNULAR = {
    design.name: design
    for design in (*unified.DESIGNS.values(), *sectioned.DESIGNS.values())
    if design.arrangement == "annular"
}


def with_parts(design, parts):
    return design.changed({"tip_clearance": None, "hub_clearance": None, **parts})


@pytest.mark.parametrize("parts", [EVERYTHING, OTHERS], ids=["everything", "the other kinds"])
@pytest.mark.parametrize("name", ANNULAR)
def test_parts_read_back_to_the_bit_in_every_family(name, parts):
    design = with_parts(ANNULAR[name], parts)
    text = text_of(design)
    document = tomllib.loads(text)
    jsonschema.Draft202012Validator(schema()).validate(document)
    assert repr(design_from(document, name)) == repr(design)
    other = with_parts(ANNULAR[name], OTHERS if parts is EVERYTHING else EVERYTHING)
    assert repr(design_from(tomllib.loads(updated(other, text, name)), name)) == repr(other)


def test_a_number_of_a_part_changes_alone_in_its_file():
    design = with_parts(unified.FAN, EVERYTHING)
    changes = {"hub_fillet.radius.upper": 3.25, "cut.trailing_edge.radius": 91.5, "disc.outline.points[1].r": 21.0}
    before, after = text_of(design), updated(design.changed(changes), text_of(design), "fan.toml")
    lines = [pair for pair in zip(before.splitlines(), after.splitlines(), strict=True) if pair[0] != pair[1]]
    assert [new for _, new in lines] == [
        "radius = 91.5  # mm",
        "radius = { leading_edge = 1.5, trailing_edge = 1.0, upper = 3.25, lower = 2.5 }  # mm",
        f"points = [[{-THIRD}, 60.1], [20.7, 21.0], [41.3, 60.0], [45.0, 70.0]]  # mm",
    ]


def test_a_radius_along_the_section_is_no_law_along_the_span():
    found = {table.title: table for table in tables("unified")}
    radius = found["Fillet"].key("radius")
    assert (radius.laws, radius.unit) == (0, "length")
    assert radius.limits == "a number, above 0, or a list: each a number, above 0, or a table"
    text = template_text("fan")
    assert "\n#radius = 1.0\n" in text
    assert "\n#trailing_edge = { radius = 1.0 }\n" in text
    assert "[hub_fillet.radius]" not in text


@pytest.mark.parametrize(
    ("tables_of_file", "said"),
    [
        ("[hub_filet]\nradius = 1", r"hub_filet does not exist; did you mean 'hub_fillet'\?"),
        ("[hub_fillet]\nradus = 1", r"hub_fillet\.radus does not exist; did you mean 'radius'\?"),
        (
            "[hub_fillet]\nradius = { leading_edge = 1, uper = 2 }",
            r"hub_fillet\.radius\.uper does not exist; .*'upper'",
        ),
        ("[hub_fillet]\nradius = []", "give a number, or one radius or more from leading to trailing edge"),
        ("[hub_fillet]\nradius = [1, 0]", r"hub_fillet\.radius\[1\] is 0: a fillet's size must be positive"),
        ('[hub_fillet]\nkind = "elipse"', "did you mean 'ellipse'"),
        (
            "[hub_fillet]\nradius = { leading_edge = 1, trailing_edge = 1, upper = 2 }",
            "give upper and lower, or suction",
        ),
        ("[shroud_fillet]\nradius = 1", "shroud_fillet is given together with tip_clearance"),
        ("[cut]\ntrailing_edge = 93", r"cut\.trailing_edge is 93: a table of radius or a table of x"),
        ("[cut]\ntrailing_edge = { radus = 93 }", r"cut\.trailing_edge\.radus does not exist; did you mean 'radius'\?"),
        ("[cut]\ntrailing_edge = { radius = 93, x = 3 }", r"cut\.trailing_edge\.x does not exist here: .*known here"),
        ("[cut]", "the cut is empty: give hub, tip, leading_edge, trailing_edge"),
        ("[disc]", "neither is given; give one of the two"),
        (
            "[disc]\noutline = { points = [[0, 20], [60, 20]] }",
            r"disc\.outline\.points has 2 control points: at least 3",
        ),
        ("[disc]\noutline = { points = [[0, 20], [9, -3], [60, 20]] }", r"points\[1\]\.r is -3: the outline must keep"),
        ("[disc]\nthickness = 0", r"disc\.thickness is 0: it must be positive"),
        ("[disc]\nthickness = 1\nupstream = -3", r"disc\.upstream is -3: it must be positive"),
    ],
)
def test_a_mistake_in_a_part_is_named_with_its_cure(tables_of_file, said):
    document = tomllib.loads(f"{example_text('centrifugal-impeller')}\n{tables_of_file}")
    with pytest.raises(DesignError, match=said):
        design_from(document, "impeller.toml")
