"""What docs/learning.md says is so: tables are complete, examples mean something, commands work."""

import os
import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import pytest
from click.testing import CliRunner
from pydantic import BaseModel

from bentod import registry
from bentod.blocking import BlockingClient
from bentod.cli.main import bentod
from bentod.config_file import parse
from bentod.config_learn import Gvf, Learn, RepresentationTable, Tiles
from bentod.furnish import mind_of
from bentod.learn.algorithms.options import Option
from bentod.learn.expression_arguments import ARGUMENTS
from tests.rig import CONFIGS
from tests.system.processes import PATIENCE, DaemonProcess, daemon, eventually

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "learning.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"^```toml\n(.*?)^```", PAGE, flags=re.DOTALL | re.MULTILINE)
COMMANDS = [
    shlex.split(line, comments=True)[1:] for line in re.findall(r"^\$ (.*)$", PAGE, flags=re.MULTILINE)
]


def section(title: str) -> str:
    """The text below a heading."""
    (found,) = re.findall(rf"^## {title}\n(.*?)(?=^## |\Z)", PAGE, flags=re.DOTALL | re.MULTILINE)
    return str(found)


def first_cells(text: str) -> str:
    return "\n".join(line.split("|")[1] for line in text.splitlines() if line.startswith("|"))


@pytest.mark.parametrize("example", EXAMPLES)
def test_every_example_of_a_config_is_one(example: str) -> None:
    text = (CONFIGS / "sim.toml").read_text(encoding="utf-8")
    assert "\n[learn.snapshot]\nevery_s = 60 " in text
    config = parse(text.replace("\n[learn.snapshot]\nevery_s = 60 ", "\n# ") + example, "the page", registry)
    assert config.learn is not None
    assert config.learn.gvfs or config.learn.snapshot
    assert len(mind_of(config).learners.horde.questions) >= 10 + len(config.learn.gvfs)


@pytest.mark.parametrize(
    ("model", "title"),
    [
        (Learn, "Config"),
        (Gvf, "Config"),
        (RepresentationTable, "Representations"),
        (Tiles, "Representations"),
    ],
)
def test_every_key_has_a_line(model: type[BaseModel], title: str) -> None:
    told = first_cells(section(title))
    prefix = "tiles." if model is Tiles else ""
    assert [key for key in model.model_fields if f"`{prefix}{key}`" not in told] == []


@pytest.mark.parametrize(
    "key", ["scaling", "trace_lambda", "step_size", "algorithm", "representation", "interval"]
)
def test_every_default_of_a_question_is_that_of_the_page(key: str) -> None:
    rows = section("Config").partition("| key of `[[learn.gvfs]]` |")[2]
    (told,) = re.findall(rf"^\| `{key}` \| `?([^|`]*)`? \|", rows, flags=re.MULTILINE)
    default = Gvf.model_fields[key].default
    assert told == (f'"{default}"' if isinstance(default, str) else f"{default}")


def test_every_function_and_every_signal_has_a_line() -> None:
    told = first_cells(section("Expressions"))
    assert [name for name in ARGUMENTS if f"`{name}(" not in told] == []
    config = parse((CONFIGS / "sim.toml").read_text(encoding="utf-8"), "sim.toml", registry)
    patterns = re.findall(r"`([^`(]*<[^`]*)`", told)
    shapes = [re.sub(r"<\w+>", r"[\\w-]+", pattern.replace(".", r"\.")) for pattern in patterns]
    learners = mind_of(config).learners
    names = learners.add(Gvf(name="{cumulant}", cumulant="*", timescale=5.0))
    assert len(names) == 41
    assert [name for name in names if not any(re.fullmatch(shape, name) for shape in shapes)] == []


