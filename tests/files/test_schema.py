"""The JSON Schema of design files takes what reading takes, and refuses what it refuses."""

import copy
import tomllib
from dataclasses import fields
from typing import get_type_hints

import jsonschema
import pytest

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.files.examples import example_text, examples
from bladewright.files.families import FAMILIES
from bladewright.files.reading import design_from
from bladewright.files.schema import schema

SCHEMA = schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
FAN = tomllib.loads(example_text("fan-rotor"))


SECTION = {
    "family": "unified-section",
    "name": "vane",
    "length_unit": "mm",
    "axial_chord": 40,
    "stagger": -40.0,
    **dict.fromkeys(["metal_angle_in", "metal_angle_out"], -30.0),
    **dict.fromkeys(["tangent_in", "tangent_out", "leading_edge_radius", "trailing_edge_radius"], 0.05),
    "thickness_upper": [0.1, 0.1],
    "thickness_lower": [0.1, 0.1],
}


def designs_in(kind):
    yield kind
    for hint in get_type_hints(kind).values():
        if isinstance(hint, type) and issubclass(hint, Design):
            yield from designs_in(hint)


CLASSES = {found.__name__: found for kind in FAMILIES.values() for found in designs_in(kind)}


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("name", examples())
def test_every_example_is_valid(name):
    document = tomllib.loads(example_text(name))
    VALIDATOR.validate(document)
    assert type(design_from(document, name)) is FAMILIES[document["family"]]


@pytest.mark.parametrize("name", CLASSES)
def test_every_field_has_its_docstring_and_its_unit(name):
    for each in fields(CLASSES[name]):
        entry = SCHEMA["$defs"][name]["properties"][each.name]
        assert entry["description"] or "$ref" in entry
        assert entry.get("unit") == each.metadata.get("unit")


def test_a_section_is_valid():
    VALIDATOR.validate(SECTION)
    assert design_from(SECTION, "file").axial_chord == 40.0


@pytest.mark.parametrize(
    "change",
    [{"axial_chord": None}, {"stagger": [1.0, 2.0]}, {"channel": FAN["channel"]}, {"family": "unified"}],
    ids=str,
)
def test_a_section_is_refused_where_it_is_no_section(change):
    document = {key: value for key, value in {**SECTION, **change}.items() if value is not None}
    assert not VALIDATOR.is_valid(document)
    with pytest.raises(DesignError):
        design_from(document, "file")


@pytest.mark.parametrize(
    "change",
    [
        {"stagger": "steep"},
        {"stagger": [1.0, True]},
        {"stager": 3.0},
        {"family": "unifid"},
        {"family": None},
        {"length_unit": None},
        {"length_unit": "inch"},
        {"tangent_in": None},
        {"blade_count": 22.5},
        {"blade_count": "22"},
        {"thickness_lower": 0.3},
        {"thickness_lower": [[[0.3]]]},
        {"tip_clearance": "0.6"},
        {"tip_clearance": [0.6]},
        {"tip_clearance": [0.6, 0.5, 0.4]},
        {"hub_clearance": [0.6, True]},
        {"channel": 3},
        {"channel": {}},
        {"channel": {**FAN["channel"], "hubb": []}},
        {"channel": {**FAN["channel"], "hub": [[1.0]]}},
        {"channel": {**FAN["channel"], "hub": [[1.0, 2.0, 3.0]]}},
        {"channel": {**FAN["channel"], "hub": [[1.0, "x"]]}},
        {"channel": {**FAN["channel"], "degree": 6}},
    ],
    ids=str,
)
def test_what_the_schema_refuses_reading_refuses(change):
    document = {key: value for key, value in {**copy.deepcopy(FAN), **change}.items() if value is not None}
    assert not VALIDATOR.is_valid(document)
    with pytest.raises(DesignError):
        design_from(document, "file")


def test_what_a_file_cannot_say_is_not_in_the_schema():
    assert "null" not in str(SCHEMA)
    assert "None" not in str(SCHEMA)
