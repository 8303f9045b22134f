"""Who is at the other end of a connection, and what that allows."""

from dataclasses import dataclass
from enum import StrEnum


class Role(StrEnum):
    """What a client may do; each role may do what the ones before it may."""

    OBSERVER = "observer"  # looks, and may ask the arm to stop
    OPERATOR = "operator"  # moves the arm and changes how it moves

    def may(self, needed: "Role") -> bool:
        """Whether this role allows what takes the role `needed`."""
        return self is Role.OPERATOR or needed is Role.OBSERVER


@dataclass(frozen=True, slots=True)
class Peer:
    """Who connected, found out once, when it did."""

    name: str  # of the connection, until the client gives a better one
    user: str  # whom its connections are counted for: "uid 1000", or an address
    role: Role
    remedy: str = ""  # what to do to become an operator, as a sentence
    master: bool = False  # it may end the daemon anyway, so the number of its connections is not bounded
