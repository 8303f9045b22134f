"""What another process does for the loop: aligning labels and training, which take a whole processor."""

import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bentod.emg.augment import Tonic
from bentod.emg.classify import model_file
from bentod.emg.classify.evaluation import by_repetition, total
from bentod.emg.classify.labelled import LabelledWindows, windows_of
from bentod.emg.classify.labelled_files import read
from bentod.emg.classify.model import Setting
from bentod.emg.classify.training import Recipe, trained
from bentod.emg.live.alignment import aligned, labelled
from bentod.emg.live.collection import Session
from bentod.emg.live.orders import Keep, Learn, Order
from bentod.emg.live.plan import Prompt
from bentod.emg.live.quality import quality, warnings
from bentod.emg.live.stream import features
from bentod.emg.live.training_file import Arrays, add
from bentod.emg.segmenting import segmenting
from bentod.errors import ConfigError
from bentod.frames import Value


def session_arrays(session: Session) -> Arrays:
    """A raw session as it is handed over in a file."""
    prompts = session.prompts
    return {
        "emg": session.samples,
        "fs": np.array(session.rate_hz),
        "names": np.array([prompt.label for prompt in prompts]),
        "places": np.array([(prompt.repetition, prompt.shown, prompt.hidden) for prompt in prompts]),
    }


def session_of(arrays: Arrays) -> Session:
    """The raw session that these arrays tell."""
    prompts = tuple(
        Prompt(str(name), *(int(place) for place in places))
        for name, places in zip(arrays["names"], arrays["places"], strict=True)
    )
    return Session(float(np.asarray(arrays["fs"])), np.asarray(arrays["emg"], np.float32), prompts)


def carried_out(order: Order) -> dict[str, Value]:
    """What came of an order, as plain data. Raises BentodError, OSError: nothing did."""
    return _kept(order) if isinstance(order, Keep) else _trained(order)


def _kept(order: Keep) -> dict[str, Value]:
    with np.load(order.session, allow_pickle=False) as file:
        session = session_of({name: file[name] for name in file.files})
    moved = aligned(session, order.filters)
    piece, prompted = labelled(session, moved, order.condition)
    sessions, gone = add(Path(order.data), piece, prompted, session.rate_hz, order.add)
    found = quality(session, moved)
    told = warnings(found, moved, session.rate_hz)
    if gone:
        told.append(f"The oldest sessions had to go for want of room: {gone}.")
    return {"sessions": sessions, "classes": found, "warnings": list[Value](told)}


def _trained(order: Learn) -> dict[str, Value]:
    began = time.perf_counter()
    recorded = read(Path(order.data))
    table, rate, channels = order.table, recorded.rate_hz, recorded.channels
    setting = Setting(rate, channels, segmenting(table.window_s, table.step_s, rate), order.filters)
    windows = windows_of([recorded], setting.segmenting, setting.filters)
    recipe = Recipe(
        features(table, channels, rate),
        table.classifier,
        table.options,
        table.seed,
        None if table.tonic is None else Tonic(strength=table.tonic),
    )
    about = {**_expected(windows, recipe), "sessions": len(recorded.pieces), "data": Path(order.data).name}
    model = trained(windows, recipe, setting, about)
    size = model_file.write(Path(order.out), model)
    told: Mapping[str, Value] = {**about, "windows": model.training["windows"], "classifier": model.kind}
    return {**told, "bytes": size, "seconds": time.perf_counter() - began}


def _expected(windows: LabelledWindows, recipe: Recipe) -> dict[str, Value]:
    """How well each repetition is recognised by what was trained on the others."""
    if len(set(windows.repetitions.tolist())) < 2:
        return {"accuracy": None, "recall": {}, "by_repetition": []}
    try:
        scores = by_repetition(windows, recipe)
    except ConfigError:  # a class that was made in one repetition only
        return {"accuracy": None, "recall": {}, "by_repetition": []}
    whole = total(list(scores.values()))
    return {
        "accuracy": whole.accuracy,
        "recall": dict(whole.recall()),
        "by_repetition": [score.accuracy for score in scores.values()],
    }
