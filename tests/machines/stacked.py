"""Blades stacked by reference points, shifted, ruled and developable, in axial, radial and plane machines."""

from dataclasses import replace

from bladewright.blade.design.stacking import Stacking

from .sectioned import COMPRESSOR, DIFFUSER, IMPELLER, VANE, through


def stacked(design, **fields):
    """A design without edge curves, stacked instead."""
    stacking, others = {}, {}
    for name, value in fields.items():
        (stacking if name in Stacking.__dataclass_fields__ else others)[name] = value
    free = {"leading_edge": None, "trailing_edge": None, "leading_edge_theta": None, "leading_edge_y": None}
    return replace(design, **free, stacking=Stacking(**stacking), **others)


AXIAL = stacked(
    COMPRESSOR,
    name="swept-rotor",
    chord=(45.0, 40.0),
    hub_x=20.0,
    theta=(0.0, 2.0),
    sweep=(0.0, 4.0, -2.0),
    lean=(0.0, 6.0, -3.0, 0.0),
    shift_directions="chordwise-normal",
)
"""true sweep and true lean of sections stacked by their centres of area"""
LINE = stacked(
    COMPRESSOR,
    name="line-stator",
    reference="chord-fraction",
    chord_fraction=(0.3, 0.4),
    chord=42.0,
    line=through((10, 80), (14, 130), (11, 180)),
    theta=1.0,
    sweep=(0.0, -1.0),
    conformal_sweep=(0.0, 0.02, 0.0),
    lean=(0.0, 2.0, 0.0),
)
"""on a stacking line, with shifts along the stream lines and around the axis"""
RADIAL = stacked(
    IMPELLER,
    name="least-distance-impeller",
    reference="leading-edge",
    chord=(95.0, 70.0),
    hub_x=2.0,
    onwards="least-distance",
    lean=(0.0, 1.0),
)
"""whose stream lines have no x in common where they run radially, and whose stagger follows from the place"""
RETURN = stacked(
    DIFFUSER, name="return-vane", plane="m-r*theta", chord=150.0, hub_m=90.0, onwards="least-distance", lean=(0.0, 4.0)
)
"""in the plane of true lengths"""
CASCADE = stacked(
    VANE, name="stacked-vane", reference="trailing-edge", chord=(46.0, 44.0), hub_x=40.0, y=(0.0, 3.0), sweep=(0.0, 2.0)
)
BESIDE = replace(
    COMPRESSOR,
    name="centred-rotor",
    leading_edge_theta=None,
    stacking=Stacking(reference="centroid", theta=(0.0, 1.5)),
    lean=(0.0, 3.0),
)
"""edge curves, and the centre of area around the axis"""
RULED = replace(
    IMPELLER,
    name="ruled-impeller",
    skinning="ruled",
    section=replace(
        IMPELLER.section, camber_angle=((-20.0, -60.0), (-30.0, -50.0), (-35.0, -40.0), -30.0), trailing_edge="blunt"
    ),
)
CONSTANT = replace(
    COMPRESSOR.section,
    metal_angle_in=48.0,
    metal_angle_out=20.0,
    thickness=replace(COMPRESSOR.section.thickness, maximum_thickness=0.08, trailing_edge_thickness=0.013),
)
PRISM = stacked(
    replace(COMPRESSOR, section=CONSTANT),
    name="flank-milled-stator",
    skinning="developable",
    reference="leading-edge",
    chord=45.0,
    hub_x=0.0,
    theta=(0.0, 4.0),
    sweep=(0.0, 2.0),
)
MILLED = replace(
    DIFFUSER,
    name="flank-milled-diffuser",
    skinning="developable",
    section=replace(DIFFUSER.section, stagger_angle=60.0),
)
PLACED = (AXIAL, LINE, RADIAL, RETURN, CASCADE, BESIDE)
ALL = (*PLACED, RULED, PRISM, MILLED)
