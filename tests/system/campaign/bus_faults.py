"""Faults of the cable, the line and the servos."""

from drivers.dynamixel.deadman import SETTLING
from tests.system.campaign.case import Breaks, Case, Mends
from tests.system.campaign.outcome import ANSWER, DEAD_MAN, DEAD_TIME, LEASE, RESTING, ROUND, TICK, Bound
from tests.system.campaign.rig import ARMED, BY_ITSELF, RELEASED, Rig

FAULT_AFTER = 0.5
"""s of silence (`safety.fault_after_s`)."""

AHEAD = DEAD_MAN - SETTLING + DEAD_TIME
"""s at full speed until a goal that nobody renews is reached (`drivers.dynamixel.deadman`)."""

DEAF = Bound(DEAD_MAN + DEAD_TIME, "dead-man 300 + dead time 19", runs=AHEAD)

LADDER = Bound(FAULT_AFTER + ANSWER, "fault after 500 + answer 320")

LIMP = Bound(DEAD_TIME + RESTING, "coasts 269", runs=DEAD_TIME)

HEARD = TICK + LEASE
"""s from a client's last word until its lease has run out, which counts from the tick that hears of it."""

LET_GO = Bound(HEARD + ANSWER, "tick 33 + lease 200 + answer 320")

MUTE = Bound(1.5 * TICK + ANSWER, "silence 50 + answer 320")

# A tick more, because what is known of a joint may be a round old.
NOISY = Bound(
    HEARD + ROUND + TICK + DEAD_MAN + DEAD_TIME,
    "tick 33 + lease 200 + old reading 50 + dead-man 319",
    runs=HEARD + ROUND + TICK + AHEAD,
)

SLOW_ADAPTER = (
    (
        'name = "sim-dynamixel"',
        'name = "sim-dynamixel"\nusb_latency_s = 0.016\nreply_margin_s = 0.02\n'
        "gravity_nm = { elbow_flexion = 0.0, wrist_flexion = 0.0 }",  # arming takes long, and they would fall
    ),
)

PROTOCOL_2 = tuple(
    (f'{{ id = {servo}, model = "{model}" }}', f'{{ id = {servo}, model = "{model}(2.0)" }}')
    for servo, model in enumerate(("MX-64", "MX-106", "MX-28", "MX-28", "MX-28"), 1)
)


def inject(fault: str, joint: int | None = None) -> tuple[Breaks, Mends]:
    """Beginning and end of a fault of the simulated arm."""

    async def begin(rig: Rig) -> None:
        rig.arm.inject(fault, joint, True)

    async def end(rig: Rig) -> None:
        rig.arm.inject(fault, joint, False)

    return begin, end


def noise(share: float) -> tuple[Breaks, Mends]:
    """Of the packets on the line this share is spoilt, half of them lost and half of them broken."""

    async def begin(rig: Rig) -> None:
        rig.arm.noise = share / 2

    async def end(rig: Rig) -> None:
        rig.arm.noise = 0.0

    return begin, end


async def slow_adapter(rig: Rig) -> None:
    """16 ms with the millisecond that it takes anyway."""
    rig.arm.latency = 0.015


async def quick_adapter(rig: Rig) -> None:
    rig.arm.latency = 0.0


async def as_ever(rig: Rig) -> None:
    """What is wrong has been so from the start."""


SILENT = inject("silent", 0)

CASES = (
    Case("cable pulled", DEAF, *inject("cable"), "no answer", (RELEASED,)),
    Case(
        "supply off: joints without load",
        LIMP,
        *inject("power"),
        "no answer|torque",
        (ARMED,),
        judged=(0, 2, 4),
    ),
    Case("one servo silent: itself", DEAF, *SILENT, "no answer", (RELEASED,), judged=(0,)),
    Case("one servo silent: others", LADDER, *SILENT, "no answer", (RELEASED,), judged=(1, 2, 3, 4)),
    Case("servo reboots, protocol 1", LADDER, *inject("reboot", 0), "lost torque|no answer", (ARMED,)),
    Case(
        "servo reboots, protocol 2",
        LADDER,
        *inject("reboot", 0),
        "lost torque|no answer",
        (ARMED,),
        changes=PROTOCOL_2,
    ),
    Case("servo shuts down", LADDER, *inject("overload", 0), "shut down", (ARMED,)),
    Case("noise: 1 % of packets", NOISY, *noise(0.01), lasts=3.0),
    Case("noise: 10 % of packets", NOISY, *noise(0.1), lasts=3.0),
    Case("noise: 20 % of packets", NOISY, *noise(0.2), "", (BY_ITSELF, RELEASED), lasts=3.0, falters=True),
    Case("5 % of encoder readings wrong", NOISY, *inject("encoder_glitch", 0), lasts=3.0),
    Case("USB adapter turns 16 ms late", MUTE, slow_adapter, quick_adapter, "no answer", (RELEASED,)),
    Case("USB adapter 16 ms late, `reply_margin_s` 0.02", LET_GO, as_ever, lasts=1.0, changes=SLOW_ADAPTER),
)
