"""The public names are stated once, load on first use, and can be read where an engineer looks for them."""

import inspect
import pydoc
import re

import pytest

import bladewright

CALLABLE = [name for name in bladewright.__all__ if callable(getattr(bladewright, name))]
SCREEN = 24 * 80
"""characters"""


def test_help_maps_every_public_name_on_three_screens() -> None:
    text = pydoc.plain(pydoc.render_doc(bladewright))
    assert len(text.splitlines()) <= 75
    words = set(re.findall(r"\w+", bladewright.__doc__))
    assert words.issuperset(set(bladewright.__all__) - {"__version__"})


def test_completion_offers_every_public_name() -> None:
    assert set(dir(bladewright)) == set(bladewright.__all__)


@pytest.mark.parametrize("name", CALLABLE)
def test_the_signature_of_a_public_name_fits_a_screen_and_shows_no_inner_types(name: str) -> None:
    thing = getattr(bladewright, name)
    if issubclass(thing if inspect.isclass(thing) else object, Exception):
        return
    signature = str(inspect.signature(thing))
    assert len(signature) <= SCREEN
    assert "numpy." not in signature
    assert "._" not in signature
    assert all(len(repr(each.default)) < 40 for each in inspect.signature(thing).parameters.values())


@pytest.mark.parametrize("name", CALLABLE)
def test_every_public_name_has_a_docstring(name: str) -> None:
    assert inspect.getdoc(getattr(bladewright, name))


def test_the_old_name_of_a_native_body_warns() -> None:
    with pytest.warns(DeprecationWarning, match="NativeBody"):
        assert bladewright.cad.Built is bladewright.cad.NativeBody
