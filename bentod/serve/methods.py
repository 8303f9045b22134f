"""The table of methods that the arm offers, by the role that each needs, in the order of the reference."""

from collections.abc import Mapping
from functools import cache

from bentod.messages import Packed, pack
from bentod.serve.arm_methods import ArmMethods
from bentod.serve.room import Room
from bentod.serve.session import Session
from bentod.serve.spec import Handler, Method, table
from bentod.serve.tuning_methods import TuningMethods


def arm_methods(room: Room) -> dict[str, Method]:
    """Every method, by name. What an observer may call moves nothing; `stop` only ends motion."""
    arm = ArmMethods(room)
    tuning = TuningMethods(room)
    methods: dict[str, Method] = {}
    methods |= table(
        observer=(
            _lister(methods),
            arm.challenge,
            arm.authenticate,
            arm.hello,
            arm.list_clients,
            arm.get_info,
            arm.get_state,
            arm.subscribe,
            arm.unsubscribe,
            arm.stop,
            tuning.group_list,
            tuning.emg_get,
            tuning.assist_get,
        ),
        operator=(
            arm.pause,
            arm.torque,
            arm.clear_fault,
            arm.go_home,
            arm.move,
            tuning.group_command,
            tuning.group_toggle,
            tuning.group_activate,
            tuning.emg_set,
            tuning.emg_pause,
            tuning.assist_set,
            tuning.set_meta,
            tuning.inject,
        ),
    )
    return methods


def _lister(methods: Mapping[str, Method]) -> Handler:
    described = cache(lambda: Packed(pack([method.describe() for method in methods.values()])))

    async def list_methods(session: Session) -> Packed:
        """Describe every method: name, what it does, parameters with type, unit and bounds."""
        return described()

    return list_methods
