"""Methods about recognising muscle signals: collecting, training, using; clients read the docstrings."""

import asyncio
from typing import Annotated

from bentod.emg.live.collection import Collection
from bentod.emg.live.collection import Session as Collected
from bentod.emg.live.lessons import Lessons
from bentod.emg.live.plan import planned
from bentod.errors import BadRequest, Refused
from bentod.frames import Value
from bentod.serve.params import Flag, Number, Text
from bentod.serve.room import Room
from bentod.serve.session import Session

Classes = Annotated[list[str] | None, Text("classes of the config; nil for all", 32)]
Hold = Annotated[float, Number("s", 0.5, 30, "how long each contraction is held")]
Rest = Annotated[float, Number("s", 0.5, 30, "rest before and after each")]
Repetitions = Annotated[int, Number("", 1, 50, "of each class")]
Add = Annotated[bool, Flag("false forgets what was collected before")]
Condition = Annotated[str, Text("a note that is kept with it, e.g. what was held", 64)]
Name = Annotated[str | None, Text("which model; nil for the one in the config", 32)]
Classifier = Annotated[str | None, Text("another classifier than in the config, e.g. knn", 32)]


class EmgMethods:
    """Handlers of pattern recognition."""

    def __init__(self, room: Room) -> None:
        self._room = room

    async def emg_classes(self, session: Session) -> Value:
        """The classes of contractions, what each moves, the model in use and the models that there are."""
        lessons = self._lessons()
        told = (await self._room.inbox.ask(lambda desk: desk.recognition.describe())).result
        return {**told, "models": list[Value](await asyncio.to_thread(lessons.models))}

    async def emg_collect(
        self,
        session: Session,
        classes: Classes = None,
        hold_s: Hold = 3.0,
        rest_s: Rest = 3.0,
        repetitions: Repetitions = 3,
        add: Add = True,
        condition: Condition = "",
    ) -> Value:
        """Prompt contractions by events, and keep them to be trained on; muscles move nothing meanwhile.

        Returns, by class, how strong the signal was and how far labels were moved to where muscles worked.
        It ends without a result when you leave, when the source dies, and when the arm is stopped or paused.
        """
        lessons = self._lessons()
        lessons.prepare()
        found = await self._collected(classes or [], hold_s, rest_s, repetitions)
        return await lessons.keep(found, add, condition)

    async def emg_train(self, session: Session, model: Name = None, classifier: Classifier = None) -> Value:
        """Train a model on all that was collected, while the arm goes on as it is.

        Returns how well each repetition is recognised by what is trained on the others.
        """
        return await self._lessons().train(self._name(model), classifier)

    async def emg_use(self, session: Session, model: Name = None) -> Value:
        """Recognise by a model that was trained, from the next tick on; muscles must first be at rest."""
        await self._use(self._name(model))
        return None

    async def emg_reset(self, session: Session) -> Value:
        """Forget what recognition learned in use, and recognise as trained; muscles must first be at rest."""
        await self._room.inbox.ask(lambda desk: desk.recognition.reset_adaptation())
        return None

    async def emg_retrain(
        self,
        session: Session,
        classes: Classes = None,
        hold_s: Hold = 3.0,
        rest_s: Rest = 3.0,
        repetitions: Repetitions = 1,
        add: Add = True,
        condition: Condition = "",
        model: Name = None,
    ) -> Value:
        """Collect, train on old and new, and use: all that a wearer does to be understood again."""
        name = self._name(model)
        collected = await self.emg_collect(session, classes, hold_s, rest_s, repetitions, add, condition)
        trained = await self.emg_train(session, name)
        await self._use(name)
        return {"collected": collected, "trained": trained}

    async def emg_prompt(
        self, session: Session, label: Annotated[str, Text("a movement; rest for none", 32)]
    ) -> Value:
        """Have a simulated wearer make a movement until another is asked for; real ones only hear of it."""
        await self._room.inbox.ask(lambda desk: desk.recognition.prompt(label))
        return None

    async def _collected(
        self, classes: list[str], hold_s: float, rest_s: float, repetitions: int
    ) -> Collected:
        """What was done. Whoever waits no longer ends it."""
        inbox = self._room.inbox
        recogniser = (await inbox.ask(lambda desk: desk.recognition)).result
        known = [one.name for one in recogniser.table.classes]
        rate, channels = recogniser.setting.rate_hz, recogniser.channels
        plan = planned(classes, hold_s, rest_s, repetitions, known, rate, len(channels))
        done: asyncio.Future[Collected] = asyncio.get_running_loop().create_future()

        def ended(found: Collected | None, why: str) -> None:
            if done.done():
                return
            if found is None:
                done.set_exception(Refused(f"nothing was kept: {why}"))
            else:
                done.set_result(found)

        collection = Collection(plan, rate, channels, ended)
        try:
            await inbox.ask(lambda desk: desk.collect(collection))
            return await done
        finally:
            if not collection.over:
                inbox.post(lambda desk: desk.recognition.cancel("whoever asked for it has left.", collection))

    async def _use(self, name: str) -> None:
        found = await self._lessons().load(name)
        await self._room.inbox.ask(lambda desk: desk.recognition.use(found, name))

    def _lessons(self) -> Lessons:
        if self._room.lessons is None:
            raise Refused("the config has no [emg.recognition] table")
        return self._room.lessons

    def _name(self, model: str | None) -> str:
        """The name of a model, which is that of a file. Raises BadRequest: it cannot be."""
        lessons = self._lessons()
        if model is None:
            return lessons.table.model
        if not model.isascii() or not model.replace("_", "a").isalnum():
            raise BadRequest("the name of a model has letters, figures and _ only", "model")
        return model
