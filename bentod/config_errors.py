"""Mistakes in a config, said so that they can be mended: key, value, bound, and the nearest known key."""

import typing
from collections.abc import Iterator

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from bentod.errors import nearest


def explain(error: ValidationError, model: type[BaseModel], where: tuple[str | int, ...] = ()) -> list[str]:
    """One line for each mistake; `where` is the place of `model`'s table in the file."""
    return [line for detail in error.errors() for line in _lines(detail, model, where)]


def _lines(detail: ErrorDetails, model: type[BaseModel], where: tuple[str | int, ...]) -> Iterator[str]:
    place = ".".join(str(part) for part in (*where, *detail["loc"]))
    if detail["type"] == "extra_forbidden":
        known = _keys_at(model, detail["loc"][:-1])
        yield f"{place}: unknown key{nearest(str(detail['loc'][-1]), known)}"
    elif detail["type"] == "value_error":
        for line in detail["msg"].removeprefix("Value error, ").splitlines():
            yield f"{place}: {line}" if place else line
    elif detail["type"] == "missing":
        yield f"{place}: is missing"
    else:
        yield f"{place} = {detail['input']!r}: {_lower_first(detail['msg'])}"


def _lower_first(text: str) -> str:
    return text[:1].lower() + text[1:]


def _keys_at(model: type[BaseModel], loc: tuple[str | int, ...]) -> set[str]:
    """Keys of the table that `loc` leads to from `model`."""
    models = [model]
    for part in loc:
        if isinstance(part, str):
            models = [m for found in models for m in _models_of(found, part)] or models
    return {key for found in models for key in found.model_fields}


def _models_of(model: type[BaseModel], key: str) -> list[type[BaseModel]]:
    field = model.model_fields.get(key)
    return list(_models_in(field.annotation)) if field else []


def _models_in(annotation: object) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in typing.get_args(annotation):
        yield from _models_in(argument)
