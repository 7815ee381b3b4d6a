"""Pictures of the runs of a study: what they hold, and that the main effects are right."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from bladewright.views.runs import DRAWINGS, MOST_AXES, effect, grouped, main_effects, parallel_coordinates


@dataclass
class Table:
    parameters: dict
    figures: dict
    name: str = "table"
    good: np.ndarray = field(default=None)

    def __post_init__(self):
        count = len(next(iter(self.parameters.values())))
        self.good = np.ones(count, dtype=bool) if self.good is None else self.good

    def heading(self, name):
        return f"{name} [mm]"


RNG = np.random.default_rng(3)


@pytest.fixture
def table():
    stagger = RNG.uniform(-1.0, 1.0, 40)
    good = np.arange(40) % 5 > 0
    throat = np.where(good, stagger, np.nan)
    return Table({"stagger": stagger, "kind": ["natural", "linear"] * 20}, {"throat": throat}, good=good)


def test_the_share_of_an_additive_model_is_that_of_each_term():
    grid = np.array([(a, b) for a in range(5) for b in range(5)], dtype=np.float64)
    figure = 3.0 * grid[:, 0] + 4.0 * grid[:, 1]
    shares = [effect(column, figure, grouped(column))[3] for column in grid.T]
    assert shares == pytest.approx([9.0 / 25.0, 16.0 / 25.0])
    at, means, errors, _ = effect(grid[:, 0], figure, grouped(grid[:, 0]))
    assert at == pytest.approx(range(5))
    assert means == pytest.approx(8.0 + 3.0 * np.arange(5))
    assert errors == pytest.approx(4.0 * np.std(np.arange(5), ddof=1) / np.sqrt(5.0))


def test_what_has_no_effect_explains_nothing_and_neither_does_what_is_constant():
    x = np.repeat(np.arange(4.0), 3)
    y = np.tile([1.0, 2.0, 3.0], 4)
    assert effect(x, y, grouped(x))[3] == pytest.approx(0.0)
    assert effect(x, np.ones(12), grouped(x))[3] == 0.0


def test_many_values_fall_into_equal_parts_of_the_range():
    x = RNG.uniform(size=1000)
    groups = grouped(x)
    assert len(groups) == 8
    assert np.array_equal(np.sum(groups, axis=0), np.ones(1000))
    assert all(np.ptp(x[group]) <= 0.126 for group in groups)


@pytest.mark.parametrize("drawing", DRAWINGS)
def test_every_drawing_names_every_column_with_its_unit(drawing, table):
    figure = DRAWINGS[drawing](table)
    words = {text.get_text().replace("\n", " ") for text in figure.findobj(lambda each: hasattr(each, "get_text"))}
    for name in ("stagger [mm]", "kind [mm]", "throat [mm]"):
        assert any(name in word for word in words), name


def test_runs_without_figures_are_grey_and_the_others_have_the_colour_of_the_first_figure(table):
    axes = parallel_coordinates(table).axes[0]
    [lines] = axes.collections
    assert len(lines.get_segments()) == 32
    assert np.array_equal(lines.get_array(), np.sort(table.figures["throat"][table.good]))
    dashed = [line for line in axes.lines if len(line.get_xdata()) == 3]
    assert len(dashed) == 8
    assert "8 without figures grey" in axes.get_title(loc="left")


def test_main_effects_leave_out_what_has_no_figure_and_write_the_share(table):
    titles = [axes.get_title(loc="left") for axes in main_effects(table).axes]
    good = table.good
    stagger, throat = np.asarray(table.parameters["stagger"])[good], table.figures["throat"][good]
    assert titles[0] == f"{100.0 * effect(stagger, throat, grouped(stagger))[3]:.0f} %"


def test_more_columns_than_can_be_read_are_left_out_and_a_single_run_is_drawn():
    many = Table({f"p{place}": RNG.uniform(size=6) for place in range(30)}, {"a": RNG.uniform(size=6)})
    assert len(parallel_coordinates(many).axes[0].get_xticks()) == MOST_AXES
    alone = Table({"stagger": [1.0], "kind": ["linear"]}, {"throat": np.array([2.0])})
    for drawing in DRAWINGS.values():
        assert drawing(alone).axes
