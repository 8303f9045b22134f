"""Names in the config to factories, by string: so bentod never imports the devices that it drives."""

import importlib
import importlib.metadata
import importlib.util
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from pydantic import BaseModel

from bentod.contracts import OpenAudio, OpenEmg, OpenJoints, OpenJoystick, OpenLearner
from bentod.contracts_assist import OpenAssist
from bentod.errors import ConfigError, nearest


@dataclass(frozen=True, slots=True)
class Driver:
    """Where a driver of joints keeps its factory and the models of its tables."""

    open: str  # OpenJoints
    options: str  # model of [driver]
    hardware: str  # model of a joint's `hardware`


@dataclass(frozen=True, slots=True)
class Source:
    """Where a source of muscle signals, or a joystick, keeps its factory and the model of its table."""

    open: str  # OpenEmg, OpenJoystick
    options: str  # model of [emg.source], [joystick.source]


@dataclass(frozen=True, slots=True)
class ClassifierKind:
    """Where a classifier of muscle signals is trained, and where what was kept of it is had back."""

    train: str  # Train, of bentod.emg.recognition
    restore: str  # Restore, of bentod.emg.classify.kinds


JOINTS = {
    "dynamixel": Driver(
        "drivers.dynamixel.joints:open_joints",
        "drivers.dynamixel.options:Options",
        "drivers.dynamixel.options:Hardware",
    ),
    "sim-dynamixel": Driver(
        "sim.joints:open_joints", "sim.options:Options", "drivers.dynamixel.options:Hardware"
    ),
    "sim": Driver(
        "sim.joints:open_plain_joints", "sim.options:Options", "drivers.dynamixel.options:Hardware"
    ),
    "can": Driver(
        "drivers.can.bus:open_joints", "drivers.can.options:Options", "drivers.can.options:Hardware"
    ),
    "sim-can": Driver(
        "sim.can.joints:open_joints", "sim.can.options:Options", "drivers.can.options:Hardware"
    ),
}

EMG = {
    "synthetic": Source("sim.emg:open_emg", "sim.emg:Options"),
    "replay": Source("drivers.emg.replay:open_emg", "drivers.emg.replay:Options"),
    "lsl": Source("drivers.emg.lsl:open_emg", "drivers.emg.lsl:Options"),
    "serial": Source("drivers.emg.serial:open_emg", "drivers.emg.serial:Options"),
    "nidaqmx": Source("drivers.emg.nidaqmx_source:open_emg", "drivers.emg.nidaqmx_options:Options"),
    "brainflow": Source("drivers.emg.brainflow_source:open_emg", "drivers.emg.brainflow_options:Options"),
}

JOYSTICKS = {
    "linux": Source("drivers.joystick.linux:open_joystick", "drivers.joystick.options:LinuxOptions"),
    "sdl": Source("drivers.joystick.sdl:open_joystick", "drivers.joystick.options:SdlOptions"),
    "sim": Source("sim.joystick:open_joystick", "sim.joystick:Options"),
}

LEARNERS = {
    "td": "bentod.learn.algorithms.td:TD",
    "td_replacing": "bentod.learn.algorithms.td:ReplacingTD",
    "td_normalised": "bentod.learn.algorithms.td:NormalisedTD",
    "true_online": "bentod.learn.algorithms.true_online:TrueOnlineTD",
    "true_online_5": "bentod.learn.algorithms.true_online:TrueOnlineTD5",
    "gtd": "bentod.learn.algorithms.gtd:GTD",
    "tidbd": "bentod.learn.algorithms.tidbd:TIDBD",
    "autostep": "bentod.learn.algorithms.autostep:Autostep",
    "swifttd": "bentod.learn.algorithms.swifttd:SwiftTD",
}

ASSISTS = {
    "dpcc": "bentod.assist.thesis:open_assist",
    "effort": "bentod.assist.effort:open_assist",
    "dpcc_confident": "bentod.assist.confident:open_assist",
    "trajectory": "bentod.assist.trajectory:open_assist",
    "adaptive_switching": "bentod.assist.adaptive_switching:open_assist",
}

