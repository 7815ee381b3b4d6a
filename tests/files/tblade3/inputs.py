"""A T-Blade3 case of our own: three sections in a conical annulus, its lines named so that a test can change them."""

from pathlib import Path

TITLES = {
    "title": " Input of our own",
    "name": " windmill",
    "row_title": " Blade row #:",
    "row": "   7",
    "blades_title": " Number of blades in this row:",
    "blades": "  11",
    "scale_title": " Blade Scaling factor (mm):",
    "scale": "  250.0",
    "streamlines_title": " Number of streamlines:",
    "streamlines": "  3",
    "angles_title": " Angles in the input file (0=Beta_z (default),1=Beta_r):",
    "angles": "   0",
    "camber_title": " Airfoil camber defined by curvature control:",
    "camber": "   1  spanwise_spline",
    "thickness_title": " Airfoil Thickness distribution:",
    "thickness": "   5",
    "multiplier_title": " Airfoil Thickness multiplier (0=no,1=yes):",
    "multiplier": "   0",
    "edge_title": " Airfoil LE defined by spline (0=no,1=yes):",
    "edge": "   0",
    "chord_title": " Non-dimensional Actual chord (0=no,1=yes,2=spline):",
    "chord": "   2",
    "true_title": " True lean and sweep (0=no,1=yes):",
    "true": "   0",
    "clustering_title": " Clustering control:",
    "clustering": "   4  15",
    "sections_title": " Sectionwise properties:",
    "sections_header": " J in_Beta out_Beta mrel_in chord t/c_max Incidence Deviation Sec. Flow Angle",
    "sections_1": " 1  -40.0  -10.0  0.61  0.50  0.10  1.5  2.5  0.0",
    "sections_2": " 2  -45.0  -20.0  0.72  0.45  0.08  1.0  2.0  0.0",
    "sections_3": " 3  -50.0  -55.0  0.83  0.40  0.06  0.5  1.0  0.0",
    "curves_blank": "",
    "curves_title": " LE / TE curve (x,r) definition :",
    "curves_count_title": " Number of Curve points :",
    "curves_count": "  2",
    "curves_header": "  xLE  rLE  xTE  rTE",
    "curves_1": "  0.10  0.50  0.40  0.52",
    "curves_2": "  0.12  1.00  0.38  0.99",
    "stacking_blank": "",
    "stacking_title_1": " # a",
    "stacking_title_2": " # b",
    "stacking_title_3": " # c",
    "stacking_title_4": " # d",
    "radial_title": " Variable Radial stacking (0=no,1=yes):",
    "radial": "   0",
    "types_header": " J  type |stk_u |stk_v |umxthk |lethk |tethk",
    "types_1": " 1  sect1 30.0   5.0  0.35  0.020  0.010",
    "types_2": " 2  sect1 40.0 -15.0  0.40  0.018  0.009",
    "types_3": " 3  sect1 50.0   0.0  0.45  0.016  0.008",
    "blending_blank": "",
    "blending_title": " Control table for blending section variable:",
    "blending_count": "   2  0  0",
    "blending_header": "  span bf1 bf2",
    "blending_1": "  0.0  1  0",
    "blending_2": "  1.0  1  0",
    "code_blank": "",
    "code_title": " Stacking axis location (200=centroid):",
    "code": "   055020",
}
LAWS = {
    "sweep": ("delta_m", ((0.0, 0.01), (0.5, 0.02), (1.0, -0.03))),
    "lean": ("delta_theta", ((0.0, -0.02), (0.4, 0.05), (1.0, 0.0))),
    "in_beta": ("in_beta*", ((0.0, 3.0), (0.3, -1.0), (1.0, 2.0))),
    "out_beta": ("out_beta*", ((0.0, 4.0), (1.0, 6.0))),
    "multiplied": ("chord_multiplier", ((0.0, 0.1), (0.6, -0.1), (1.0, 0.2))),
    "tm": ("tm/c", ((0.0, 0.0), (1.0, 0.5))),
}
STREAMLINES = {
    1: ((-0.5, 0.5), (0.0, 0.5), (0.5, 0.53), (1.0, 0.55)),
    2: ((-0.5, 0.75), (0.0, 0.75), (0.5, 0.76), (1.0, 0.77)),
    3: ((-0.5, 1.0), (0.0, 1.0), (0.5, 0.99), (1.0, 0.98)),
}


