"""ParaBlade's designs, imported: the built sides lie on those that ParaBlade evaluates."""

import re
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest

import bladewright as bw
from bladewright.errors import DesignError, FileError
from bladewright.files.parablade import import_parablade, read_parablade
from bladewright.files.parablade.config import parsed
from bladewright.files.parablade.sections import sections_at, side_basis
from bladewright.nurbs.closest import closest_on_curve, closest_on_surface
from machines import built as built_once

_SPEC = spec_from_file_location("parablade_witness", Path(__file__).with_name("parablade.py"))
_MODULE = module_from_spec(_SPEC)
_SPEC.loader.exec_module(_MODULE)
Witness = _MODULE.Witness

CLOUDS = Path(__file__).parents[3] / "shared" / "data" / "clouds"
SECTION = """\
NDIM = 2
N_BLADES = 50
N_SECTIONS = 2
CASCADE_TYPE = LINEAR
x_leading = 0.01
y_leading = -0.002
z_leading = 1.00, 1.01
x_trailing = 0.06
z_trailing = 1.00, 1.02
x_hub =
z_hub =
x_shroud =
z_shroud =
PARAMETRIZATION_TYPE = CAMBER_THICKNESS
stagger = -30
theta_in = 25
theta_out = -60
radius_in = 0.02
radius_out = 0.006
dist_in = 0.4
dist_out = 0.5
""" + "".join(
    f"thickness_{side}_{i} = {value}\n"
    for side, values in (
        ("upper", (0.05, 0.09, 0.1, 0.08, 0.05, 0.02)),
        ("lower", (0.03, 0.05, 0.05, 0.04, 0.03, 0.015)),
    )
    for i, value in enumerate(values, 1)
)
BLADE = (
    SECTION.replace("NDIM = 2", "NDIM = 3")
    .replace("N_BLADES = 50", "N_BLADES = 20")
    .replace("LINEAR", "ANNULAR")
    .replace("z_leading = 1.00, 1.01", "z_leading = 0.10, 0.13, 0.16")
    .replace("x_leading = 0.01", "x_leading = 0.008, 0.012")
    .replace("z_trailing = 1.00, 1.02", "z_trailing = 0.11, 0.155")
    .replace("x_hub =", "x_hub = 0.03")
    .replace("z_hub =", "z_hub = 0.102")
    .replace("stagger = -30", "stagger = -20, -30, -42")
    .replace("y_leading = -0.002", "y_leading = -0.002, 0.003")
    .replace("radius_in = 0.02", "radius_in = 0.02, 0.01")
    .replace("thickness_upper_3 = 0.1", "thickness_upper_3 = 0.1, 0.06")
)
MADE = {"section": SECTION, "blade": BLADE, "cascade": BLADE.replace("ANNULAR", "LINEAR")}
MATCHED = {
    "LS89_2D": 6e-4,
    "t106eiz_2D": 7e-4,
    "Impulse_2D": 3e-4,
    "Aachen_2D": 6e-4,
    "Aachen_3D": 2e-4,
    "NASA_R67": 1.5e-3,
    "APU_rotor": 5e-4,
}
"""shipped configurations, and the distance allowed, of the chord: Rotor 67 has thicknesses on ParaBlade's own bound"""


