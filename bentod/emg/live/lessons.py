"""From what was collected to a model in use: the files in between, one order at a time."""

import asyncio
import os
import uuid
from dataclasses import dataclass, field
from pathlib import Path

from bentod.config_conditioning import Filter
from bentod.config_recognition import Recognition
from bentod.emg.classify import model_file
from bentod.emg.classify.model import Model
from bentod.emg.live import workshop
from bentod.emg.live.carrying_out import session_arrays
from bentod.emg.live.collection import Session
from bentod.emg.live.orders import Keep, Learn, Order
from bentod.emg.live.training_file import saved
from bentod.errors import BadRequest, Refused, SnapshotError
from bentod.frames import Value
from bentod.registry import CLASSIFIERS


@dataclass(slots=True)
class Lessons:
    """Models and training data of one config, in one folder. Nothing here holds up the loop."""

    folder: Path | None
    """None: there is no place for files, as neither the config nor its file names one."""
    table: Recognition
    filters: tuple[Filter, ...]
    _busy: asyncio.Lock = field(default_factory=asyncio.Lock)

    def data(self) -> Path:
        """The file of what is trained on. Raises Refused: there is no folder."""
        return self._folder() / "training.npz"

    def model(self, name: str) -> Path:
        """The file of a model. Raises Refused: there is no folder."""
        return self._folder() / f"{name}.model"

    def has(self, name: str) -> bool:
        """Whether there is such a model, be it that it cannot be read."""
        try:
            return self.model(name).exists()
        except OSError:
            return True

    def models(self) -> list[str]:
        """Names of the models that there are."""
        return sorted(path.stem for path in self.folder.glob("*.model")) if self.folder else []

    async def keep(self, session: Session, add: bool, condition: str) -> dict[str, Value]:
        """Align a session's labels and keep it; returns what was found, class by class.

        Raises:
            Refused: it cannot be kept; the raw session then stays in the folder, if the disk took it.
        """
        data = self.data()
        raw = data.with_name(f"unkept.{uuid.uuid4().hex}.npz")
        try:
            await asyncio.to_thread(saved, raw, session_arrays(session))
        except OSError as error:
            raise Refused(f"the session cannot be written to {data.parent}: {_said(error)}") from error
        order = Keep(session=str(raw), data=str(data), filters=self.filters, add=add, condition=condition)
        try:
            async with self._busy:  # what took minutes to make is not thrown away for a training under way
                told = await workshop.in_a_process(order)
        except Refused as error:
            raise Refused(f"{error} (the raw session is in {raw})") from error
        except asyncio.CancelledError:  # whoever asked has left
            raw.unlink(missing_ok=True)
            raise
        raw.unlink(missing_ok=True)
        return told

    def prepare(self) -> None:
        """Make sure that there is a place for what is to be collected. Raises Refused: there is none."""
        folder = self._folder()
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise Refused(f"nothing can be kept in {folder}: {_said(error)}") from error
        if not os.access(folder, os.W_OK | os.X_OK):
            raise Refused(f"nothing can be kept in {folder}: it may not be written to")

    async def train(self, name: str, classifier: str | None = None) -> dict[str, Value]:
        """Train the model `name` on all that was collected; returns how well repetitions are recognised.

        Raises:
            BadRequest: there is no such classifier.
            Refused: nothing was collected, it cannot be trained, or another order is being carried out.
        """
        if classifier is not None and classifier not in CLASSIFIERS:
            raise BadRequest(f"there is no such classifier (known: {', '.join(CLASSIFIERS)})", "classifier")
        if not self.data().exists():
            raise Refused("nothing has been collected yet: collect contractions first")
        other = {} if classifier is None else {"classifier": classifier, "options": {}}
        table = self.table.model_copy(update=other)
        return await self._carry_out(
            Learn(data=str(self.data()), out=str(self.model(name)), table=table, filters=self.filters)
        )

    async def load(self, name: str) -> Model:
        """The model `name`, read beside the loop. Raises as `read` does."""
        return await asyncio.to_thread(self.read, name)

    def read(self, name: str) -> Model:
        """The model `name`. Raises Refused: there is none, or it cannot be used."""
        path = self.model(name)
        try:
            if path.exists():
                return model_file.read(path)
        except SnapshotError as error:
            raise Refused(str(error)) from error
        except OSError as error:
            raise Refused(f"{path}: cannot be read: {_said(error)}") from error
        raise Refused(f"there is no model '{name}' (models: {', '.join(self.models()) or 'none'})")

    async def _carry_out(self, order: Order) -> dict[str, Value]:
        if self._busy.locked():
            raise Refused("a session is being kept or a model trained already; wait for it")
        async with self._busy:
            return await workshop.in_a_process(order)

    def _folder(self) -> Path:
        if self.folder is None:
            raise Refused("there is no folder for models: give emg.recognition.folder in the config")
        return self.folder


def _said(error: OSError) -> str:
    return error.strerror or str(error)
