"""The newest decision about the wearer's muscles, and what it asks of the joints."""

import asyncio
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from bentod.config_conditioning import Filter
from bentod.config_recognition import Recognition
from bentod.emg.adapt.adaptive import Adaptive, adaptive
from bentod.emg.classify.model import Model, Setting
from bentod.emg.feed import Feed
from bentod.emg.live.collection import Collection
from bentod.emg.live.plan import check
from bentod.emg.live.stream import Stream, deciding, features
from bentod.emg.recognition import REST, Decision, Fuse
from bentod.emg.segmenting import segmenting
from bentod.errors import ConfigError, Refused
from bentod.frames import Value
from bentod.recognition_frame import RecognitionFrame

_log = logging.getLogger(__name__)

LONGEST_WAIT_S = 0.25
"""s for which samples may wait for the one that completes a window."""

LOST_S = 1.0
"""s without signals that can be believed, after which the muscles must be seen at rest."""

NO_MODEL = (
    "Nothing is recognised: there is no model yet. Collect and train on the page (Muscles), "
    "or by `bentod ctl emg-retrain`."
)
REST_FIRST = "Nothing is moved until the muscles have been recognised as at rest."


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is asked in one tick."""

    efforts: Mapping[str, float]  # by group, 0..1; a group that is absent is not asked for anything
    moves: Mapping[str, Mapping[str, float]]  # by group and joint, share of the joint's greatest velocity
    frame: RecognitionFrame
    tense: Sequence[str] = ()  # groups for which the muscles were not seen at rest


class Recogniser:
    """Works in a task of its own as samples arrive; the tick takes what is decided by then.

    No window is left out: what comes in a burst is worked off in pieces, and the newest decision holds.
    """

    def __init__(self, table: Recognition, filters: Sequence[Filter], feed: Feed) -> None:
        """Raises ConfigError: features, windows or channels do not suit the source; an extra is missing."""
        rate, has = feed.ring.rate_hz, feed.ring.channels
        self.table = table
        self.channels = table.channels or tuple(range(has))
        if max(self.channels) >= has:
            raise ConfigError(
                f"emg.recognition.channels: there is no channel {max(self.channels)}; the source has {has}, "
                "counted from 0",
                "channels",
            )
        cuts = segmenting(table.window_s, table.step_s, rate)
        self.setting = Setting(rate, len(self.channels), cuts, tuple(filters))
        self.features = features(table, len(self.channels), rate)
        self.features.check(cuts.length)
        self.model: Model | None = None
        self.model_name = ""
        self.problem = NO_MODEL
        """Why nothing can be recognised at all; empty if it can."""
        self.newest: Decision | None = None
        self.decided: Callable[[Decision], None] = lambda _: None
        """Told of every decision as soon as it is made."""
        self.collection: Collection | None = None
        self.tell: Callable[[str, Mapping[str, Value]], None] = lambda *_: None
        """Told what is prompted: a sentence and its data."""
        self.late = 0
        """Samples that were gone before they could be looked at."""
        self.fuse: Fuse | None = None
        """Weighs predictions in, from the next model on."""
        self.heeded = True
        """Whether the joints that classes move may move, and nobody else drives them."""
        self._adaptive: Adaptive | None = None
        self._feed = feed
        self._stream = Stream(self.setting, self.channels)
        self._by_name = {one.name: one for one in table.classes}
        self._most = round(LONGEST_WAIT_S * rate)
        self._collected = 0  # index after the newest sample that a collection was given
        self._collection_at = 0  # interventions when the collection began
        self._must_rest, self._openings = True, feed.openings
        self._problem_since: float | None = None

    def use(self, model: Model, name: str) -> None:
        """Decide by `model` from the next sample on; muscles must be seen at rest first.

        Raises:
            Refused: it was trained with other signals, windows or features; one sentence for each difference.
        """
        if problems := model.differences(self.setting):
            raise Refused(" ".join(problems))
        self._adaptive = adaptive(model, self.table.adaptation)
        followed = replace(model, classifier=self._adaptive) if self._adaptive else model
        self._stream.use(followed, deciding(self.table), self.fuse)
        self.model, self.model_name = model, name
        self.problem, self.newest = "", None
        self._must_rest = True
        data: dict[str, Value] = {"model": name, "classifier": model.kind, "labels": list(model.labels)}
        self.tell(f"EMG is recognised by the model {name} ({model.kind})", data)

    def reset_adaptation(self) -> None:
        """Back to what was trained. Raises Refused: nothing is adapted."""
        if self._adaptive is None:
            raise Refused("nothing is adapted: it takes [emg.recognition.adaptation] and such a model")
        self._adaptive.reset()
        self._must_rest = True
        self.tell("EMG recognition is as it was trained again", {"model": self.model_name})

    def unusable(self, why: str) -> None:
        """There is no model for the reason that the sentence tells."""
        self.problem = why

    async def run(self) -> None:
        """Work on samples as they come, for ever."""
        came = asyncio.Event()

        def heard() -> None:
            if self._ready():
                came.set()

        self._feed.came = heard
        while True:
            await came.wait()
            came.clear()
            while self.step():  # noqa: ASYNC110 -- whoever else is due gets a turn
                await asyncio.sleep(0)

    def step(self) -> bool:
        """Work on what has come since the last step, for a few ms at most; whether there is more.

        Whatever breaks is told, and moves nothing from then on.
        """
        try:
            return self._step()
        except Exception as error:  # noqa: BLE001 -- control by clients goes on without recognition
            self._stream.use(None, deciding(self.table))
            self.model, self.newest = None, None
            self.problem = f"Recognition broke and is off: {type(error).__name__}: {error}."
            _log.exception("recognition broke and is off")
            return False

    def _ready(self) -> bool:
        """Whether a window can be decided, or so much waits that it might be gone from the ring."""
        waiting = self._feed.ring.next_index - self._stream.next_index
        return self._feed.ring.next_index >= self._stream.due or waiting > self._most

    def _step(self) -> bool:
        if not self._ready():
            return False
        samples = self._feed.since(self._stream.next_index)
        first = self._feed.ring.next_index - len(samples)
        self.late += first - self._stream.next_index
        piece = samples[: self._stream.at_once]
        if not len(piece):
            return False
        for decision in self._stream.take(first, piece):
            self.newest = decision
            self.decided(decision)
            if decision.at_rest:
                self._must_rest = False
        return self._ready()

    def look(self, now: float, problem: str, obeyed: bool, interventions: int = 0) -> Wanted:
        """What is asked at `now` (monotonic s).

        `problem`: why the signals cannot be believed; `obeyed`: whether muscles may move anything at all;
        `interventions`: how often the arm was stopped, paused and so on, each of which ends a collection.
        """
        self._watch(now, problem)
        collecting = self._collect(now, problem, interventions)
        self.step()
        decision = self.newest
        why = self.problem or problem or self._stale() or (REST_FIRST if self._must_rest else "")
        if self._adaptive:  # nobody corrects an arm that does not obey
            self._adaptive.obeyed = obeyed and self.heeded and not collecting and not why
        if not obeyed or collecting or why or decision is None:
            return Wanted({}, {}, self._frame(decision, why))
        tense = () if decision.at_rest else self.table.groups()
        return Wanted(*self._asked(decision), self._frame(decision, ""), tense)

    def collect(self, collection: Collection, interventions: int) -> None:
        """Begin a collection with the next look. Raises Refused: one is under way."""
        if self.collection is not None:
            raise Refused("contractions are being collected already")
        self.collection, self._collection_at = collection, interventions
        self._collected = self._feed.ring.next_index

    def prompt(self, label: str) -> None:
        """Have a simulated wearer move; see `check`. Raises Refused: a collection prompts already."""
        check(label, self._by_name)
        if self.collection is not None:
            raise Refused("contractions are being collected, and prompted, already")
        self._feed.prompt(label)
        self.tell(f"Movement asked for: {label}", {"prompt": label})

    def cancel(self, why: str, collection: Collection | None = None) -> None:
        """End the collection that is under way, or only this one if it still is."""
        if self.collection is not None and collection in (None, self.collection):
            self.collection.cancel(why)
            self._over(why)

    def _over(self, why: str) -> None:
        self.collection, self._must_rest = None, True
        self._feed.prompt(REST)
        what = f"Collection ended: {why}" if why else "Collection is complete."
        self.tell(what, {"collection": "cancelled" if why else "complete", "reason": why})

    def _collect(self, now: float, problem: str, interventions: int) -> bool:
        """Let a collection take in what came; whether one is under way."""
        collection = self.collection
        if collection is None:
            return False
        if interventions != self._collection_at:
            self.cancel("the arm was stopped, paused, released or in fault.")
            return True
        ring = self._feed.ring
        told = collection.take(ring.next_index, self._feed.since(self._collected), now, problem)
        self._collected = ring.next_index
        for one in told:
            self._feed.prompt(one.label)
            self.tell(one.text, {"prompt": one.label, "repetition": one.repetition, "of": one.of,
                                 "seconds": one.seconds})  # fmt: skip
        if collection.over:
            self._over(collection.why)
        return True

    def _watch(self, now: float, problem: str) -> None:
        """Who was lost must be seen at rest."""
        if problem and self._problem_since is None:
            self._problem_since = now
        lasted = 0.0 if self._problem_since is None else now - self._problem_since
        if not problem:
            self._problem_since = None
        if self._feed.openings != self._openings or lasted > LOST_S:
            self._must_rest, self._openings = True, self._feed.openings

    def _stale(self) -> str:
        """Why the newest decision is not about now; two steps are what a burst may leave over."""
        if self.newest is None:
            return "No window of muscle signals has been decided yet."
        behind = self._feed.ring.next_index - 1 - self.newest.index
        bound = 2 * self.setting.segmenting.step
        return f"The newest decision is {behind} samples old; the bound is {bound}." if behind > bound else ""

    def _asked(self, decision: Decision) -> tuple[dict[str, float], dict[str, Mapping[str, float]]]:
        efforts = dict.fromkeys(self.table.groups(), 0.0)
        one = self._by_name.get(decision.label)
        if one is None or not decision.speed > 0:
            return efforts, {}
        efforts[one.group] = min(decision.speed, 1.0)
        return efforts, {one.group: one.moves}

    def _frame(self, decision: Decision | None, why: str) -> RecognitionFrame:
        prompted = self.collection.prompted if self.collection else ""
        if decision is None:
            return RecognitionFrame(-1, REST, 0.0, {}, REST, False, why, self.model_name, prompted)
        return RecognitionFrame(
            decision.index,
            decision.label,
            decision.speed,
            decision.probabilities,
            decision.likely,
            decision.rejected,
            why or decision.reason,
            self.model_name,
            prompted,
            decision.fused.weight if decision.fused else 0.0,
            decision.fused.unaided if decision.fused else "",
        )

    def describe(self) -> dict[str, Value]:
        """As clients see it: classes and what they move, the model and what it was trained on."""
        classes: list[Value] = [one.model_dump(mode="json") for one in self.table.classes]
        model = self.model
        known: Value = None
        if model:
            known = {"name": self.model_name, "classifier": model.kind, "labels": list(model.labels),
                     "training": dict(model.training)}  # fmt: skip
        return {
            "problem": self.problem,
            "model": known,
            "classes": classes,
            "window_s": self.table.window_s,
            "step_s": self.table.step_s,
            "collecting": self.collection is not None,
            "late_samples": self.late,
            "adaptation": self._adaptive.describe() if self._adaptive else None,
        }
