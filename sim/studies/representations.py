"""What predictions may be made from besides the thesis' angles and traces: velocity, attention, intent."""

from collections.abc import Sequence

from bentod.config_learn import RepresentationTable, Tiles

AHEAD = 0.2
"""Share of its range that a joint at full effort looks ahead: half a second in the maze."""


def seeing(name: str, joints: Sequence[str], group: str, speed: float, top: float) -> RepresentationTable:
    """One of `SEEING` for `joints` of `group`, that go at `speed` when they are moved, and at `top` at most.

    Half of the tilings are over angles and how the arm moves now, half over angles and their traces as in
    thesis 5.3: the first generalise over rests, the second tell how long one lasts. Their tiles are as wide
    as the thesis' own, and some look at one input only, so that little experience is enough. Speeds in rad/s.
    """
    angles = [f"norm({joint}.position)" for joint in joints]
    traces = [f"trace({angle}, 0.99)" for angle in angles]
    velocities = [f"norm({joint}.velocity, {-1.5 * speed!r}, {1.5 * speed!r})" for joint in joints]
    active = [f"{group}.active.{joint}" for joint in joints[:-1]]
    share = 1.2 * speed / top
    effort = f"norm({group}.effort, {-share!r}, {share!r})"
    push = {joint: f"{group}.active.{joint} * {group}.effort * {AHEAD * top / speed!r}" for joint in joints}
    ahead = [f"clip(norm({joint}.position) + {push[joint]}, 0, 1)" for joint in joints]
    now, lasting = {
        "velocity": (velocities, []),
        "intent": ([*velocities, *active, effort], active),
        "look_ahead": ([*ahead, *velocities, *active], active),
    }[name]
    return RepresentationTable(
        name=name,
        tiles=(
            Tiles(inputs=(*angles, *now), combine="each", tilings=8, width=0.5),
            Tiles(inputs=(*angles, *now), tilings=50, memory=4096),
            Tiles(inputs=(*angles, *traces, *lasting), tilings=50, memory=4096),
        ),
    )


SEEING = ("velocity", "intent", "look_ahead")
"""Signed velocities; with them which joint is attended to and how it is pushed; or where that will lead."""
