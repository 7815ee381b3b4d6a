"""Remarks on a case: what has no effect, what is not supported, and where T-Blade3 does not do what its files say."""

from collections.abc import Iterator

from bladewright.files.tblade3.case import STAGGER_GIVEN, TBlade3Case

_KINDS = {
    "crcle": "a circle",
    "s809m": "the wind turbine profile S809",
    "clark": "the profile Clark Y",
    "negclarkCR": "a kind of the profile Clark Y",
}


def unused_of(case: TBlade3Case, *, grid: bool) -> tuple[str, ...]:
    """What in the files has no effect on the blade, each a sentence; `grid` where sections have columns of a grid."""
    return (*_unused_columns(case, grid=grid), *_unused_tables(case))


def _unused_columns(case: TBlade3Case, *, grid: bool) -> Iterator[str]:
    sections = case.sections
    yield "mrel_in, the relative Mach number at the inlet, has no effect on the geometry"
    if any(row.secondary_flow_angle for row in sections):
        yield "Sec. Flow Angle is read but used by no version of T-Blade3"
    if case.chord != "given" and any(row.chord for row in sections):
        yield "the column chord has effect with chord switch 1 only: the chord is that between the edges"
    if case.angle_spline == "inci_dev_spline" and any(row.incidence or row.deviation for row in sections):
        yield "the columns Incidence and Deviation have no effect with inci_dev_spline, which has tables of them"
    for column, title, splines in (
        ("in_beta", "in_Beta", ("inletspline", "inoutspline")),
        ("out_beta", "out_Beta", ("outletspline", "inoutspline")),
    ):
        if case.angle_spline in splines and any(getattr(row, column) for row in sections):
            yield f"the column {title} has no effect with {case.angle_spline}, which takes it from the table {column}*"
    if case.thickness == "naca":
        yield "t/c_max, umxthk, lethk and tethk have no effect with thickness 5, which has its own table"
    elif case.leading_edge == "spline" and case.leading_edges:
        yield "lethk and tethk of the sections give way to those of the leading edge's table"
    if grid:
        yield "Jcells, eta_ofst and BGgrid belong to a grid that T-Blade3 no longer makes"
    if case.radial_stacking:
        yield f"the stacking code {case.stacking_code} gives way to stk_u and stk_v of each section"
    elif any(row.stack_u or row.stack_v for row in sections):
        yield "stk_u and stk_v have effect with variable radial stacking only: the stacking code holds for all sections"


def _unused_tables(case: TBlade3Case) -> Iterator[str]:
    yield "the table for blending is read but used by no version of T-Blade3"
    at_inlet = case.angle_spline in {"inletspline", "inoutspline", "inci_dev_spline"} or case.staggers_given
    at_exit = case.angle_spline in {"outletspline", "inoutspline", "inci_dev_spline"}
    thickness = case.thickness != "naca"
    for name, law, used in (
        ("in_beta*", case.in_beta, at_inlet),
        ("out_beta*", case.out_beta, at_exit),
        ("chord_multiplier", case.chord_multiplier, case.chord == "multiplied"),
        ("tm/c", case.thickness_multipliers, thickness),
        ("u_max", case.thickest, thickness),
    ):
        if law and not used and law.has_effect:
            yield f"the table {name} has no effect with these switches"
    if case.meanlines and not case.curvature_camber:
        yield "the control points of the curvature have no effect with camber switch 0"
    if case.multipliers and not case.thickness_multiplier:
        yield "the control points of the thickness multiplier have no effect while its switch is 0"
    if case.thickness_multiplier and not thickness:
        yield "the switch of the thickness multiplier has no effect with thickness 5"
    if case.naca:
        yield f"the spline switch {case.naca.spline_switch} beside the thickness table is never used: all are B-splines"
    if case.leading_edges:
        yield "sting_l, sting_h_top and sting_h_bot belong to a leading edge with a sting, which is not asked for"
    yield (
        f"clustering ({case.clustering}) places T-Blade3's 241 points of a section: the surfaces here are exact "
        "between them"
    )


def unsupported_of(case: TBlade3Case) -> tuple[str, ...]:
    """What T-Blade3 would make of the files that is no blade of meanlines and thicknesses, each a sentence."""
    return tuple(_unsupported(case))


def _unsupported(case: TBlade3Case) -> Iterator[str]:
    kinds: dict[str, list[int]] = {}
    for index, row in enumerate(case.sections, 1):
        kinds.setdefault(row.type, []).append(index)
    for kind, places in kinds.items():
        if kind != "sect1":
            which = ", ".join(map(str, places)) if len(places) <= 5 else f"{places[0]} to {places[-1]} ({len(places)})"
            yield (
                f"sections {which} are of the type '{kind}', {_kind(kind)}: only sect1, a meanline with a thickness, "
                "is translated; a design of the family profile takes such sections, stacked in a flow path"
            )
    for end, inflation in (("hub", case.hub_inflation), ("tip", case.tip_inflation)):
        if inflation:
            yield (
                f"the {end} inflation {inflation:g} asks for one more section beside the blade, wider by so much on "
                "all sides, in files of its own, for a fillet that another program makes: it is not made, and the "
                "blade is the one without it"
            )
    if case.staggers_given:
        yield (
            f"in_Beta of the first section is {STAGGER_GIVEN:g}, which gives staggers in the table in_beta* "
            "in place of inlet angles: a meanline with a thickness needs inlet angles"
        )


def _kind(word: str) -> str:
    """What T-Blade3 makes of a type of section, in words."""
    if word.isdigit() and len(word) == 4:
        return f"the four-digit profile NACA {word}"
    return _KINDS.get(word, "which T-Blade3 takes for the name of a file with the points of a profile")


def notes_of(case: TBlade3Case) -> tuple[str, ...]:
    """Where T-Blade3 itself fails on a case, or does something other than its files say, each a sentence."""
    return tuple(_notes(case))


def _notes(case: TBlade3Case) -> Iterator[str]:
    if case.thickness in {"quartic", "quartic-sharp"}:
        yield "T-Blade3 builds the quartic thickness up to version 1.2.2; later ones stop or crash"
    if case.leading_edge == "spline":
        yield "T-Blade3 builds leading edges as splines up to version 1.2.2; later ones refuse them"
    if case.thickness == "wennerstrom" or not case.curvature_camber:
        yield "T-Blade3 1.3.1 crashes on thickness 0 and on camber 0; version 1.2.5 builds them"
    if not case.spanwise and case.companion:
        yield "T-Blade3 1.3.1 crashes on control points section by section; version 1.2.5 reads them"
    if (case.true_sweep or case.true_lean) and (case.sweep.has_effect or case.lean.has_effect):
        yield (
            "T-Blade3 takes true lean and sweep with the wrong stagger (the metal angle's degrees as radians, or 0), "
            "and has no switch for the true one, which --true-stagger takes"
        )
    if case.multipliers and case.spanwise:
        yield (
            "T-Blade3 reads the first half of the table of the thickness multiplier only, and takes what happens to "
            "stand in memory for the rest: here all of it is taken"
        )
    if case.clustering == "elliptic" and case.thickness != "naca":
        yield "clustering 4 works with thickness 5 only"