CLASSIFIERS = {
    "lda": ClassifierKind("bentod.emg.classify.lda:train", "bentod.emg.classify.linear:restore"),
    "lda_adaptive": ClassifierKind("bentod.emg.adapt.normal:train", "bentod.emg.adapt.normal:restore"),
    "lda_shrunk": ClassifierKind(
        "bentod.emg.classify.lda:train_shrunk", "bentod.emg.classify.linear:restore"
    ),
    "knn": ClassifierKind("bentod.emg.classify.nearest:train", "bentod.emg.classify.nearest:restore"),
    "random_forest": ClassifierKind(
        "bentod.emg.classify.random_forest:train", "bentod.emg.classify.forest:restore"
    ),
    "svm_linear": ClassifierKind(
        "bentod.emg.classify.svm:train_linear", "bentod.emg.classify.pairs:restore_linear"
    ),
    "svm_rbf": ClassifierKind(
        "bentod.emg.classify.svm:train_rbf", "bentod.emg.classify.pairs:restore_kernel"
    ),
}

PLAYER = "drivers.audio.player:open_player"
"""OpenAudio: what makes sound, where somebody is to hear it."""

ON_POLICY = frozenset({"true_online", "true_online_5", "tidbd", "autostep", "swifttd"})
"""Learners that do not heed ρ, so that a policy of one's own would mean nothing to them."""

COMMANDS = {
    "run": "bentod.cli.run:run",
    "check": "bentod.cli.check:check",
    "ctl": "bentod.cli.ctl:ctl",
    "watch": "bentod.cli.watch:watch",
    "dashboard": "bentod.cli.dashboard:dashboard",
    "doctor": "drivers.dynamixel.doctor.command:doctor",
    "servo": "drivers.dynamixel.provision.command:servo",
    "calibrate": "bentod.cli.calibrating:calibrate",
    "recording": "bentod.cli.recording:recording",
    "replay": "bentod.cli.replay:replay",
    "learn": "bentod.cli.learn:learn",
    "teach": "bentod.cli.teach:teach",
    "emg": "bentod.cli.emg:emg",
    "lsl": "bentod.cli.lsl:lsl",
    "voice": "bentod.cli.voice:voice",
    "bench": "bentod.cli.bench:bench",
    "study": "sim.studies.command:study",
    "sim-bus": "sim.bus_process:sim_bus",
    "sim-can": "sim.can.process:sim_can",
}

EXTRAS = {
    "aiohttp": "web",
    "pylsl": "lsl",
    "nidaqmx": "ni",
    "grpc": "ni",
    "brainflow": "brainflow",
    "pygame": "joy",
    "scipy": "emg",
    "sklearn": "emg",
    "threadpoolctl": "emg",
}
"""Which extra of bentod brings a library that it can do without."""

TARGETS = {
    **{f"joints.{name}.{field}": getattr(d, field) for name, d in JOINTS.items() for field in d.__slots__},
    **{f"emg.{name}.{field}": getattr(s, field) for name, s in EMG.items() for field in s.__slots__},
    **{f"joysticks.{n}.{field}": getattr(s, field) for n, s in JOYSTICKS.items() for field in s.__slots__},
    **{
        f"classifiers.{name}.{field}": getattr(c, field)
        for name, c in CLASSIFIERS.items()
        for field in c.__slots__
    },
    **{f"assists.{name}": target for name, target in ASSISTS.items()},
    **{f"learners.{name}": target for name, target in LEARNERS.items()},
    **{f"commands.{name}": target for name, target in COMMANDS.items()},
    "player": PLAYER,
}
"""Every "module:attribute" above, by what it is for."""


def resolve(target: str) -> object:
    """The object that "module:attribute" names.

    Raises:
        ConfigError: it cannot be imported, or a foreign package stands in the way of ours.
    """
    module_name, _, attribute = target.partition(":")
    _refuse_foreign(module_name.partition(".")[0])
    try:
        found: object = getattr(importlib.import_module(module_name), attribute)
    except (ImportError, AttributeError) as error:
        raise ConfigError(f"{target} cannot be loaded: {error}{_missing_extra(error)}") from error
    return found


