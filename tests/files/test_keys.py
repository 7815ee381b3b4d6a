"""The keys of design files as the schema states them, and the templates that explain every one of them."""

import re
import tomllib

import pytest

from bladewright import cad
from bladewright.blade.design.families import prismatic
from bladewright.errors import DesignError, FileError
from bladewright.files.families import FAMILIES
from bladewright.files.keys import tables
from bladewright.files.reading import design_from
from bladewright.files.schema import schema
from bladewright.files.templates import template_text, templates

NAMES = list(templates())


@pytest.fixture(scope="module")
def texts():
    return {name: template_text(name) for name in NAMES}


@pytest.mark.parametrize("family", FAMILIES)
def test_every_property_of_the_schema_is_a_key_with_a_meaning(family):
    definitions = schema()["$defs"]
    for table in tables(family):
        assert [key.name for key in table.keys] == list(definitions[table.title]["properties"])
        assert all(key.meaning and key.limits for key in table.keys)


def test_a_law_at_stations_is_a_law_in_the_schema_and_among_the_keys():
    laws = {key.name: key for key in tables("unified")[0].keys if key.laws}
    assert laws["stagger"].limits.startswith("a number or a law along the span")
    assert {"leading_edge_theta", "metal_angle_out", "thickness_upper"} <= set(laws)
    assert "tip_clearance" not in laws
    stagger = schema()["$defs"]["UnifiedBlade"]["properties"]["stagger"]
    assert {"$ref": "#/$defs/Stations"} in stagger["anyOf"]
    assert schema()["$defs"]["Stations"]["required"] == ["span", "values"]


def test_an_unknown_family_names_the_nearest():
    with pytest.raises(FileError, match="did you mean 'profile'"):
        tables("profil")


def commented(text):
    """The lines that hold a key which is commented out."""
    return [number for number, line in enumerate(text.splitlines()) if re.match(r"#[a-z_]+ = ", line)]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_machine_of_a_template_leaves_as_a_proven_file(texts, name, tmp_path):
    design = design_from(tomllib.loads(texts[name]), name)
    built = prismatic(design).build() if design.dimension == 2 else design.build()
    for suffix in ("step", "igs"):
        trip = cad.write(built, tmp_path / f"{name}.{suffix}")
        assert trip.passed, trip.failures


def refusal_of(text, name):
    try:
        design_from(tomllib.loads(text), name)
    except DesignError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("name", NAMES)
def test_a_template_holds_every_key_of_its_tables(texts, name):
    keys = set(re.findall(r"^#?([a-z_]+) = ", texts[name], re.MULTILINE))
    keys |= set(re.findall(r"^#?\[(?:\w+\.)*(\w+)\]", texts[name], re.MULTILINE))
    root = tables(tomllib.loads(texts[name])["family"])[0]
    assert {key.name for key in root.keys} <= keys


@pytest.mark.parametrize("name", NAMES)
def test_a_key_of_a_template_may_be_taken_from_its_comment(texts, name):
    """Each alone is valid, or refused for what it needs beside it: never as unknown, mistyped or out of its limits."""
    lines = texts[name].splitlines()
    taken = 0
    for number in commented(texts[name]):
        header = next((line for line in reversed(lines[:number]) if re.match(r"#?\[", line)), "")
        if header.startswith("#"):
            continue
        text = "\n".join([*lines[:number], lines[number][1:], *lines[number + 1 :]])
        taken += 1
        refusal = refusal_of(text, name)
        assert not re.search(r"does not exist|is needed(?! beside)|must lie|must be above", refusal), lines[number]
    assert taken > 3


@pytest.mark.parametrize("name", NAMES)
def test_a_table_of_a_template_may_be_taken_from_its_comments(texts, name):
    parsed = tomllib.loads(re.sub(r"^#(?=[\[a-z])", "", texts[name], flags=re.MULTILINE))
    assert set(parsed) == {key.name for key in tables(parsed["family"])[0].keys}


def test_a_key_of_a_table_of_another_family_is_named_with_its_path():
    text = template_text("turbine-vane").replace("[section]", "[section]\nmaximum_thickness_at = 0.4")
    with pytest.raises(DesignError, match=r"there is section\.thickness\.maximum_thickness_at of curvature-meanline"):
        design_from(tomllib.loads(text), "vane.toml")
