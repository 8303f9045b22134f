"""Baud rates as a servo's Baud Rate register has them."""

from bentod.errors import Refused
from drivers.dynamixel.tables import ServoModel

FAST = {2_250_000: 250, 2_500_000: 251, 3_000_000: 252}
"""https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#baud-rate; other values v: 2,000,000 / (v + 1) bit/s."""

FIRMWARE_2 = (9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000)
"""https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#baud-rate"""

PORTS = (9_600, 19_200, 57_600, 115_200, 1_000_000, 2_000_000, 2_500_000, 3_000_000, 4_000_000)
"""bit/s that every adapter and operating system has."""

TOLERANCE = 0.03
"""Share by which two rates may differ and still understand each other; the manual says 3 %."""


def to_register(model: ServoModel, baud: int) -> int:
    """The register's value for a rate (bit/s).

    Raises:
        Refused: the servo has none that is near enough.
    """
    rates = _rates(model)
    nearest = min(rates, key=lambda rate: abs(rate - baud))
    if not same_rate(nearest, baud):
        raise Refused(f"There is no rate of {baud} bit/s; the nearest is {nearest}.")
    return rates[nearest]


def same_rate(one: int, other: int) -> bool:
    """Whether two rates (bit/s) are near enough."""
    return abs(one / other - 1) <= TOLERANCE


def usual(baud: int) -> int:
    """The rate (bit/s) that ports are made for, if there is one near enough: 57 600 for 57 142."""
    return next((rate for rate in PORTS if same_rate(rate, baud)), baud)


def _rates(model: ServoModel) -> dict[int, int]:
    """Register values by bit/s."""
    if model.layout.protocol == 2:
        return {rate: value for value, rate in enumerate(FIRMWARE_2)}
    slow = {2_000_000 // (value + 1): value for value in range(249, 0, -1)}
    return slow | (FAST if model.grouped else {})
