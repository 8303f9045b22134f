"""What was trained in earlier sessions, put to use at the start, and the place where more is learned."""

import logging
import os
from collections.abc import Mapping
from pathlib import Path

from bentod.config import Config
from bentod.config_recognition import Recognition
from bentod.emg.live.lessons import Lessons
from bentod.errors import Refused
from bentod.muscles import Muscles
from bentod.record.disk import default_folder

_log = logging.getLogger(__name__)


def lessons(config: Config, muscles: Muscles, name: str) -> Lessons | None:
    """Have `muscles` recognised by the model that the config names, if there is one that can be used.

    `name`: of the config. None where nothing is to be recognised. A model that is missing or does not fit
    keeps no arm from running: its muscles move nothing by classes, and clients are told why.
    """
    recogniser, emg = muscles.recognition, config.emg
    if recogniser is None or emg is None or emg.recognition is None:
        return None
    table = emg.recognition
    found = Lessons(_folder(table, name, os.environ), table, emg.filters)
    if found.folder is None or not found.has(table.model):
        _log.info("%s", recogniser.problem)
        return found
    try:
        model = found.read(table.model)
        if unlike := model.differences(recogniser.setting, recogniser.features):
            raise Refused(" ".join(unlike))
        recogniser.use(model, table.model)
        _log.info("muscles are recognised by %s (%s)", found.model(table.model), model.kind)
    except Refused as error:
        recogniser.unusable(f"The model {table.model} cannot be used: {error}")
        _log.warning("%s", recogniser.problem)
    return found


def _folder(table: Recognition, name: str, environment: Mapping[str, str]) -> Path | None:
    """Where models of the config `name` are kept; None: nowhere, as neither has a name."""
    if table.folder or not name:
        return table.folder
    return default_folder(environment).with_name("muscles") / Path(name).stem
