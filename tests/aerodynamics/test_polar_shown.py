"""A polar as table, dictionary and picture, from what XFOIL left in a file."""

import pickle

from bladewright.views.polar import draw_polar
from machines.polars import recorded_polar


def test_table_and_dictionary_have_every_angle(tmp_path):
    polar = recorded_polar()
    polar.to_csv(tmp_path / "polar.csv")
    rows = (tmp_path / "polar.csv").read_text().splitlines()
    assert rows[0] == "alpha,cl,cd,cdp,cm,transition_upper,transition_lower"
    assert [float(each) for each in rows[2].split(",")] == [
        float(getattr(polar, name)[1]) for name in rows[0].split(",")
    ]
    assert rows[3] == "30.0,,,,,,"
    assert polar.to_dict()["cl"][:2] == list(polar.cl[:2])
    assert polar.failures[0] in str(polar)
    assert pickle.loads(pickle.dumps(polar)).cl[1] == polar.cl[1]


def test_a_picture_has_four_curves_pressure_and_friction(tmp_path):
    polar = recorded_polar()
    titles = [axes.get_title(loc="left") for axes in polar.plot().axes]
    assert titles[:4] == ["Lift", "Drag", "Moment", "Lift over drag"]
    assert {"Pressure, XFOIL 6.99", "Skin friction"} <= set(titles)
    draw_polar([polar, polar], tmp_path / "polar.svg", [4.0])
    assert (tmp_path / "polar.svg").stat().st_size > 10_000
    assert "best cl / cd" in polar._repr_html_()
