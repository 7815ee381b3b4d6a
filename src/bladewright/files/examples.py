"""The built-in examples: design files that come with the package."""

import tomllib
from importlib import resources

from bladewright.designs import unknown
from bladewright.errors import FileError


def examples() -> dict[str, str]:
    """One line about every built-in example, by its name, in alphabetical order."""
    return {name: str(tomllib.loads(example_text(name)).get("description", "")) for name in _names()}


def example_text(name: str) -> str:
    """The text of a built-in example's design file; FileError with the nearest name where there is none."""
    if name not in _names():
        raise FileError(unknown(f"the example '{name}'", name, _names()))
    return (resources.files("bladewright") / "examples" / f"{name}.toml").read_text(encoding="utf-8")


def _names() -> list[str]:
    entries = (resources.files("bladewright") / "examples").iterdir()
    return sorted(entry.name.removesuffix(".toml") for entry in entries if entry.name.endswith(".toml"))
