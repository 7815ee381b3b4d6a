"""Parts that stand for each other in a design, told apart by a literal field."""

from dataclasses import dataclass, fields
from typing import Any, get_args, get_type_hints


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
        if self.name not in {each.name for each in fields(part)}:
            raise TypeError(f"{part.__name__} has no field '{self.name}' that tells it from others")
        return str(get_args(get_type_hints(part)[self.name])[0])
