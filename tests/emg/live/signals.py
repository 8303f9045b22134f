"""A person at a wire who does what they are told, and what they gave when a collection asked them."""

from functools import cache
from itertools import pairwise

import numpy as np

from bentod.config_conditioning import Filter
from bentod.config_recognition import Recognition
from bentod.emg.classify.labelled import Recorded, windows_of
from bentod.emg.classify.model import Model, Setting
from bentod.emg.classify.training import Recipe, trained
from bentod.emg.live.alignment import aligned, labelled
from bentod.emg.live.collection import Session
from bentod.emg.live.plan import Plan
from bentod.emg.live.stream import features
from bentod.emg.segmenting import segmenting
from bentod.frames import Samples
from sim.movements import Prompted
from sim.obeying import Obeying

RATE_HZ, ELECTRODES = 1000.0, 8
FILTERS = (Filter(kind="high_pass", hz=20),)
LABELS = ("wrist_flexion", "wrist_extension", "pronation")
TABLE = Recognition.model_validate(
    {
        "reject_below": 0.5,
        "classes": [
            {"name": "wrist_flexion", "group": "hand", "moves": {"wrist_flexion": 1.0}},
            {"name": "wrist_extension", "group": "hand", "moves": {"wrist_flexion": -0.5}},
            {"name": "pronation", "group": "hand", "moves": {"wrist_rotation": 1.0, "wrist_flexion": 0.5}},
        ],
    }
)
SETTING = Setting(RATE_HZ, ELECTRODES, segmenting(TABLE.window_s, TABLE.step_s, RATE_HZ), FILTERS)


def wearer(session: int = 1) -> Obeying:
    return Obeying(Prompted(electrodes=ELECTRODES, obeys=True, session=session), RATE_HZ)


def performed(plan: Plan, person: Obeying) -> Session:
    """What the person gives when they are prompted as planned."""
    prompts = plan.prompts(RATE_HZ)
    edges = {prompt.shown: prompt.label for prompt in prompts} | {prompt.hidden: "" for prompt in prompts}
    places = [0, *sorted(edges), plan.samples(RATE_HZ)]
    parts: list[Samples] = []
    for start, stop in pairwise(places):
        if start in edges:
            person.prompt(edges[start])
        parts.append(person.read(start, stop - start))
    return Session(RATE_HZ, np.concatenate(parts), prompts)


@cache
def session() -> Session:
    """Three classes, three times."""
    return performed(Plan(LABELS, 1.5, 1.5, 3), wearer())


@cache
def model(kind: str = "lda") -> Model:
    """Trained on that session."""
    piece, _ = labelled(session(), aligned(session(), FILTERS), "")
    windows = windows_of([Recorded(RATE_HZ, (piece,))], SETTING.segmenting, FILTERS)
    return trained(windows, Recipe(features(TABLE, ELECTRODES, RATE_HZ), kind), SETTING)