@pytest.fixture
def file(tmp_path):
    def write(text, name="blade.cfg"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@cache
def text_of(name):
    if name in MADE:
        return MADE[name]
    path = CLOUDS / f"{name}.matched.cfg"
    if not path.is_file():
        pytest.skip(f"{path} is not there: ParaBlade's files are reference data outside the project")
    return path.read_text()


@pytest.fixture(scope="module")
def imported_once(tmp_path_factory):
    folder = tmp_path_factory.mktemp("configurations")

    @cache
    def imported(name):
        path = folder / f"{name}.cfg"
        path.write_text(text_of(name))
        return import_parablade(path)

    return imported


def places(count):
    """Around a section, dense at both edges: of the lower and of the upper side."""
    s = (1 - np.cos(np.pi * np.linspace(0.02, 0.98, count))) / 2
    return s, {"lower": s / 2, "upper": 1 - s / 2}


@pytest.mark.parametrize("name", [*MADE, "NASA_R67", "APU_rotor"])
def test_the_blade_that_is_matched_is_the_one_of_the_recipe(name):
    config, witness = parsed(text_of(name), name), Witness(text_of(name))
    v = np.array([0.0, 0.37, 1.0])
    shape = sections_at(config, v)
    s, around = places(5)
    for side, controls in zip(("upper", "lower"), shape.sides, strict=True):
        # both do the same arithmetic in another order
        assert shape.points(side_basis(s) @ controls) == pytest.approx(witness.rows(v, around[side]), abs=1e-13)


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] if name == "APU_rotor" else []) for name in (*MADE, *MATCHED)],
)
def test_the_built_sides_lie_where_the_recipe_puts_them(name, imported_once):
    imported = imported_once(name)
    built, witness = built_once(imported.design), Witness(text_of(name))
    chord, most = float(np.real(built.chord)), []
    _, around = places(15)
    for side in ("upper", "lower"):
        points = witness.rows(np.array([0.1, 0.45, 0.9]), around[side])
        if points.shape[-1] == 2:
            found = closest_on_curve(built.curves[side], points)
        else:
            found = closest_on_surface(built.surfaces[side], points.reshape(-1, 3), tolerance=1e-5)
        most.append(np.max(found.distances))
    assert max(most) < MATCHED.get(name, 5e-4) * chord


@pytest.mark.parametrize("name", ["section", "blade", "LS89_2D"])
def test_the_distance_that_is_reported_is_what_the_witness_finds(name, imported_once):
    imported = imported_once(name)
    built = built_once(imported.design)
    # from more places, so a little larger at most
    assert np.max(imported.distances(built)) < 1.3 * MATCHED.get(name, 5e-4) * float(np.real(built.chord))


@pytest.mark.parametrize(("name", "count"), [("section", 10 + 2 * 8), ("LS89_2D", 10 + 2 * 8)])
def test_as_few_control_points_as_parablade_has_can_be_asked_for(name, count, file):
    imported = import_parablade(file(text_of(name)), chordwise=8)
    assert len(imported.design.parameters()) == count
    distances = imported.distances(imported.design.build())
    assert np.mean(distances) < 2e-3 * float(np.real(imported.design.build().chord))


def test_camber_and_counts_are_kept(imported_once):
    blade = imported_once("blade").design
    assert blade.name == "blade"
    assert blade.mapping == "paper"
    assert blade.blade_count == 20
    # the section is stretched by a few parts in a thousand as its camber line ends before the noses
    assert blade.stagger == pytest.approx((-20, -30, -42), abs=0.4)
    assert blade.metal_angle_in == pytest.approx(25, abs=0.4)
    assert blade.tangent_out == pytest.approx(0.5, rel=5e-3)
    assert len(blade.channel.trailing_edge) in (2, 3)
    assert len(blade.channel.hub) == 1


def test_a_section_is_the_mean_of_both_ends(file):
    # in two dimensions z has no other effect than on the length, which scales y: at both ends, and the mean counts
    def turning(ends):
        section = read_parablade(file(SECTION.replace("1.00, 1.02", ends)))
        return np.tan(np.radians(section.stagger)) * section.axial_chord

    none, both = turning("1.00, 1.01"), turning("1.02, 1.03")
    assert both / none == pytest.approx(np.hypot(0.05, 0.02) / 0.05, rel=1e-6)
    assert turning("1.00, 1.03") == pytest.approx((none + both) / 2, rel=1e-6)


def test_blades_that_would_intersect_are_fewer_and_it_is_said(file):
    imported = import_parablade(file(BLADE.replace("N_BLADES = 20", "N_BLADES = 400")))
    count = imported.design.blade_count
    assert 10 < count < 400
    assert any(f"{count} are taken" in text for text in imported.changed)
    imported.design.build()
    with pytest.raises(DesignError, match="blade_count"):
        imported.design.changed("blade_count", count + 1).build()