def lines():
    """The lines of the main input file by name."""
    found = dict(TITLES)
    for name, (header, rows) in LAWS.items():
        found |= {
            f"{name}_blank": "",
            f"{name}_title": f" Control points for {header}:",
            f"{name}_count": f"{len(rows):12d}",
            f"{name}_header": f"   span   {header}",
        }
        found |= {f"{name}_{i}": f"  {span}  {value}" for i, (span, value) in enumerate(rows, 1)}
    found |= {
        "offset_blank": "",
        "hub_title": " Hub offset",
        "hub": "  0.0",
        "tip_title": " Tip offset",
        "tip": "  0.0",
        "stream_blank": "",
        "stream_title": "  Streamline Data",
        "stream_header": "  x_s  r_s",
    }
    for number, points in STREAMLINES.items():
        found |= {f"stream_{number}_{i}": f"  {x}  {r}" for i, (x, r) in enumerate(points, 1)}
        found[f"stream_{number}_end"] = "  0  0"
    return found


SPANWISE = """\
Casename:
 windmill
Blade row#:
7
Span control points, Chord & curvature control points
   3   5
Span   u2    u3    u4    cur1  cur2  cur3  cur4  cur5
0.00   0.2   0.50  0.80  0.10  0.60  0.40  0.20  0.00
0.45   0.25  0.55  0.85  0.00  0.50  0.50  0.10  0.10
1.00   0.3   0.60  0.90  0.30  0.20  0.60  0.40  0.20

Span control points, Chord & thickness control points
   3   1
Span   LE_radius  u_max  t_max  t_TE
0.00   4.0        0.35   0.12   0.02
0.50   4.5        0.40   0.09   0.015
1.00   5.0        0.45   0.05   0.01
"""

EDGE_HEADER = " lethk tethk s ee C_x_top C_x_bot C_y_top C_y_bot ang dis sting_l sting_h_top sting_h_bot"
EDGE = "0.02 0.01 0.0 -0.1 0.0 0.0 0.6 0.65 120.0 0.35 4.5 0.6 0.9"

OLDER = f"""\
Casename:
 windmill
Blade row#:
7
Span control points, Chord & curvature control points
   2   5  5
Span   u2    u3    u4    cur2  cur3  cur4  cur5
0.00   0.2   0.50  0.80  0.60  0.40  0.20  0.05
1.00   0.3   0.60  0.90  0.20  0.60  0.40  0.20

Span control points, Chord & thickness multiplier control points
   2   4
Span   u2   u3   thk2  thk3
0.00   0.3  0.7  0.10  0.20
1.00   0.4  0.6  0.30  0.40

Leading Edge control Parameters
   LE degree   no_Le_segments
   4   5
   2   13
 span {EDGE_HEADER}
0.0 {EDGE}
1.0 {EDGE.replace("0.02", "0.04")}
"""

SECTIONWISE = "\n".join(
    [
        "windmill",
        "Curvature sections control points:",
        *(
            f"Section {i}:\nNumber of control points:\n {3 + i}\nu and v coordinates:\n"
            + "\n".join(f"  {k / (2 + i)} ,{0.1 * i + 0.2 * k}" for k in range(3 + i))
            for i in (1, 2, 3)
        ),
        "",
        "Thickness multiplier control points:",
        *(
            f"Section {i}:\nNumber of control points:\n 3\nu and v coordinates:\n 0 ,.0\n 0.4 ,.{i}\n 1 ,.0"
            for i in (1, 2, 3)
        ),
        "",
        "Leading Edge control Parameters:",
        " LE degree(3 or 4)   no_Le_segments(4 or 5)",
        " 4  5",
        *(f"Section {i}:\n{EDGE_HEADER}\n {EDGE.replace('0.02', f'0.0{i}')}" for i in (1, 2, 3)),
        "",
    ]
)


def written(
    folder, companion=SPANWISE, kind="spancontrolinputs", *, without=(), file_name="3dbgbinput.7.dat", **changes
):
    """The path of a case with changed lines, its file of control points beside it; a line may be changed to several."""
    changed = lines() | changes
    main = Path(folder) / file_name
    main.write_text("\n".join(line for key, line in changed.items() if key not in without) + "\n")
    if companion:
        (Path(folder) / f"{kind}.{file_name.split('.')[-2]}.dat").write_text(companion)
    return main


def place_of(key):
    """The number of the line of a name."""
    return list(lines()).index(key) + 1