def test_every_algorithm_and_each_of_its_options_has_a_line() -> None:
    text = section("Algorithms")
    assert [name for name in registry.LEARNERS if f"| `{name}` |" not in text] == []
    for name, target in registry.LEARNERS.items():
        module, _, attribute = target.partition(":")
        options: dict[str, Option] = getattr(import_module(module), attribute).OPTIONS
        rows = dict(re.findall(rf"^\| `(\w+)` \| `{name}` \| ([\d.,⁻¹⁰]+) \|", text, flags=re.MULTILINE))
        assert {key: _number(value) for key, value in rows.items()} == {
            key: option.default for key, option in options.items()
        }


def _number(text: str) -> float:
    power = re.fullmatch(r"10⁻¹⁰", text)
    return 1e-10 if power else float(text.replace(",", ""))


def test_every_heading_that_the_page_points_to_is_there() -> None:
    headings = re.findall(r"^#+ (.*)$", PAGE, flags=re.MULTILINE)
    anchors = {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}
    assert [it for it in re.findall(r"\]\(#([^)]*)\)", PAGE) if it not in anchors] == []


def test_whatever_the_page_and_its_neighbours_point_to_exists() -> None:
    for page in (ROOT / "README.md", ROOT / "docs" / "learning.md"):
        links = re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8"))
        assert [link for link in links if not (page.parent / link).exists()] == []
    files = re.findall(r"`((?:bentod|config|sim|docs)/[\w./]+\.\w+)`", PAGE)
    assert len(files) >= 6
    assert [name for name in files if not (ROOT / name).exists()] == []


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where a daemon has run, obeyed all commands of the page, and left a recording and a snapshot."""
    folder = tmp_path_factory.mktemp("page")
    with daemon(folder, "--config", "sim.toml") as process:
        for words in (words for words in COMMANDS if words[0] == "ctl"):
            done = CliRunner().invoke(bentod, ["ctl", "--socket", str(process.socket), *words[1:]])
            assert done.exit_code == 0, (words, done.output)
        _example_from_python(process)
        assert process.ends(signal.SIGTERM) == 0
    return folder


def _example_from_python(process: DaemonProcess) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    with BlockingClient(process.socket) as arm:
        eventually(lambda: arm.call("get_state"))
    code = code.replace("BlockingClient()", f"BlockingClient({str(process.socket)!r})")
    told = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert (told.returncode, told.stdout) == (0, "mine\n"), told.stderr


@pytest.mark.real_time
def test_every_command_about_snapshots_and_recordings_works(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    chosen = [words for words in COMMANDS if words[0] == "learn"]
    assert [words[1] for words in chosen] == ["show", "replay", "replay", "diff", "sweep"]
    outputs = [_told(words, place) for words in chosen]
    assert "questions" in outputs[0]
    assert outputs[1].startswith("Bit for bit what was thought live.")
    assert outputs[2].startswith("Not what was thought live.")
    assert "step size" in outputs[3]
    assert (tmp_path / "sweep" / "sweep.csv").exists()


def _told(words: Sequence[str], place: Path) -> str:
    state = "~/.local/state/"
    there = [word.replace("RECORDING", str(place / "bentod" / "recordings")) for word in words]
    there = [word.replace(state, f"{place}{os.sep}") for word in there]
    more = ["--jobs", "1"] if words[1] == "sweep" else []
    done = CliRunner().invoke(bentod, [*there, *more])
    assert done.exit_code == (1 if words[1] == "diff" else 0), (words, done.output)
    return done.output


def test_every_study_that_the_page_names_can_be_run() -> None:
    listed = CliRunner().invoke(bentod, ["study"]).output.split("\n")
    named = [words[1] for words in COMMANDS if words[0] == "study"]
    assert set(named) <= {line.split()[0] for line in listed if line}


def test_every_config_that_the_page_runs_is_shipped() -> None:
    for words in COMMANDS:
        if words[0] in ("check", "run"):
            assert (ROOT / words[-1]).exists()
    assert {words[0] for words in COMMANDS} == {"ctl", "check", "run", "learn", "study"}