def wild(seed, count):
    """Radii and thicknesses drawn over three orders of magnitude, as a matcher leaves them that checks nothing."""
    random, text = np.random.default_rng(seed), BLADE
    thicknesses = [f"thickness_{side}_{i}" for side in ("upper", "lower") for i in range(1, 7)]
    for key in ("radius_in", "radius_out", *thicknesses):
        high = 0.4 if key.startswith("radius") else 0.12
        values = np.exp(random.uniform(np.log(1e-4), np.log(high), count))
        text = re.sub(rf"(?m)^{key} = .*", f"{key} = " + ", ".join(f"{x:.5f}" for x in values), text)
    return text


@pytest.mark.parametrize(("seed", "count", "lowered"), [(0, 4, ""), (11, 1, "leading"), (23, 2, "trailing")])
def test_radii_that_the_thickness_cannot_hold_are_lowered_until_the_blade_builds(seed, count, lowered, file):
    imported = import_parablade(file(wild(seed, count)))
    said = [text for text in imported.changed if "is lowered where the thickness beside it cannot hold" in text]
    assert [text.split("_")[0] for text in said] == ([lowered] if lowered else [])
    assert imported.design.build().surfaces


def test_lines_that_parablade_passes_over_are_said(file):
    text = BLADE + "stagger = -25\n theta_in = 3\nwhat\ncolour = red\nradius_in = 0.01 # note\n#theta_out = 3\n"
    imported = import_parablade(file(text))
    assert imported.design.stagger == pytest.approx(-25, abs=0.4)
    assert imported.design.metal_angle_in == pytest.approx(25, abs=0.4)
    assert imported.design.metal_angle_out == pytest.approx(-60, abs=0.4)
    said = " ".join(imported.changed)
    for part in (
        "stagger stands there again",
        "begins with a blank",
        "has no '='",
        "colour is no key",
        "a comment behind",
    ):
        assert part in said


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("CAMBER_THICKNESS", "CONNECTING_ARCS", "wedge_in is missing"),
        ("NDIM = 2", "NDIM = 4", "NDIM is 4"),
        ("NDIM = 2\n", "", "NDIM is missing"),
        ("stagger = -30", "stagger = steep", "stagger has 'steep' where a number is needed"),
        ("stagger = -30", "stagger =", "stagger is empty"),
        ("stagger = -30", "stagger = nan", "stagger has nan"),
        ("stagger = -30\n", "", "stagger is missing"),
        ("stagger = -30", "stagger = -95", "stagger has -95: an angle must lie between -90 and 90 deg"),
        ("CASCADE_TYPE = LINEAR", "CASCADE_TYPE = SQUARE", "it must be one of LINEAR, ANNULAR"),
        ("N_BLADES = 50", "N_BLADES = many", "N_BLADES has 'many'"),
    ],
)
def test_a_configuration_that_says_no_blade_is_refused(old, new, message, file):
    with pytest.raises((FileError, DesignError)) as refused:
        read_parablade(file(SECTION.replace(old, new)))
    assert message in str(refused.value)
    assert "blade.cfg" in str(refused.value)


def test_connecting_arcs_are_refused_with_a_way_out(file):
    arcs = "wedge_in = 5\nwedge_out = 3\n" + "".join(f"dist_{i} = 0.4\n" for i in range(1, 5))
    with pytest.raises(FileError, match="only CAMBER_THICKNESS is imported; write its points as a cloud"):
        read_parablade(file(SECTION.replace("CAMBER_THICKNESS", "CONNECTING_ARCS") + arcs))


def test_an_imported_design_is_written_and_read_to_the_bit(imported_once, tmp_path):
    design = imported_once("blade").design
    bw.write_design(design, tmp_path / "blade.toml")
    assert bw.read_design(tmp_path / "blade.toml") == design
