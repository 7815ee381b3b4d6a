"""What stays unchanged also when it is pickled or copied: mappings, and records with arrays."""

from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any, ClassVar, Generic, TypeVar, final

Key = TypeVar("Key")
Value = TypeVar("Value")


@final
class FrozenMapping(Mapping[Key, Value], Generic[Key, Value]):
    """A mapping that cannot be changed; unlike `types.MappingProxyType`, it pickles and copies."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[Key, Value]) -> None:
        self._items = dict(items)

    def __getitem__(self, key: Key) -> Value:
        return self._items[key]

    def __iter__(self) -> Iterator[Key]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __or__(self, other: Mapping[Key, Any]) -> dict[Key, Any]:
        return {**self._items, **other}

    def __ror__(self, other: Mapping[Key, Any]) -> dict[Key, Any]:
        return {**other, **self._items}

    def __repr__(self) -> str:
        return repr(self._items)


class FrozenRecord:
    """Base of frozen dataclasses that pickle and copy by their fields, through their constructor.

    So its checks hold again, arrays stay read-only, and what was worked out from the fields (`cached_property`) is left
    out and worked out again where it is asked for.
    """

    __dataclass_fields__: ClassVar[dict[str, Any]]

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_fields, (type(self), {each.name: getattr(self, each.name) for each in fields(self)})


def _from_fields(kind: type, values: dict[str, Any]) -> Any:
    return kind(**values)
