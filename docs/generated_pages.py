"""Pages that are made when the site is built: a key reference of each family, the gallery, the Python reference."""

import re
from pathlib import Path

import key_pictures
import part_key_pictures

import bladewright as bw
from bladewright.designs import Design
from bladewright.files.examples import example_text, examples
from bladewright.files.families import FAMILIES
from bladewright.files.keys import tables

HERE = Path(__file__).parent
PLACE = HERE / "generated"
LAWS = (
    "A law along the span is a list of control points from hub to shroud, or a table of values at stations, each of "
    "which it meets: `{ span = [0, 0.5, 1], values = [-8, -34, -48] }`, with `interpolation` one of `natural`, "
    "which is the default, `monotone` and `linear`."
)


def key_reference(family, of_parts):
    """The keys of a family's files, a section a table."""
    found = tables(family)
    pictures = {**of_parts, **key_pictures.draw(family, PLACE / "pictures")}
    lines = [f"# Keys of `{family}`", "", found[0].meaning, ""]
    if any(key.laws for table in found for key in table.keys):
        lines += [LAWS, ""]
    if family in key_pictures.SHOWN_IN:
        example = key_pictures.SHOWN_IN[family]
        said = f"The pictures show the mid-span section of the example `{example}` (black), and what it becomes when"
        said = f"{said} one key is raised (red) or lowered (blue) by the amount that is written below it."
        lines += [f"{said} Those of [fillets, cuts and discs](../wheels.md) show the same of an impeller.", ""]
    for table in found:
        if table is found[0]:
            lines += ["## The file", ""]
        else:
            holders = dict.fromkeys(key.name for each in found for key in each.keys if table.title in key.holds)
            where = ", ".join(f"`{name}`" for name in holders)
            lines += [f"## {table.title}", "", f"*In {where}.* {table.meaning}", ""]
        for key in table.keys:
            lines += _key(key, pictures.get((table.title, key.name)))
    return lines


def _key(key, picture):
    default = "required" if key.required else ("" if key.default in (None, "", []) else f"default `{key.default}`")
    unit = {"": "", "-": "no unit", "length": "in `length_unit`", "deg": "degrees"}.get(key.unit, f"in {key.unit}")
    kinds = "kinds " + ", ".join(f"[{each}](#{each.lower()})" for each in key.holds) if key.holds else ""
    facts = "; ".join(each for each in (key.limits, unit, kinds, default or "optional") if each)
    lines = [f"### {key.name}", "", _sentence(key.meaning), "", f"*{facts}*", ""]
    if picture is not None:
        name, said = picture
        lines += [f"![{key.name}](pictures/{name})", "", f"{said}.", ""]
    return lines


def _sentence(text):
    text = re.sub(r"\s*\[(?:-|deg|length|kg/m\^3)\]$", "", " ".join(text.split()))
    return f"{text[0].upper()}{text[1:]}." if text else ""


def gallery():
    """Every built-in example with its picture."""
    lines = ["# Gallery", "", "Every built-in example: `bladewright new NAME` writes its design file.", ""]
    for name, description in examples().items():
        lines += [f"## {name}", "", f"{description}.", ""]
        picture = HERE.parent / "exports" / f"{name}.png"
        if picture.exists():
            lines += [f"![{name}](../../exports/{name}.png)", ""]
        lines += ["```toml", example_text(name).strip(), "```", ""]
    return lines


def python_reference():
    """Every public name, in the order of the map that `help(bladewright)` prints."""
    text = bw.__doc__.split("\n\n", 4)[-1].rsplit("\n\n", 1)[0]
    public = [name for name in bw.__all__ if not name.startswith("_")]
    order = [name for name in re.findall(r"\w+", text) if name in public]
    modules = ("cad", "meshing")
    lines = ["# Python reference", "", "```{eval-rst}"]
    for name in dict.fromkeys([*order, *public]):
        if name not in modules:
            lines += _reference(f"bladewright.{name}", getattr(bw, name))
    for module in modules:
        room = getattr(bw, module)
        for name, own in vars(room).items():
            if callable(own) and getattr(own, "__module__", "").startswith(f"{room.__name__}."):
                lines += _reference(f"bladewright.{module}.{name}", own)
    return [*lines, "```", ""]


def _reference(path, own):
    """A public function, or a class and its members; not those that parts of designs and errors share."""
    if not isinstance(own, type):
        return [f".. autofunction:: {path}", ""]
    # of designs, whose fields stand on the pages of keys, what each kind adds
    inherited = [] if issubclass(own, (Design, Exception)) else ["   :inherited-members: Part"]
    return [f".. autoclass:: {path}", "   :members:", *inherited, ""]


def write(_app):
    (PLACE / "pictures").mkdir(parents=True, exist_ok=True)
    of_parts = part_key_pictures.draw(PLACE / "pictures")
    pages = {f"keys-{family}": key_reference(family, of_parts) for family in FAMILIES}
    pages |= {"gallery": gallery(), "python": python_reference()}
    for name, lines in pages.items():
        (PLACE / f"{name}.md").write_text("\n".join(lines), encoding="utf-8")


def setup(app):
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True}
