"""What the page's server makes of events: the same sounds as the voice in the room."""

from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from bentod.config_voice import Voice
from bentod.dashboard.arm_link import Knowledge
from bentod.dashboard.own import Stage
from bentod.dashboard.sounds import get_sound, list_sounds
from bentod.errors import BadRequest, Refused
from bentod.frames import Value
from bentod.voice.render import Renderer

JOINTS = ("shoulder", "elbow")


class Visit:
    """A browser that looks, and what it shares."""

    role = "observer"

    def __init__(self, voice: Voice | None) -> None:
        info: Value = (
            {"voice": voice.describe(), "joints": [{"name": name} for name in JOINTS]} if voice else None
        )
        self.told: dict[str, Value] = {}
        self.watchers: list[Callable[[dict[str, Value]], None]] = []
        self.hearers: list[Callable[[dict[str, Value]], None]] = []
        self.knowledge = Knowledge(info, [], "observer") if voice else None
        self.kept: dict[str, object] = {}
        self.classes: list[str] | None = None

    @property
    def stage(self) -> Stage:
        return self

    async def look(self, method: str, params: dict[str, Value]) -> Value:
        assert method == "emg_classes"
        if self.classes is None:
            raise Refused("the config has no [emg.recognition] table")
        return {"classes": [{"name": name} for name in self.classes]}

    async def act(self, method: str, params: dict[str, Value]) -> Value:
        raise AssertionError(method)

    def later(self, errand: Callable[[], Awaitable[None]]) -> bool:
        raise AssertionError("nothing is to be done later")

    def on_leave(self, farewell: Callable[[], Awaitable[None]]) -> None:
        raise AssertionError("nothing is to be put away")

    def stats(self) -> Value:
        return None


@pytest.fixture(autouse=True)
def _no_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


async def test_every_event_that_is_heard_has_a_sound_and_it_is_that_of_the_voice() -> None:
    visit = Visit(Voice(sounds={"pause": "none"}))
    names = await list_sounds(visit, {})
    assert isinstance(names, dict)
    assert {"joint.shoulder", "joint.elbow", "fault", "mark.waypoint_held"} <= names.keys()
    assert not {"pause", "mark", "mark.waypoint_left"} & names.keys()
    renderer = Renderer(Voice(), JOINTS)
    for event, name in names.items():
        wav = await get_sound(visit, {"id": name})
        assert wav == renderer.wav((event,))
        assert isinstance(wav, bytes)
        assert len(wav) <= 200_000


async def test_every_movement_that_may_be_asked_for_has_a_sound_of_its_own() -> None:
    visit = Visit(Voice())
    visit.classes = ["hand_open", "hand_close"]
    names = await list_sounds(visit, {})
    assert isinstance(names, dict)
    prompts = [name for event, name in names.items() if event.startswith("emg.prompt.")]
    assert len(prompts) == len(set(map(str, prompts))) == 3  # to rest is one


async def test_another_arm_sounds_like_itself() -> None:
    visit = Visit(Voice())
    first = await list_sounds(visit, {})
    visit.knowledge = Visit(Voice(volume=0.1)).knowledge
    assert await list_sounds(visit, {}) != first


@pytest.mark.parametrize("params", [{}, {"id": None}, {"id": "../../etc/passwd"}, {"id": ["a"]}])
async def test_a_sound_that_there_is_not_is_refused(params: dict[str, Value]) -> None:
    with pytest.raises(BadRequest, match="no sound of that id"):
        await get_sound(Visit(Voice()), params)


async def test_without_a_daemon_nobody_knows_how_it_sounds() -> None:
    with pytest.raises(Refused, match="daemon is not there"):
        await list_sounds(Visit(None), {})
