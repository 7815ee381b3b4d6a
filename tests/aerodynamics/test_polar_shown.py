"""A polar as table, dictionary and picture, from what XFOIL left in a file."""

import pickle
from dataclasses import replace

from bladewright.views.polar import polar_figure
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


def test_a_picture_has_four_curves_pressure_and_friction():
    figure = polar_figure([recorded_polar(), replace(recorded_polar(), solver="another")], [4.0])
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[:4] == ["Lift", "Drag", "Moment", "Lift over drag"]
    assert {"Pressure, XFOIL 6.99", "Skin friction"} <= set(titles)
    assert [text.get_text() for legend in figure.subfigs[0].legends for text in legend.get_texts()] == [
        "XFOIL 6.99",
        "another",
    ]
