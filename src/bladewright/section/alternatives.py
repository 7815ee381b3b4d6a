"""Parts that stand for each other in a design, told apart by a literal field."""

from dataclasses import dataclass, fields
from typing import Any, Literal, get_args, get_origin, get_type_hints


@dataclass(frozen=True)
class ByField:
    """Annotates a union of parts of which each has a `Literal` field of one value, by which files tell them apart."""

    name: str
    """of the field"""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """How a file is validated: by the part that the field names, so that only its refusals are told."""
        from pydantic_core import core_schema

        choices = {self.tag(each): handler.generate_schema(each) for each in get_args(source)}
        return core_schema.tagged_union_schema(choices, discriminator=self.name)

    def tag(self, part: type[Any]) -> str:
        """The value by which a part is told."""
        return str(tags(part)[self.name])


def tags(part: type[Any]) -> dict[str, Any]:
    """The fields of a part that can have one value only, and that value: by them it is told from others."""
    hints = {name: hint for name, hint in get_type_hints(part).items() if get_origin(hint) is Literal}
    values = {each.name: get_args(hints[each.name]) for each in fields(part) if each.name in hints}
    return {name: known[0] for name, known in values.items() if len(known) == 1}
