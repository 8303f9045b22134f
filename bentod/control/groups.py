"""Joint groups: lists of joints of which one is active, as toggling control needs them (thesis A.1.1)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bentod.errors import BadRequest
from bentod.frames import JointSpec, Value, Velocity, Wishes


@dataclass(slots=True)
class Group:
    """One group: joints by index, and which of them is active."""

    name: str
    joints: tuple[int, ...]
    position: int = 0  # of the active joint in `joints`

    @property
    def active(self) -> int:
        """Index of the active joint among all joints."""
        return self.joints[self.position]

    def toggle(self, steps: int) -> None:
        """Make the joint `steps` further down the list active; the list is a ring."""
        self.position = (self.position + steps) % len(self.joints)


class Groups:
    """All groups of the arm."""

    def __init__(self, specs: Sequence[JointSpec], groups: Mapping[str, Sequence[str]]) -> None:
        self._specs = tuple(specs)
        indices = {spec.name: index for index, spec in enumerate(specs)}
        self._groups = {n: Group(n, tuple(indices[joint] for joint in js)) for n, js in groups.items()}

    def __iter__(self) -> Iterator[Group]:
        return iter(self._groups.values())

    def group(self, name: str) -> Group:
        """The group `name`. Raises BadRequest: there is none."""
        if name not in self._groups:
            raise BadRequest(f"there is no group '{name}' (groups: {', '.join(self._groups)})", "group")
        return self._groups[name]

    def activate(self, name: str, joint: str) -> Group:
        """Make `joint` the active one. Raises BadRequest: the group or the joint in it does not exist."""
        group = self.group(name)
        names = [self._specs[index].name for index in group.joints]
        if joint not in names:
            raise BadRequest(f"the group '{name}' has no joint '{joint}' ({', '.join(names)})", "joint")
        group.position = names.index(joint)
        return group

    def describe(self) -> Value:
        """The groups as clients see them."""
        return [
            {
                "name": group.name,
                "joints": [self._specs[joint].name for joint in group.joints],
                "active": self._specs[group.active].name,
            }
            for group in self
        ]

    def wishes(self, efforts: Mapping[str, float]) -> Wishes:
        """What efforts (-1..1, by group) ask of the joints."""
        return {j: wish for name, effort in efforts.items() for j, wish in self.wish(name, effort).items()}

    def wish(self, name: str, effort: float) -> Wishes:
        """What an effort (-1..1) asks of the group: the active joint at that share of its top speed (rad/s).

        No effort asks nothing. Efforts beyond ±1 are cut.
        """
        joint = self.group(name).active
        share = max(-1.0, min(1.0, effort))
        return {joint: Velocity(share * self._specs[joint].max_velocity)} if share else {}
