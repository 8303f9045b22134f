"""In which order general value functions answer, when some are made from others' answers (thesis 4.2)."""

from collections import deque
from collections.abc import Collection, Mapping

from bentod.errors import ConfigError, nearest


def layers(needs: Mapping[str, Collection[str]]) -> list[tuple[str, ...]]:
    """Names in layers: each needs only what earlier layers have; within a layer in the order of `needs`.

    Raises:
        ConfigError: a name is needed that is not there, or names need one another in a circle.
    """
    depth = dict.fromkeys(needs, 0)
    waiting = {name: len(set(needed)) for name, needed in needs.items()}
    ready = deque(name for name, left in waiting.items() if not left)
    users = _users(needs)
    done = 0
    while ready:
        name = ready.popleft()
        done += 1
        for user in users[name]:
            depth[user] = max(depth[user], depth[name] + 1)
            waiting[user] -= 1
            if not waiting[user]:
                ready.append(user)
    if done < len(needs):
        raise ConfigError(f"questions are made from one another in a circle: {_circle(needs, waiting)}")
    found: list[list[str]] = [[] for _ in range(1 + max(depth.values(), default=-1))]
    for name, level in depth.items():
        found[level].append(name)
    return [tuple(names) for names in found]


def _users(needs: Mapping[str, Collection[str]]) -> dict[str, list[str]]:
    """Who needs each name."""
    users: dict[str, list[str]] = {name: [] for name in needs}
    for name, needed in needs.items():
        for other in sorted(set(needed)):
            if other not in users:
                raise ConfigError(
                    f"'{name}' is made from '{other}', which nobody answers{nearest(other, needs)}"
                )
            users[other].append(name)
    return users


def _circle(needs: Mapping[str, Collection[str]], waiting: Mapping[str, int]) -> str:
    """The first circle among those that still wait; each needs the next."""
    path: list[str] = []
    name = next(name for name, left in waiting.items() if left)
    while name not in path:
        path.append(name)
        name = next(other for other in sorted(needs[name]) if waiting[other])
    return " -> ".join([*path[path.index(name) :], name])
