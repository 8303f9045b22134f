"""How a terminal tells the wearer what to do while their muscles are measured."""

from collections.abc import Callable

from bentod.calibration.measuring import Arm, Plan, Step
from bentod.calibration.measuring import measure as measured
from bentod.calibration.muscles import Setting

Told = Callable[[str], None]


async def measure(arm: Arm, plan: Plan, told: Told) -> list[Setting]:
    """What each site should be set to, as in `bentod.calibration.measuring`; `told` gets sentences."""

    def asked(step: Step) -> None:
        told(step.text)

    found = await measured(arm, plan, asked)
    told("Thank you: relax.")
    return found
