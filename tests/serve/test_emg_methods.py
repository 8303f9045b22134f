"""From prompts to a moving arm, as clients see it: collect, train, use, and everything that may go wrong."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from bentod import registry
from bentod.client import Client
from bentod.config import Config
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.emg.live import workshop
from bentod.emg.live.carrying_out import carried_out
from bentod.emg.live.orders import ORDER, Order, written
from bentod.endpoint import RpcError
from bentod.errors import BentodError, Refused
from bentod.frames import Value
from tests.rig import CONFIGS, Table, joint, number, quiet_config, running, state, table, wait_for

BRIEFLY: dict[str, Value] = {"hold_s": 1.0, "rest_s": 1.0, "repetitions": 2}
PAIR: list[Value] = ["wrist_flexion", "pronation"]


@pytest.fixture(autouse=True)
def _in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """In virtual time another process would take hours."""

    async def here(order: Order) -> dict[str, Value]:
        await asyncio.sleep(0.5)
        try:
            return carried_out(ORDER.validate_json(written(order)))
        except BentodError as error:
            raise Refused(str(error)) from error

    monkeypatch.setattr(workshop, "in_a_process", here)


def patterns(folder: Path, *changes: tuple[str, str]) -> Config:
    """The shipped config, quick: without bytes and without learning."""
    text = (CONFIGS / "patterns.toml").read_text()
    text = text[: text.index("# What is learned")].replace('"sim-dynamixel"', '"sim"')
    for old, new in (*changes, ("[emg.recognition]\n", f'[emg.recognition]\nfolder = "{folder}/muscles"\n')):
        assert old in text, old
        text = text.replace(old, new)
    return parse(text, "patterns.toml", registry).model_copy(update={"record": Record(enabled=False)})


@asynccontextmanager
async def recognising(folder: Path, *changes: tuple[str, str]) -> AsyncIterator[Client]:
    async with running(patterns(folder, *changes), folder / "s") as arm:
        yield arm


def recognised(frame: Table) -> Table:
    return table(table(frame["emg"])["recognition"])


async def retrain(arm: Client) -> Table:
    return table(await arm.call("emg_retrain", classes=PAIR, **BRIEFLY))


async def test_retraining_in_one_call_makes_the_arm_obey(tmp_path: Path) -> None:
    async with recognising(tmp_path) as arm:
        before = await state(arm)
        assert "no model yet" in str(recognised(before)["reason"])
        told = await retrain(arm)
        assert table(told["trained"])["accuracy"] == pytest.approx(1.0, abs=0.15)
        assert number(joint(await state(arm), "wrist_flexion"), "position") == pytest.approx(
            number(joint(before, "wrist_flexion"), "position"), abs=0.01
        )
        await wait_for(arm, lambda frame: recognised(frame)["reason"] == "")
        await arm.call("emg_prompt", label="pronation")
        frame = await wait_for(arm, lambda frame: number(joint(frame, "wrist_rotation"), "position") > 0.3)
        assert recognised(frame)["label"] == "pronation"
        assert table(recognised(frame)["probabilities"]).keys() == {"rest", *PAIR}
        assert joint(frame, "wrist_rotation")["holder"] == "emg"
        await arm.call("emg_prompt", label="rest")
        frame = await wait_for(arm, lambda frame: recognised(frame)["label"] == "rest")
        await wait_for(arm, lambda frame: joint(frame, "wrist_rotation")["sent"] == {"kind": "stop"})


async def test_prompts_are_told_as_events_and_new_repetitions_are_added_to_the_old(tmp_path: Path) -> None:
    async with recognising(tmp_path) as arm, arm.listen("events") as events:
        await arm.call("emg_collect", classes=["pronation"], **BRIEFLY)
        texts = []
        async for event in events:
            if event["kind"] == "emg":
                texts.append(event["text"])
            if event["text"] == "Collection is complete.":
                break
        assert texts == [
            "Rest, 1 s.",
            "pronation, 1 s (1 of 2).",
            "Rest, 1 s.",
            "pronation, 1 s (2 of 2).",
            "Rest, 1 s.",
            "Collection is complete.",
        ]
        told = table(await arm.call("emg_collect", classes=["wrist_flexion"], **BRIEFLY))
        assert told["sessions"] == 2
        found = table(table(told["classes"])["wrist_flexion"])
        assert number(found, "over_rest") > 3
        assert found["made"] == [True, True]
        trained = table(await arm.call("emg_train"))
        assert table(trained["windows"]).keys() == {"rest", *PAIR}
        assert (
            table(await arm.call("emg_collect", classes=["pronation"], add=False, **BRIEFLY))["sessions"] == 1
        )


async def test_another_classifier_is_used_at_a_seam_while_the_arm_runs(tmp_path: Path) -> None:
    async with recognising(tmp_path) as arm:
        await retrain(arm)
        await arm.call("emg_train", model="other", classifier="knn")
        assert recognised(await state(arm))["model"] == "model"
        await arm.call("emg_use", model="other")
        assert recognised(await state(arm))["model"] == "other"
        told = table(await arm.call("emg_classes"))
        assert told["models"] == ["model", "other"]
        assert table(told["model"])["classifier"] == "knn"


async def test_a_movement_that_is_no_class_is_not_asked_for(tmp_path: Path) -> None:
    async with recognising(tmp_path) as arm:
        with pytest.raises(RpcError, match="no class 'pronatoin'; did you mean 'pronation'"):
            await arm.call("emg_prompt", label="pronatoin")


async def test_what_was_trained_is_used_at_the_next_start(tmp_path: Path) -> None:
    async with recognising(tmp_path) as arm:
        await retrain(arm)
    async with recognising(tmp_path) as arm:
        assert recognised(await state(arm))["model"] == "model"
    async with recognising(tmp_path, ("window_s = 0.15", "window_s = 0.2")) as arm:
        reason = str(recognised(await state(arm))["reason"])
        assert reason.startswith("The model model cannot be used: The model's window is 150 samples; here")
        with pytest.raises(RpcError, match="window is 150 samples"):
            await arm.call("emg_use")
    (tmp_path / "muscles" / "model.model").write_bytes(b"garbage")
    async with recognising(tmp_path) as arm:
        assert "this is no model of muscle signals" in str(recognised(await state(arm))["reason"])


async def test_a_folder_that_cannot_be_looked_into_keeps_no_arm_from_running(tmp_path: Path) -> None:
    async with running(patterns(tmp_path / ("x" * 300)), tmp_path / "s") as arm:
        assert "File name too long" in str(recognised(await state(arm))["reason"])
        with pytest.raises(RpcError, match=r"nothing can be kept in .*File name too long"):
            await arm.call("emg_collect", **BRIEFLY)


@pytest.mark.parametrize(
    ("method", "named"),
    [
        ("stop", {}),
        ("pause", {}),
        ("pause", {"joints": "gripper"}),
        ("emg_pause", {"on": True}),
        ("torque", {"on": False}),
    ],
)
async def test_whatever_stops_the_arm_ends_a_collection_and_nothing_is_kept(
    tmp_path: Path, method: str, named: dict[str, Value]
) -> None:
    async with recognising(tmp_path) as arm:
        collecting = asyncio.create_task(arm.call("emg_collect", **BRIEFLY))
        await asyncio.sleep(1.5)
        assert recognised(await state(arm))["prompted"] == "wrist_flexion"
        await arm.call(method, **named)
        with pytest.raises(RpcError, match="nothing was kept"):
            await collecting
        assert recognised(await state(arm))["prompted"] == ""
        assert not (tmp_path / "muscles" / "training.npz").exists()


async def test_a_client_that_leaves_ends_its_collection(tmp_path: Path) -> None:
    async with recognising(tmp_path) as arm:
        async with Client.connect(tmp_path / "s") as other:
            collecting = asyncio.create_task(other.call("emg_collect", **BRIEFLY))
            await asyncio.sleep(1.5)
            with pytest.raises(RpcError, match="being collected already"):
                await arm.call("emg_collect", **BRIEFLY)
        with pytest.raises(BentodError):
            await collecting
        await wait_for(arm, lambda frame: recognised(frame)["prompted"] == "")
        assert not table(await arm.call("emg_classes"))["collecting"]


async def test_nothing_moves_by_muscles_during_a_collection_and_they_rest_before_they_move_again(
    tmp_path: Path,
) -> None:
    async with recognising(tmp_path) as arm:
        await retrain(arm)
        before = joint(await state(arm), "wrist_rotation")["position"]
        await arm.call("emg_collect", classes=["pronation"], **BRIEFLY)
        frame = await state(arm)
        assert joint(frame, "wrist_rotation")["position"] == pytest.approx(before, abs=0.01)


async def test_a_lease_of_a_client_comes_first_and_the_wearer_rests_before_going_on(tmp_path: Path) -> None:
    async with recognising(tmp_path) as arm:
        await retrain(arm)
        await wait_for(arm, lambda frame: recognised(frame)["reason"] == "")
        await arm.call("emg_prompt", label="pronation")
        await wait_for(arm, lambda frame: joint(frame, "wrist_rotation")["holder"] == "emg")
        await arm.call("move", joint="wrist_rotation", velocity=-0.2, lease_s=0.5)
        await wait_for(arm, lambda frame: str(joint(frame, "wrist_rotation")["holder"]).startswith("client"))
        await asyncio.sleep(1.5)
        frame = await state(arm)
        assert recognised(frame)["label"] == "pronation"
        assert joint(frame, "wrist_rotation")["holder"] == ""
        await arm.call("emg_prompt", label="rest")
        await wait_for(arm, lambda frame: recognised(frame)["label"] == "rest")
        await arm.call("emg_prompt", label="pronation")
        await wait_for(arm, lambda frame: joint(frame, "wrist_rotation")["holder"] == "emg")


@pytest.mark.parametrize(
    ("method", "named", "sentence"),
    [
        ("emg_collect", {"classes": ["fist"]}, "there is no class 'fist'"),
        ("emg_train", {}, "nothing has been collected yet"),
        ("emg_train", {"classifier": "magic"}, "there is no such classifier"),
        ("emg_use", {}, "there is no model 'model'"),
        ("emg_use", {"model": "../../etc/passwd"}, "letters, figures and _ only"),
    ],
)
async def test_what_cannot_be_is_refused_with_a_sentence(
    tmp_path: Path, method: str, named: dict[str, Value], sentence: str
) -> None:
    async with recognising(tmp_path) as arm:
        with pytest.raises(RpcError, match=sentence):
            await arm.call(method, **named)


async def test_an_arm_that_recognises_nothing_says_so(tmp_path: Path) -> None:
    async with running(quiet_config(('"sim-dynamixel"', '"sim"')), tmp_path / "s") as arm:
        for method in ("emg_classes", "emg_collect", "emg_train", "emg_use", "emg_retrain"):
            with pytest.raises(RpcError, match=r"no \[emg.recognition\] table"):
                await arm.call(method)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "moves = { wrist_flexion = 1.0 }",
            "moves = { elbow_flexion = 1.0 }",
            "hand has no joint 'elbow_fle",
        ),
        ('group = "hand"', 'group = "hnad"', "there is no group 'hnad'; did you mean 'hand'"),
        ("moves = { wrist_flexion = 1.0 }", "moves = { wrist_flexion = 0 }", "is 0: leave it out"),
        ("votes = 3", "votes = 4", "it must be odd"),
        ('name = "pronation"', 'name = "rest"', "'rest' is there by itself"),
        ('name = "pronation"', 'name = "supination"', "'supination' stands 2 times"),
    ],
)
def test_a_config_that_makes_no_sense_is_told(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    with pytest.raises(BentodError, match=sentence):
        patterns(tmp_path, (old, new))
