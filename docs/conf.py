"""The site: `sphinx-build -W --keep-going docs docs/_build/html` makes it, warnings being errors."""

import re
import sys
from pathlib import Path

from pygments.lexers.special import TextLexer

import bladewright as bw

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

project = "bladewright"
version = release = bw.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "generated_pages"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"bladewright {version}"
myst_heading_anchors = 3
suppress_warnings = [
    "ref.python",  # `law` and `kind` are fields of several classes
    "misc.highlighting_failure",  # tables of numbers, `csv`, have no highlighting
]
autodoc_member_order = "bysource"
autodoc_default_options = {"exclude-members": "__init__"}
autodoc_class_signature = "separated"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"


def as_rst(_app, _what, _name, _object, _options, lines):
    """Docstrings are plain text with `code`: what else reStructuredText would read into them is taken literally."""
    for number, line in enumerate(lines):
        plain = re.split(r"(`[^`]*`)", line)
        lines[number] = "".join(
            f"`{part}`" if part.startswith("`") else re.sub(r"([*|_\\])", r"\\\1", part) for part in plain
        )


def within_the_tree(_app, _page, source):
    """Links to files of the repository that are no pages become their names."""
    source[0] = re.sub(r"\[([^\]]*)\]\(\.\./([^)#]*)[^)]*\)", r"\1", source[0])


def setup(app):
    app.add_lexer("csv", TextLexer)
    app.connect("source-read", within_the_tree)
    app.connect("autodoc-process-docstring", as_rst)
