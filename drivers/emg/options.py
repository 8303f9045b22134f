"""A source's own table of options: checked at opening, every error at once, each a sentence."""

from collections.abc import Mapping
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from bentod.errors import ConfigError, nearest
from bentod.frames import Value


class Table(BaseModel):
    """Base of every source's options: no unknown key, no infinite number, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


Checked = TypeVar("Checked", bound=Table)


def parse(model: type[Checked], table: Mapping[str, Value]) -> Checked:
    """`table` as a checked `model`.

    Raises:
        ConfigError: unknown keys, with the nearest known one, and values out of bounds.
    """
    try:
        return model.model_validate(dict(table))
    except ValidationError as error:
        details = error.errors()
        text = " ".join(_sentence(detail, list(model.model_fields)) for detail in details)
        raise ConfigError(text, _key(details[0])) from None


def _key(detail: ErrorDetails) -> str:
    return ".".join(str(part) for part in detail["loc"]) or "emg"


def _sentence(detail: ErrorDetails, known: list[str]) -> str:
    key = _key(detail)
    if detail["type"] == "missing":
        return f"The EMG option {key!r} is required."
    if detail["type"] != "extra_forbidden":
        return f"The EMG option {key!r} is {detail['input']!r}: {detail['msg']}."
    return f"The EMG option {key!r} is unknown{nearest(key, known)}"
