"""What is done to a servo once: each step refuses what cannot be undone, and is verified."""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from bentod.errors import BusError, Refused
from drivers.dynamixel.codec import Version
from drivers.dynamixel.provision.rates import same_rate, to_register, usual
from drivers.dynamixel.provision.sdk import PROTOCOLS, Line
from drivers.dynamixel.registers import Register
from drivers.dynamixel.tables import KNOWN_NUMBERS, MODELS, NAMES, ServoModel

ATTEMPTS = 3

ROUNDS = 2
"""How often a servo that was reset is looked for everywhere; it writes its whole EEPROM meanwhile."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a servo was found."""

    id: int
    number: int  # in its Model Number register
    protocol: Version
    baud: int  # bit/s

    @property
    def name(self) -> str:
        """What it is, for a sentence."""
        return KNOWN_NUMBERS.get(self.number, f"a servo with the model number {self.number}")

    @property
    def model(self) -> ServoModel:
        """Its tables. Raises Refused: they are not known."""
        if self.number not in NAMES:
            raise Refused(f"Servo {self.id} is {self.name}, which is not known; use the servo maker's tool.")
        return MODELS[NAMES[self.number]]

    def __str__(self) -> str:
        return f"servo {self.id} ({self.name}) at {self.baud} bit/s, protocol {self.protocol}.0"


def scan(port: str, bauds: Sequence[int], ids: Sequence[int], say: Callable[[str], None]) -> Iterator[Place]:
    """Everybody who answers a ping.

    Raises:
        BusError: the port cannot be opened.
    """
    for baud, protocol in itertools.product(bauds, PROTOCOLS):
        say(f"{baud} bit/s, protocol {protocol}.0: asking {len(ids)} IDs")
        with Line(port, baud, protocol) as line:
            numbers = {id_: line.ping(id_, hasty=True) for id_ in ids}
            if any(numbers.values()):  # where somebody is, a busy computer may have missed others
                numbers |= {id_: line.ping(id_, hasty=True) for id_, number in numbers.items() if not number}
            yield from (Place(id_, n, protocol, baud) for id_, n in numbers.items() if n is not None)


def find(port: str, id_: int, bauds: Sequence[int]) -> Place:
    """The servo of that ID.

    Raises:
        BusError: it does not answer.
        Refused: several do, at different rates or in both protocols.
    """
    found = [place for baud in bauds for protocol in PROTOCOLS if (place := _look(port, baud, protocol, id_))]
    if not found:
        rates = ", ".join(map(str, bauds))
        raise BusError(
            f"Servo {id_} does not answer at {rates} bit/s; check its power, its cable and its ID."
        )
    if len(found) > 1:
        raise Refused(
            f"There is more than one: {'; '.join(map(str, found))}. Choose with --baud, or unplug some."
        )
    return found[0]


def set_id(port: str, place: Place, new: int) -> Place:
    """Give a servo another ID.

    Raises:
        Refused: the ID is taken, or the servo's torque is on.
        BusError: it did not take it.
    """
    with Line(port, place.baud, place.protocol) as line:
        if line.ping(new) is not None:
            raise Refused(f"ID {new} is taken: two servos with one ID cannot be told apart any more.")
        _check_limp(line, place)
        _write(line, place, place.model.table["ID"], new)
    return _verified(port, Place(new, place.number, place.protocol, place.baud), place)


def set_baud(port: str, place: Place, baud: int) -> Place:
    """Give a servo another rate.

    Raises:
        Refused: it has no such rate, another servo with its ID is at that rate, or its torque is on.
        BusError: it did not take it.
    """
    value, baud = to_register(place.model, baud), usual(baud)
    if same_rate(baud, place.baud):
        return place
    with Line(port, baud, place.protocol) as line:
        if line.ping(place.id) is not None:
            raise Refused(f"At {baud} bit/s there is a servo {place.id} already.")
    with Line(port, place.baud, place.protocol) as line:
        _check_limp(line, place)
        _write(line, place, place.model.table["Baud Rate"], value)
    return _verified(port, Place(place.id, place.number, place.protocol, baud), place)


def set_protocol(port: str, place: Place, protocol: Version) -> Place:
    """Have a servo with firmware for both protocols speak the other one.

    Raises:
        Refused: its firmware has one protocol only, or its torque is on.
        BusError: it did not take it.
    """
    register = place.model.table.get("Protocol Version")
    if register is None:
        raise Refused(
            f"Servo {place.id} is {place.name} and speaks protocol {place.protocol}.0 only; MX servos get "
            "firmware for protocol 2.0 by the servo maker's tool."
        )
    if place.protocol == protocol:
        return place
    with Line(port, place.baud, protocol) as line:
        if line.ping(place.id) is not None:
            raise Refused(f"There is a servo {place.id} in protocol {protocol}.0 already.")
    with Line(port, place.baud, place.protocol) as line:
        _check_limp(line, place)
        _write(line, place, register, protocol)
    return _verified(port, Place(place.id, place.number, protocol, place.baud), place)


def factory_reset(port: str, place: Place, scope: int, bauds: Sequence[int]) -> list[Place]:
    """Reset one servo; returns where it may be now: everybody with ID 1 or its own at any of `bauds`.

    Raises:
        Refused: its torque is on.
        BusError: nobody of its kind answers any more.
    """
    with Line(port, place.baud, place.protocol) as line:
        _check_limp(line, place)
        line.factory_reset(place.id, scope)
    for _ in range(ROUNDS):
        places = ((baud, protocol, id_) for baud in bauds for protocol in PROTOCOLS for id_ in {1, place.id})
        tried = [_look(port, *where) for where in places]
        if found := [at for at in tried if at is not None and at.number == place.number]:
            return found
    raise BusError(f"Servo {place.id} was reset and does not answer; power it off and on, and scan.")


def _look(port: str, baud: int, protocol: Version, id_: int) -> Place | None:
    with Line(port, baud, protocol) as line:
        numbers = (line.ping(id_) for _ in range(ATTEMPTS))
        number = next((number for number in numbers if number is not None), None)
    return None if number is None else Place(id_, number, protocol, baud)


def _check_limp(line: Line, place: Place) -> None:
    """Settings that survive power-off cannot be written while torque is on."""
    register = place.model.table["Torque Enable"]
    if line.read(place.id, register.address, register.size):
        raise Refused(f"Servo {place.id} has its torque on; make it limp first (`bentod ctl torque off`).")


def _write(line: Line, place: Place, register: Register, value: int) -> None:
    line.write(place.id, register.address, register.size, value)


def _verified(port: str, now: Place, before: Place) -> Place:
    found = _look(port, now.baud, now.protocol, now.id)
    if found is None or found.number != before.number:
        raise BusError(f"It was to be {now}, and does not answer there; it was {before}. Scan for it.")
    return found
