"""Joint groups: lists of joints of which one is active, as toggling control needs them (thesis A.1.1)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bentod.contracts_assist import TOGETHER
from bentod.errors import BadRequest
from bentod.frames import Command, JointSpec, Value, Velocity, Wishes


@dataclass(slots=True)
class Group:
    """One group: joints by index, and which of them is active, or whether all are selected at once."""

    name: str
    joints: tuple[int, ...]
    position: int = 0  # of the active joint in `joints`
    together: bool = False  # then the active joint is the one to fall back to

    @property
    def active(self) -> int:
        """Index of the active joint among all joints."""
        return self.joints[self.position]

    def toggle(self, steps: int, order: Sequence[int] | None = None, offered: bool = False) -> None:
        """Select what is `steps` further down the list; the list is a ring.

        `order`: joints, and perhaps `TOGETHER`, in the order in which they are selected, None: as they are
        in the group. `offered`: whether all joints at once are one more entry (thesis 6.4, Fig. 6.2).
        """
        ring = self._ring(self.joints if order is None else order, offered or self.together)
        place = ring.index(TOGETHER if self.together else self.active)
        entry = ring[(place + steps) % len(ring)]
        self.together = entry == TOGETHER
        if not self.together:
            self.position = self.joints.index(entry)

    def _ring(self, order: Sequence[int], offered: bool) -> list[int]:
        """Every joint once, those that `order` leaves out last; the extra entry only if it is offered."""
        entries = [TOGETHER, *self.joints]
        ring = [entry for entry in dict.fromkeys((*order, *self.joints, TOGETHER)) if entry in entries]
        return [entry for entry in ring if offered or entry != TOGETHER]


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
        group.together = False
        return group

    def describe(self) -> Value:
        """The groups as clients see them."""
        return [
            {
                "name": group.name,
                "joints": [self._specs[joint].name for joint in group.joints],
                "active": self._specs[group.active].name,
                "together": group.together,
            }
            for group in self
        ]

    def wishes(
        self, efforts: Mapping[str, float], moves: Mapping[str, Mapping[str, float]] | None = None
    ) -> Wishes:
        """What efforts (-1..1, by group) ask of the joints.

        `moves`: of groups whose joints move together rather than the active one, the share (-1..1) of its
        top speed that effort 1 asks of each joint.
        """
        asked: dict[int, Command] = {}
        for name, effort in efforts.items():
            together = (moves or {}).get(name)
            asked |= self.wish(name, effort) if together is None else self._synergy(name, together, effort)
        return asked

    def _synergy(self, name: str, moves: Mapping[str, float], effort: float) -> dict[int, Command]:
        shares = {joint: max(-1.0, min(1.0, effort * moves.get(self._specs[joint].name, 0.0)))
                  for joint in self.group(name).joints}  # fmt: skip
        return {j: Velocity(share * self._specs[j].max_velocity) for j, share in shares.items() if share}

    def wish(self, name: str, effort: float) -> Wishes:
        """What an effort (-1..1) asks of the group: the active joint at that share of its top speed (rad/s).

        No effort asks nothing, and nor does any while all joints are selected: they are then moved by the
        group's assist. Efforts beyond ±1 are cut.
        """
        group = self.group(name)
        joint = group.active
        share = 0.0 if group.together else max(-1.0, min(1.0, effort))
        return {joint: Velocity(share * self._specs[joint].max_velocity)} if share else {}
