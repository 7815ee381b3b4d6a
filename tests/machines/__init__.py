"""The one catalogue of designs that tests are run on: by family, by what is particular, and each built once a process.

A new family of blades or sections joins the shared contract tests by its entry in `sections.EXAMPLES` and
`sectioned.DESIGNS`; everything else follows from there.
"""

from functools import cache

from bladewright.files.examples import example_text
from bladewright.files.reading import design_from, parsed

COARSE = 1e-4
"""tolerance [of the chord] of blades in tests of what does not depend on it: they have a third of the control points"""


@cache
def example(name):
    """A built-in design."""
    return design_from(parsed(example_text(name), name), name)


@cache
def built(design):
    """What a design builds; the same object for every test that asks."""
    return design.build()
