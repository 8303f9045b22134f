"""The table of methods that the arm offers, in the order of the reference."""

from bentod.frames import Value
from bentod.serve.arm_methods import ArmMethods
from bentod.serve.room import Room
from bentod.serve.session import Session
from bentod.serve.spec import Method, table
from bentod.serve.tuning_methods import TuningMethods


def arm_methods(room: Room) -> dict[str, Method]:
    """Every method, by name."""
    arm = ArmMethods(room)
    tuning = TuningMethods(room)

    async def list_methods(session: Session) -> Value:
        """Describe every method: name, what it does, parameters with type, unit and bounds."""
        return [method.describe() for method in methods.values()]

    methods = table(
        (
            list_methods,
            arm.hello,
            arm.get_info,
            arm.get_state,
            arm.subscribe,
            arm.unsubscribe,
            arm.stop,
            arm.pause,
            arm.torque,
            arm.clear_fault,
            arm.go_home,
            arm.move,
            tuning.group_list,
            tuning.group_command,
            tuning.group_toggle,
            tuning.group_activate,
            tuning.emg_get,
            tuning.emg_set,
            tuning.emg_pause,
            tuning.assist_get,
            tuning.assist_set,
            tuning.set_meta,
            tuning.inject,
        )
    )
    return methods
