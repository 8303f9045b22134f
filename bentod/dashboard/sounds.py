"""What the page plays: the same sounds as the voice in the room, made here once and fetched by name."""

import asyncio
from dataclasses import dataclass, field

from bentod.config_sounds import named
from bentod.config_voice import Voice
from bentod.dashboard.own import Own, Stage, Visit, own
from bentod.emg.recognition import REST
from bentod.errors import BadRequest, BentodError, Refused
from bentod.frames import Value
from bentod.voice.render import Renderer, identity
from bentod.voice.settings import joints_of, table_of

KEY = "sounds"
"""Under which the server keeps them."""


@dataclass(frozen=True, slots=True)
class Repertoire:
    """The sounds of one arm, made as one config wants them."""

    table: Voice
    joints: tuple[str, ...]
    names: dict[str, Value] = field(default_factory=dict)  # by event; events that are silent are not there
    wavs: dict[str, bytes] = field(default_factory=dict)  # by name
    making: asyncio.Lock = field(default_factory=asyncio.Lock)

    async def made(self, stage: Stage) -> None:
        """Return once all is there."""
        async with self.making:
            if not self.wavs:
                await asyncio.to_thread(self._make, await _movements(stage))

    def _make(self, movements: list[str]) -> None:
        """`movements`: what a wearer may be asked for."""
        renderer = Renderer(self.table, self.joints)
        for event in (*renderer.events(), *(named("emg.prompt", name) for name in movements)):
            wav = renderer.wav((event,))
            if wav is not None:
                self.names[event] = identity(wav)
                self.wavs[identity(wav)] = wav


async def list_sounds(visit: Visit, params: dict[str, Value]) -> Value:
    """The name of each event's sound; what is silent is left out."""
    repertoire = _repertoire(visit.stage)
    await repertoire.made(visit.stage)
    return repertoire.names


async def get_sound(visit: Visit, params: dict[str, Value]) -> Value:
    """The sound of that name as a WAV file of at most 200 kB.

    Raises:
        BadRequest: there is none of that name.
    """
    repertoire = _repertoire(visit.stage)
    await repertoire.made(visit.stage)
    wav = repertoire.wavs.get(str(params.get("id")))
    if wav is None:
        raise BadRequest("There is no sound of that id; dashboard.sounds names them.", "id")
    return wav


async def _movements(stage: Stage) -> list[str]:
    """Names of the movements that are told apart; none on an arm that tells none apart."""
    try:
        answer = await stage.look("emg_classes", {})
    except BentodError:
        return []
    classes = answer.get("classes") if isinstance(answer, dict) else None
    tables = classes if isinstance(classes, list) else []
    return [REST, *(str(table.get("name")) for table in tables if isinstance(table, dict))]


def _repertoire(stage: Stage) -> Repertoire:
    """That of the daemon that is there. Raises Refused: none is."""
    if stage.knowledge is None:
        raise Refused("The daemon is not there, so nobody knows what its arm sounds like.")
    table, joints = table_of(stage.knowledge.info), joints_of(stage.knowledge.info)
    kept = stage.kept.get(KEY)
    if isinstance(kept, Repertoire) and (kept.table, kept.joints) == (table, joints):
        return kept
    fresh = Repertoire(table, joints)
    stage.kept[KEY] = fresh
    return fresh


METHODS: dict[str, Own] = own(
    observer={"dashboard.sounds": list_sounds, "dashboard.sound": get_sound}, operator={}
)
