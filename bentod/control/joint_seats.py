"""Who drives joints by name rather than through a group, by the same rules."""

from collections.abc import Collection, Mapping, Sequence

from bentod.control.operators import Asked, Operators
from bentod.frames import JointSpec, Velocity, Wishes


class JointSeats:
    """One operator a joint; a joint that a client or the driver of a group moves is taken."""

    def __init__(self, specs: Sequence[JointSpec], operators: Collection[str]) -> None:
        self._specs = tuple(specs)
        self._seats = Operators([spec.name for spec in specs], operators)

    def decide(self, asked: Mapping[str, Asked], taken: Collection[int], now: float) -> dict[str, Wishes]:
        """What each operator may have of efforts that are given by joint; `taken`: joints others move."""
        names = [self._specs[joint].name for joint in taken]
        granted = self._seats.decide(asked, names, now)
        return {name: self._wishes(one.efforts) for name, one in granted.items()}

    def suspend(self, joints: Collection[int]) -> None:
        """All operators must be seen at rest before they drive these joints."""
        for joint in joints:
            self._seats.suspend(self._specs[joint].name)

    def driven(self, joints: Collection[int]) -> bool:
        """Whether any of these joints is driven by name."""
        return any(self._seats.driver(self._specs[joint].name) for joint in joints)

    def _wishes(self, efforts: Mapping[str, float]) -> Wishes:
        return {
            joint: Velocity(efforts[spec.name] * spec.max_velocity)
            for joint, spec in enumerate(self._specs)
            if efforts.get(spec.name)
        }
