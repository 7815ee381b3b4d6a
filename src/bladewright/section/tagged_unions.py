"""Unions of parts in design files, distinguished by a literal field or by the first field of each."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from difflib import get_close_matches
from typing import Any, Literal, get_args, get_origin, get_type_hints


@dataclass(frozen=True)
class ByField:
    """Annotates a union of parts of which each has a `Literal` field of one value, by which files choose one."""

    name: str
    """of the field"""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """How a file is validated: by the part that the field names, so that only its refusals are reported."""
        from pydantic_core import core_schema

        choices = {self.tag(each): handler.generate_schema(each) for each in get_args(source)}
        return core_schema.tagged_union_schema(choices, discriminator=self.name)

    def tag(self, part: type[Any]) -> str:
        """The value by which files choose the part."""
        return str(tags(part)[self.name])


@dataclass(frozen=True)
class ByKey:
    """Annotates a union of parts that are distinguished in files by the first field of each, which it must have."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """How a file is validated: by the part whose first field is there, or is the nearest to a key that is."""
        from pydantic_core import core_schema

        first = {fields(each)[0].name: each.__name__ for each in get_args(source)}

        def chosen(value: Any) -> str | None:
            if not isinstance(value, Mapping):
                return type(value).__name__
            near = [key for given in value for key in get_close_matches(given, first, n=1, cutoff=0.6)]
            return next((first[key] for key in (*(key for key in first if key in value), *near, *first)), None)

        choices = {each.__name__: handler.generate_schema(each) for each in get_args(source)}
        return core_schema.tagged_union_schema(choices, discriminator=chosen)


def tags(part: type[Any]) -> dict[str, Any]:
    """The literal fields of a part that can have one value only, and that value."""
    hints = {name: hint for name, hint in get_type_hints(part).items() if get_origin(hint) is Literal}
    values = {each.name: get_args(hints[each.name]) for each in fields(part) if each.name in hints}
    return {name: known[0] for name, known in values.items() if len(known) == 1}
