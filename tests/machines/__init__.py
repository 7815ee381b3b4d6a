"""The one catalogue of designs that tests are run on: by family, by what is particular, and each built once a process.

A new family of blades or sections joins the shared contract tests by its entry in `sections.EXAMPLES` and
`sectioned.DESIGNS`; everything else follows from there.
"""

from functools import cache

from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed


@cache
def example(name):
    """A built-in design."""
    return design_from(parsed(example_text(name), name), name)


@cache
def built(design):
    """What a design builds; the same object for every test that asks."""
    return design.build()


@cache
def built_example(name, tolerance=None):
    """What a built-in design builds; at another tolerance [of the chord] where one is given."""
    design = example(name)
    return built(design if tolerance is None else design.changed("tolerance", tolerance))
