"""The page of a session: whole, alone, the same each time, and with the right numbers."""

import json
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from bentod.analysis.material import gather
from bentod.analysis.report import FIGURE_TITLES, FIGURES, plot, report
from bentod.analysis.stream import UnfitRecording
from bentod.cli import recording as command
from bentod.errors import BadRequest
from bentod.frames import Event, Trial
from bentod.record.reader import Recording
from bentod.record.session import Entry, Header
from tests.analysis.helpers import CONDITIONS, frames, header, record, recorded, session, ticks


class Page(HTMLParser):
    """What a page holds, by element."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.addresses: list[str] = []
        self.tags: Counter[str] = Counter()
        self.open: list[str] = []
        self.tables: dict[str, list[list[str]]] = {}
        self.data: dict[str, Any] = {}
        self._table = self._script = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.tags[tag] += 1
        self.open.append(tag)
        self.ids += [given["id"] or ""] if "id" in given else []
        self.links += [given["href"] or ""] if tag == "a" else []
        for key in ("src", "href", "xlink:href", "data", "action", "srcset"):
            if tag != "a" and key in given:
                self.addresses.append(given[key] or "")
        if tag == "table":
            self._table = given.get("id") or ""
            self.tables[self._table] = []
        elif tag == "tr":
            self.tables[self._table].append([])
        elif tag in ("td", "th"):
            self.tables[self._table][-1].append("")
        elif tag == "script":
            assert given["type"] == "application/json"
            self._script = given["id"] or ""

    def handle_endtag(self, tag: str) -> None:
        self.open.pop()

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("td", "th"):
            self.tables[self._table][-1][-1] += data
        elif self.open and self.open[-1] == "script":
            self.data[self._script] = json.loads(data)


def made(folder: Path, entries: Sequence[Entry], about: Header | None = None) -> str:
    with Recording(record(folder, entries, about)) as recording:
        return report(recording)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded(tmp_path_factory.getbasetemp())


@pytest.fixture(scope="module")
def text(file: Path) -> str:
    with Recording(file) as recording:
        return report(recording)


@pytest.fixture(scope="module")
def page(text: str) -> Page:
    return Page(text)


def test_every_entry_of_the_contents_leads_somewhere_and_no_place_has_two_names(page: Page) -> None:
    assert len(page.links) > 12
    assert {link.removeprefix("#") for link in page.links} <= set(page.ids)
    assert [name for name, count in Counter(page.ids).items() if count > 1] == []


def test_the_page_asks_nobody_for_anything(page: Page, text: str) -> None:
    assert [address for address in page.addresses if not address.startswith("#")] == []
    assert not re.search(r"url\((?!#)|@import", text)
    assert "default-src 'none'" in text


def test_every_figure_is_drawn_with_a_caption_and_its_numbers(page: Page) -> None:
    assert page.tags["svg"] == page.tags["figure"] == page.tags["figcaption"] == len(FIGURES)
    assert set(page.data) == {f"numbers-{name}" for name in FIGURES}


def test_two_runs_make_the_same_page(text: str, file: Path) -> None:
    with Recording(file) as recording:
        assert report(recording) == text


def test_the_numbers_of_the_paths_are_those_of_the_frames(page: Page) -> None:
    for at, name in enumerate(("shoulder_rotation", "elbow_flexion")):
        positions = np.array([frame.joints[at].position for frame in frames(session())])
        told = page.data["numbers-joints"][name]
        assert told["min_rad"] == positions.min()
        assert told["max_rad"] == positions.max()
        assert told["travel_rad"] == pytest.approx(np.abs(np.diff(positions)).sum())


def test_the_way_of_a_joint_is_shared_out_completely(page: Page) -> None:
    ways = page.data["numbers-holders"]["way_rad"]["elbow_flexion"]
    assert {"emg", "assist", "home"} <= set(ways)
    assert sum(ways.values()) == pytest.approx(page.data["numbers-joints"]["elbow_flexion"]["travel_rad"])


def test_trials_are_listed_and_drawn(page: Page) -> None:
    head, *rows = page.tables["circuits-table"]
    assert [row[head.index("condition")] for row in rows] == list(CONDITIONS)
    assert [int(row[head.index("toggles")]) for row in rows] == page.data["numbers-trials"]["toggles"]
    assert {row[head.index("contacts")] for row in rows} == {"not recorded"}
    assert [row[2] for row in page.tables["trials-table"][1:]] == ["toggling", "dpcc"]


def test_learning_makes_the_predictions_better(page: Page) -> None:
    series = [v for v in page.data["numbers-learning"]["rms_rad"]["shoulder_rotation.10"] if v is not None]
    assert np.mean(series[-8:-3]) < np.mean(series[:3])
    assert page.data["numbers-predictions"]["rms_rad"]["shoulder_rotation"]["10"] < 0.5


def test_the_fault_is_told_when_and_why(page: Page) -> None:
    rows = page.tables["events-table"][1:]
    faults = [event for event in session() if isinstance(event, Event) and event.kind == "fault"]
    assert [row[2] for row in rows if row[1] == "fault"] == [event.text for event in faults]
    counted = Counter(event.kind for event in session() if isinstance(event, Event))
    assert page.data["numbers-timeline"]["events"] == dict(counted)


def test_nothing_is_missing_from_a_whole_recording_and_the_page_says_so(page: Page, text: str) -> None:
    rows = {row[0]: row[1:] for row in page.tables["completeness-table"][1:]}
    count = str(len(frames(session())))
    assert rows["ticks"][:3] == [count, count, "0"]
    assert "nothing that is known" in text


def test_missing_ticks_are_told_with_their_time(tmp_path: Path) -> None:
    some = [frame for frame in ticks(90) if frame.tick not in range(40, 45)]
    found = made(tmp_path, some)
    page = Page(found)
    assert {row[0]: row[3] for row in page.tables["completeness-table"][1:]}["ticks"] == "5"
    assert page.tables["gaps-table"][1][3] == "5"
    assert "Missing: 5 ticks" in found


def test_what_there_is_not_is_said_and_not_drawn(tmp_path: Path) -> None:
    page = Page(found := made(tmp_path, ticks(90)))
    assert "There is no trial in this recording." in found
    assert "holds no EMG" in found
    assert {"numbers-emg", "numbers-trials"}.isdisjoint(page.data)
    assert "figure-emg" in page.ids


def test_a_single_tick_makes_a_page(tmp_path: Path) -> None:
    assert "numbers-joints" in Page(made(tmp_path, ticks(1))).data


def test_names_from_outside_stay_text(tmp_path: Path) -> None:
    name = '<script>alert("1")</script> $\\frac{1}$ 右'
    entries: list[Entry] = [
        replace(frame, trial=Trial(1, name, name, 100.0) if frame.tick < 60 else None, meta={name: name})
        for frame in ticks(90)
    ]
    entries.append(Event(101.0, "fault", name, {}))
    page = Page(made(tmp_path, entries, replace(header(entries), arm=name, config=name)))
    assert page.tables["events-table"][1][2] == name
    assert page.tables["circuits-table"][1][1] == name
    assert page.tags["script"] == len(page.data)


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_figure_is_written_as_its_name_says_and_the_same_each_time(tmp_path: Path, kind: str) -> None:
    with Recording(record(tmp_path, ticks(30))) as recording:
        for name in ("one", "two"):
            plot(recording, "holders", tmp_path / f"{name}.{kind}")
    begin = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[kind]
    assert (tmp_path / f"one.{kind}").read_bytes().startswith(begin)
    assert (tmp_path / f"one.{kind}").read_bytes() == (tmp_path / f"two.{kind}").read_bytes()


def test_a_curve_in_a_figure_goes_through_the_recorded_points(tmp_path: Path) -> None:
    some = [
        replace(frame, joints=(replace(frame.joints[0], position=float(frame.tick == 5)), *frame.joints[1:]))
        for frame in ticks(12)
    ]
    with Recording(record(tmp_path, some)) as recording:
        plot(recording, "joints", tmp_path / "figure.svg")
    tree = ElementTree.parse(tmp_path / "figure.svg")  # noqa: S314 -- our own
    (group,) = [e for e in tree.iter() if e.get("id") == "joints.shoulder_rotation"]
    drawn = "".join(e.get("d", "") for e in group.iter())
    points = [tuple(map(float, pair)) for pair in re.findall(r"[ML] (-?[\d.]+) (-?[\d.]+)", drawn)]
    heights = [y for _, y in points]
    assert len(set(heights)) == 2
    assert points[heights.index(min(heights))][0] == pytest.approx(
        points[0][0] + 5 / 11 * (points[-1][0] - points[0][0]), rel=1e-3
    )


def test_only_the_chosen_stretch_is_drawn(file: Path, tmp_path: Path) -> None:
    with Recording(file) as recording:
        found = gather(recording, 20.0, 30.0)
        with pytest.raises(UnfitRecording, match=r"holds no tick from 5000 s to the end"):
            plot(recording, "joints", tmp_path / "x.svg", 5000.0)
    assert found.time[0] == pytest.approx(20.0, abs=0.034)
    assert found.time[-1] == pytest.approx(30.0, abs=0.034)
    assert found.events


def test_a_kind_of_file_or_figure_that_there_is_not_is_told(tmp_path: Path) -> None:
    with Recording(record(tmp_path, ticks(5))) as recording:
        with pytest.raises(BadRequest, match=r"\.svg, \.pdf, \.png, not 'x.jpg'"):
            plot(recording, "joints", tmp_path / "x.jpg")
        with pytest.raises(BadRequest, match="did you mean 'holders'"):
            plot(recording, "holder", tmp_path / "x.svg")


def test_the_command_offers_what_can_be_drawn() -> None:
    assert tuple(FIGURES) == command.FIGURES
    assert set(FIGURE_TITLES) == set(FIGURES)