def _missing_extra(error: Exception) -> str:
    """The end of a sentence about a library that is not installed."""
    extra = EXTRAS.get((getattr(error, "name", "") or "").partition(".")[0])
    return f"; pip install 'bentod[{extra}]' brings it" if extra and isinstance(error, ImportError) else ""


def missing_package(error: ConfigError) -> str:
    """The package for want of which `resolve` raised `error`; empty if that was not why, or it is ours."""
    cause = error.__cause__
    name = cause.name or "" if isinstance(cause, ModuleNotFoundError) else ""
    return "" if name.startswith("bentod") else name


def open_joints(name: str) -> OpenJoints:
    """The factory of the joints that `driver.name` chooses. Raises ConfigError: there is none."""
    return cast("OpenJoints", resolve(_driver(name).open))


def open_emg(name: str) -> OpenEmg:
    """The factory of the source that `emg.source.name` chooses. Raises ConfigError: there is none."""
    return cast("OpenEmg", resolve(_source(name).open))


def open_joystick(name: str) -> OpenJoystick:
    """The factory of the joystick that `joystick.source.name` chooses. Raises ConfigError: there is none."""
    return cast("OpenJoystick", resolve(_joystick(name).open))


def open_assist(name: str) -> OpenAssist:
    """The factory of the assist that a `mode` chooses. Raises ConfigError: there is none."""
    target = ASSISTS.get(name) or _entry_point("bentod.assists", name, ASSISTS)
    return cast("OpenAssist", resolve(target if ":" in target else f"{target}:open_assist"))


def open_player() -> OpenAudio:
    """The factory of what makes sound on this machine."""
    return cast("OpenAudio", resolve(PLAYER))


def open_learner(name: str) -> OpenLearner:
    """The factory of the learner that a question's `algorithm` chooses. Raises ConfigError: there is none."""
    target = LEARNERS.get(name) or _entry_point("bentod.learners", name, LEARNERS)
    return cast("OpenLearner", resolve(target if ":" in target else f"{target}:open_learner"))


def driver_models(name: str) -> tuple[type[BaseModel], type[BaseModel]]:
    """Models of a driver's table and of a joint's `hardware`. Raises ConfigError: no such driver."""
    driver = _driver(name)
    return _model(driver.options), _model(driver.hardware)


def emg_model(name: str) -> type[BaseModel]:
    """Model of a source's table. Raises ConfigError: no such source."""
    return _model(_source(name).options)


def joystick_model(name: str) -> type[BaseModel]:
    """Model of a joystick's table. Raises ConfigError: no such source."""
    return _model(_joystick(name).options)


def _model(target: str) -> type[BaseModel]:
    return cast("type[BaseModel]", resolve(target))


def _driver(name: str) -> Driver:
    if name in JOINTS:
        return JOINTS[name]
    module = _entry_point("bentod.joints", name, JOINTS)
    return Driver(f"{module}:open_joints", f"{module}:Options", f"{module}:Hardware")


def _source(name: str) -> Source:
    if name in EMG:
        return EMG[name]
    module = _entry_point("bentod.inputs", name, EMG)
    return Source(f"{module}:open_emg", f"{module}:Options")


def _joystick(name: str) -> Source:
    if name in JOYSTICKS:
        return JOYSTICKS[name]
    module = _entry_point("bentod.inputs", name, JOYSTICKS)
    return Source(f"{module}:open_joystick", f"{module}:Options")


def _entry_point(group: str, name: str, ours: Iterable[str]) -> str:
    """The module that a package from outside offers under `name`; imported only if it is chosen."""
    offered = {point.name: point.value for point in importlib.metadata.entry_points(group=group)}
    if name not in offered:
        raise ConfigError(f"'{name}' is unknown{nearest(name, [*ours, *offered])}")
    return offered[name]


def _refuse_foreign(package: str) -> None:
    """`drivers` and `sim` are common words: a stranger of that name on the path is never imported."""
    if package not in ("drivers", "sim"):
        return
    ours = Path(__file__).parent.parent / package / "__init__.py"
    spec = importlib.util.find_spec(package)
    if spec is None or spec.origin is None or Path(spec.origin) != ours:
        where = spec.origin if spec else "nowhere"
        raise ConfigError(f"the package '{package}' ({where}) is not bentod's own; remove it from the path")
