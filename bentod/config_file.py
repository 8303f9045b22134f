"""Reading a config file: TOML in, checked values out, every mistake at once."""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from pydantic import BaseModel, ValidationError

from bentod.config import Config
from bentod.config_errors import explain
from bentod.config_tables import Chosen
from bentod.errors import ConfigError


class OptionModels(Protocol):
    """Where the config finds the tables that belong to drivers and sources (the registry)."""

    def driver_models(self, name: str) -> tuple[type[BaseModel], type[BaseModel]]:
        """Models of the driver's table and of a joint's `hardware`. Raises ConfigError: no such driver."""
        ...

    def emg_model(self, name: str) -> type[BaseModel]:
        """Model of the source's table. Raises ConfigError: no such source."""
        ...

    def joystick_model(self, name: str) -> type[BaseModel]:
        """Model of the joystick's table. Raises ConfigError: no such source."""
        ...


@dataclass(frozen=True, slots=True)
class Overrides:
    """What the command line puts in the place of the file's."""

    emg_source: Chosen | None = None
    port: str = ""  # of the default driver
    record: bool | None = None


NONE = Overrides()


def load(path: Path, models: OptionModels, overrides: Overrides = NONE) -> Config:
    """The config in `path`, with what `overrides` replaces.

    Raises:
        ConfigError: one line for every mistake, each with file, key, value and bound.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from error
    return parse(text, str(path), models, overrides)


def parse(text: str, source: str, models: OptionModels, overrides: Overrides = NONE) -> Config:
    """The config in `text`; `source` names it in errors. Raises as `load` does."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{source}: not valid TOML: {error}") from error
    problems = _override(data, overrides)
    config: Config | None = None
    try:
        config = Config.model_validate(data)
    except ValidationError as error:
        problems += explain(error, Config)
    problems += _option_problems(data, models)
    if problems or config is None:
        raise ConfigError("\n".join(f"{source}: {line}" for line in problems))
    return config


def _override(data: dict[str, object], overrides: Overrides) -> list[str]:
    """Put the command line's values in; what cannot be put anywhere is a mistake too."""
    emg, driver = data.get("emg"), data.get("driver")
    if overrides.emg_source and emg is None:
        return ["an EMG source can only be replaced in the table [emg], and there is none"]
    if overrides.emg_source and isinstance(emg, dict):
        emg["source"] = {"name": overrides.emg_source.name, **overrides.emg_source.options}
    record = data.setdefault("record", {})
    if overrides.record is not None and isinstance(record, dict):
        record["enabled"] = overrides.record
    if overrides.port and isinstance(driver, dict):
        driver["port"] = overrides.port
    elif overrides.port and "drivers" in data:
        return ["a port can only be replaced in the table [driver], and there is none"]
    return []


def _option_problems(data: Mapping[str, object], models: OptionModels) -> list[str]:
    """Mistakes in the tables that belong to the drivers and to the sources of EMG and pushes."""
    problems: list[str] = []
    for key, table in _driver_tables(data).items():
        joints = _joints_on(key, data.get("joints"))
        problems += _driver_problems(("drivers", key) if key else ("driver",), table, joints, models)
    problems += _source_problems("emg", data, models.emg_model)
    return problems + _source_problems("joystick", data, models.joystick_model)


def _source_problems(
    key: str, data: Mapping[str, object], model: Callable[[str], type[BaseModel]]
) -> list[str]:
    """Mistakes in the table of what is opened for the table `key`."""
    table = data.get(key)
    source = table.get("source") if isinstance(table, dict) else None
    if not isinstance(source, dict) or not isinstance(source.get("name"), str):
        return []
    try:
        return _check(model(source["name"]), _without_name(source), (key, "source"))
    except ConfigError as error:
        return [f"{key}.source.name: {error}"]


def _driver_tables(data: Mapping[str, object]) -> dict[str, Mapping[str, object]]:
    """Tables that choose a driver, by what joints call it: "" for the default."""
    others = data.get("drivers")
    tables = {"": data.get("driver"), **(others if isinstance(others, dict) else {})}
    return {
        key: table
        for key, table in tables.items()
        if isinstance(table, dict) and isinstance(table.get("name"), str)
    }


def _joints_on(key: str, joints: object) -> dict[int, object]:
    """`hardware` of the joints on one driver, by index."""
    return {
        index: joint.get("hardware", {})
        for index, joint in enumerate(joints if isinstance(joints, list) else [])
        if isinstance(joint, dict) and joint.get("driver", "") == key
    }


def _driver_problems(
    where: tuple[str, ...], driver: Mapping[str, object], joints: Mapping[int, object], models: OptionModels
) -> list[str]:
    try:
        options, hardware = models.driver_models(str(driver["name"]))
    except ConfigError as error:
        return [f"{'.'.join(where)}.name: {error}"]
    problems = _check(options, _without_name(driver), where)
    for index, table in joints.items():
        problems += _check(hardware, table, ("joints", index, "hardware"))
    return problems


def _without_name(table: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in table.items() if key != "name"}


def _check(model: type[BaseModel], table: object, where: tuple[str | int, ...]) -> list[str]:
    try:
        model.model_validate(table)
    except ValidationError as error:
        return explain(error, model, where)
    return []
