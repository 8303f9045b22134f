"""Reading a config file: TOML in, checked values out, every mistake at once."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from pydantic import BaseModel, ValidationError

from bentod.config import Chosen, Config
from bentod.config_errors import explain
from bentod.errors import ConfigError


class OptionModels(Protocol):
    """Where the config finds the tables that belong to drivers and sources (the registry)."""

    def driver_models(self, name: str) -> tuple[type[BaseModel], type[BaseModel]]:
        """Models of the driver's table and of a joint's `hardware`. Raises ConfigError: no such driver."""
        ...

    def emg_model(self, name: str) -> type[BaseModel]:
        """Model of the source's table. Raises ConfigError: no such source."""
        ...


@dataclass(frozen=True, slots=True)
class Overrides:
    """What the command line puts in the place of the file's."""

    emg_source: Chosen | None = None
    port: str = ""  # of the driver


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
    _override(data, overrides)
    problems: list[str] = []
    config: Config | None = None
    try:
        config = Config.model_validate(data)
    except ValidationError as error:
        problems += explain(error, Config)
    problems += _option_problems(data, models)
    if problems or config is None:
        raise ConfigError("\n".join(f"{source}: {line}" for line in problems))
    return config


def _override(data: dict[str, object], overrides: Overrides) -> None:
    emg, driver = data.get("emg"), data.get("driver")
    if overrides.emg_source and isinstance(emg, dict):
        emg["source"] = {"name": overrides.emg_source.name, **overrides.emg_source.options}
    if overrides.port and isinstance(driver, dict):
        driver["port"] = overrides.port


def _option_problems(data: Mapping[str, object], models: OptionModels) -> list[str]:
    """Mistakes in the tables that belong to the driver and to the EMG source."""
    problems: list[str] = []
    driver = data.get("driver")
    if isinstance(driver, dict) and isinstance(driver.get("name"), str):
        problems += _driver_problems(driver, data.get("joints"), models)
    emg = data.get("emg")
    source = emg.get("source") if isinstance(emg, dict) else None
    if isinstance(source, dict) and isinstance(source.get("name"), str):
        try:
            problems += _check(models.emg_model(source["name"]), _without_name(source), ("emg", "source"))
        except ConfigError as error:
            problems.append(f"emg.source.name: {error}")
    return problems


def _driver_problems(driver: Mapping[str, object], joints: object, models: OptionModels) -> list[str]:
    try:
        options, hardware = models.driver_models(str(driver["name"]))
    except ConfigError as error:
        return [f"driver.name: {error}"]
    problems = _check(options, _without_name(driver), ("driver",))
    for index, joint in enumerate(joints if isinstance(joints, list) else []):
        if isinstance(joint, dict):
            problems += _check(hardware, joint.get("hardware", {}), ("joints", index, "hardware"))
    return problems


def _without_name(table: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in table.items() if key != "name"}


def _check(model: type[BaseModel], table: object, where: tuple[str | int, ...]) -> list[str]:
    try:
        model.model_validate(table)
    except ValidationError as error:
        return explain(error, model, where)
    return []
