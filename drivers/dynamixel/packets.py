"""What both protocols share: whom a packet is for, and what a servo replies."""

from dataclasses import dataclass

BROADCAST = 0xFE
"""Reaches every servo, and nobody replies to it."""


@dataclass(frozen=True, slots=True)
class Status:
    """A status packet; its error byte is data, not a failure of the reading."""

    id: int
    error: (
        int  # protocol 1.0: bits as in `firmware1.ERRORS`; 2.0: a number as in `firmware2.RESULTS`, and ALERT
    )
    parameters: bytes


def check_id(id_: int) -> None:
    """Raise ValueError unless `id_` is a servo's or everybody's."""
    if not 0 <= id_ <= BROADCAST:
        raise ValueError(f"An id is 0 to {BROADCAST}, not {id_}.")
