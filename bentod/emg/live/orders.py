"""What the loop leaves to another process, as plain data that both understand."""

import json
from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from bentod.config_base import Table
from bentod.config_conditioning import Filter
from bentod.config_recognition import Recognition


class Keep(Table):
    """Align the labels of a session that was collected, and add it to what is trained on."""

    do: Literal["keep"] = "keep"
    session: str  # file with the raw session
    data: str  # file of what is trained on
    filters: tuple[Filter, ...]
    add: bool  # to what is there; else begin anew
    condition: str


class Learn(Table):
    """Train a model on what was collected, and write its file."""

    do: Literal["train"] = "train"
    data: str
    out: str
    table: Recognition  # features, classifier, windows
    filters: tuple[Filter, ...]


Order = Keep | Learn

ORDER: TypeAdapter[Order] = TypeAdapter(Annotated[Keep | Learn, Field(discriminator="do")])


def written(order: Order) -> bytes:
    """An order as JSON."""
    # A filter refuses keys of other kinds of filter even at their defaults, so these are left out.
    told = order.model_dump(mode="json", exclude_defaults=True)
    return json.dumps({"do": order.do, **told}).encode()
