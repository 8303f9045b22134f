"""The table of methods that the arm offers, by the role that each needs, in the order of the reference."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

from bentod.errors import BentodError
from bentod.frames import Value
from bentod.messages import Packed, pack
from bentod.serve.arm_methods import ArmMethods
from bentod.serve.emg_methods import EmgMethods
from bentod.serve.joystick_methods import JoystickMethods
from bentod.serve.learning_methods import LearningMethods
from bentod.serve.peers import Role
from bentod.serve.room import Room
from bentod.serve.session import Session
from bentod.serve.session_methods import SessionMethods
from bentod.serve.spec import Handler, Method, table
from bentod.serve.tuning_methods import TuningMethods


def arm_methods(room: Room) -> dict[str, Method]:
    """Every method, by name. What an observer may call moves nothing; `stop` only ends motion."""
    arm, tuning, sitting = ArmMethods(room), TuningMethods(room), SessionMethods(room)
    learning, emg = LearningMethods(room), EmgMethods(room)
    methods: dict[str, Method] = {}
    looked_up = (learning.gvf_list, emg.emg_classes, JoystickMethods(room).joystick_get)
    looking = (lister(methods), *_looking(arm, tuning, sitting), *looked_up)
    moving = (*_moving(arm, tuning, sitting), *_teaching(learning), *_recognising(emg))
    methods |= table(observer=looking, operator=moving)
    return {name: _told(entry, room) for name, entry in methods.items()}


def lister(methods: Mapping[str, Method]) -> Handler:
    """The method that describes `methods` as they are when it is first called."""
    described = cache(lambda: Packed(pack([method.describe() for method in methods.values()])))

    async def list_methods(session: Session) -> Packed:
        """Describe every method: name, what it does, parameters with type, unit and bounds."""
        return described()

    return list_methods


def _looking(arm: ArmMethods, tuning: TuningMethods, sitting: SessionMethods) -> tuple[Handler, ...]:
    return (
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
        tuning.emg_levels,
        tuning.assist_get,
        sitting.get_recording,
    )


def _moving(arm: ArmMethods, tuning: TuningMethods, sitting: SessionMethods) -> tuple[Handler, ...]:
    return (
        arm.pause,
        arm.torque,
        arm.clear_fault,
        arm.go_home,
        arm.go_home_cancel,
        arm.move,
        tuning.group_command,
        tuning.group_toggle,
        tuning.group_activate,
        tuning.emg_set,
        tuning.emg_pause,
        tuning.assist_set,
        tuning.reward,
        sitting.set_meta,
        sitting.trial_start,
        sitting.trial_mark,
        sitting.trial_stop,
        sitting.mark,
        sitting.recording_start,
        sitting.recording_stop,
        tuning.inject,
    )


def _teaching(learning: LearningMethods) -> tuple[Handler, ...]:
    return (learning.gvf_add, learning.gvf_remove, learning.gvf_reset)


def _recognising(emg: EmgMethods) -> tuple[Handler, ...]:
    return (
        *(emg.emg_collect, emg.emg_train, emg.emg_use),
        *(emg.emg_reset, emg.emg_retrain, emg.emg_prompt),
    )


def _told(method: Method, room: Room) -> Method:
    """The method, with the room told of each call that may move or stop the arm."""
    if method.role is Role.OBSERVER and method.name != "stop":
        return method
    handler = method.handler

    async def handle(session: Session, *values: Value) -> object:
        given: Value = dict(zip((param.name for param in method.params), values, strict=True))
        try:
            result = await handler(session, *values)
        except BentodError as error:
            room.commanded(session.client, method.name, given, str(error))
            raise
        room.commanded(session.client, method.name, given, "")
        return result

    return replace(method, handler=handle)
