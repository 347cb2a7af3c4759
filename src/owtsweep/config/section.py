"""The base class of all sections of a configuration, and the declaration of a section's keys.

A section is a frozen pydantic model. Each field of the model is a configuration key.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from types import UnionType
from typing import Annotated, Any, TypeGuard, Union, get_args, get_origin

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator
from pydantic.fields import FieldInfo

#: The least and the largest magnitude of a number other than zero. Beyond them, squares, fourth
#: powers and their products may overflow or vanish.
SMALLEST, LARGEST = 1e-30, 1e30


def require_magnitude(value: float) -> float:
    """Return the number `value`; raise `ValueError` if its magnitude is not from 1e-30 to 1e30."""
    if math.isfinite(value) and value != 0.0 and not SMALLEST <= abs(value) <= LARGEST:
        raise ValueError(
            f"{value:g} cannot be computed with; its magnitude must be from {SMALLEST:g} to "
            f"{LARGEST:g}"
        )
    return value


#: Types of numbers. Bounds of a single field are given as `key(..., ge=1)`.
Finite = Annotated[float, Field(allow_inf_nan=False), AfterValidator(require_magnitude)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False), AfterValidator(require_magnitude)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False), AfterValidator(require_magnitude)]

#: Plain data: nested dicts, lists and scalars, as pydantic, OmegaConf and JSON give them. What lies
#: inside is known only once `typed` has made an object of them.
Plain = dict[str, Any]

BOUNDS = ("gt", "ge", "lt", "le")
#: The defaults of those facts that `key` declares besides a type, a default and bounds.
NO_FACTS = {"unit": "", "form": "", "advice": ""}
#: How messages and docs/configuration.md name a type.
TYPE_NAMES: dict[object, str] = {
    bool: "true or false",
    str: "text",
    int: "a whole number",
    float: "a number",
}


class Section(BaseModel):
    """The base class of all sections of a configuration, a pydantic model.

    A section is frozen and refuses unknown keys. Numbers and texts are converted to what a key
    expects ("2" to 2, 2.0 to an integer); but true and false are accepted only, and alone, where
    one of them is expected.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", coerce_numbers_to_str=True)

    @classmethod
    def __pydantic_init_subclass__(cls, **_: object) -> None:
        """Raise `TypeError` if a field of a new subclass puts bounds on a list of numbers.

        pydantic would compare such bounds with the list, not with the numbers in the list.
        """
        for name, field in cls.model_fields.items():
            bounded = any(hasattr(mark, sign) for mark in field.metadata for sign in BOUNDS)
            if bounded and get_origin(bare_type(field.annotation)) is list:
                raise TypeError(
                    f"{cls.__name__}.{name}: the bounds of a list's numbers belong to their type, "
                    "e.g. Axis[Positive] or Axis[Annotated[int, Field(ge=1)]]"
                )

    @field_validator("*", mode="before")
    @classmethod
    def _keep_true_and_false_apart(cls, value: object, info: ValidationInfo) -> object:
        kind = item_type(cls.model_fields[str(info.field_name)].annotation)
        if kind in TYPE_NAMES:
            for item in value if isinstance(value, list) else [value]:
                if item is not None and isinstance(item, bool) != (kind is bool):
                    raise ValueError(f"{item!r} is not {TYPE_NAMES[kind]}")
        return value


def key(
    meaning: str,
    *,
    default: object = ...,
    unit: str = "",
    form: str = "",
    advice: str = "",
    **bounds: Any,
) -> Any:
    """Declare a key of a section of the configuration; a key without a default is required.

    meaning: What the key means, for docs/configuration.md.
    unit: Unit of a number, or of each number of a list.
    form: What a list must hold, in words, for error messages, e.g. "two edges in Hz".
    advice: a remedy, for the error message about a number below its lower bound.
    bounds: as for `pydantic.Field`: ge, gt, le and lt for a number, min_length and max_length for a
        list.
    """
    facts: Plain = {"unit": unit, "form": form, "advice": advice}
    return Field(default, description=meaning, json_schema_extra=facts, **bounds)


def read_facts(field: FieldInfo) -> dict[str, str]:
    """Return facts about a configuration key: a dict with unit, form and advice.

    `field` is the pydantic field of the key, declared by the function `key`. A fact that was not
    declared has its default.
    """
    extra = field.json_schema_extra
    given = extra if isinstance(extra, dict) else {}
    return {fact: str(given.get(fact, none)) for fact, none in NO_FACTS.items()}


def list_marks(field: FieldInfo) -> list[Any]:
    """Return the bounds and validators of a key, also those inside its type: of a list's items."""
    return [*field.metadata, *_nested(field.annotation)]


def _nested(annotation: Any) -> Iterator[Any]:
    for argument in get_args(annotation):
        yield from argument.metadata if isinstance(argument, FieldInfo) else _nested(argument)
    if get_origin(annotation) is Annotated:
        yield from annotation.__metadata__


def bare_type(annotation: object) -> object:
    """Return a type without its bounds and without `| None`, e.g. float for `Positive | None`."""
    if get_origin(annotation) is Annotated:
        return bare_type(get_args(annotation)[0])
    if get_origin(annotation) in (UnionType, Union):
        return bare_type(next(kind for kind in get_args(annotation) if kind is not type(None)))
    return annotation


def item_type(annotation: object) -> object:
    """Return the type of a list's items, else the type itself, without bounds and `| None`."""
    kind = bare_type(annotation)
    return bare_type(get_args(kind)[0]) if get_origin(kind) is list else kind


def fields_along(model: object, path: Iterable[str | int]) -> list[FieldInfo]:
    """Return the fields of the sections that lead to a key, then the field of the key itself.

    The list is shorter than `path`, the key split at its dots, if the path leads into a list or a
    mapping, or the key does not exist.
    """
    fields = []
    for name in path:
        if not is_section(model) or name not in model.model_fields:
            break
        fields.append(model.model_fields[name])
        model = bare_type(fields[-1].annotation)
    return fields


def unit_of(model: type[Section], key: str) -> str:
    """Return the declared unit of a dotted key of a model; "" if it has none, or does not exist."""
    path = key.split(".")
    fields = fields_along(model, path)
    return str(read_facts(fields[-1])["unit"]) if len(fields) == len(path) else ""


def is_section(kind: object) -> TypeGuard[type[Section]]:
    """Return whether a type is a subclass of `Section`."""
    return isinstance(kind, type) and issubclass(kind, Section)
