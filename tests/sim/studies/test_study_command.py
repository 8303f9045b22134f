"""`bentod study`: what it says and writes, and how it ends."""

import csv
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from sim.studies import command
from sim.studies.catalogue import STUDIES
from sim.studies.study import Claim, Findings, Panel, People, Picture, Setting, Study


def toy(seed: int, minutes: float) -> Findings:
    """A study of a random signal, of which the seed 13 brings no luck."""
    x = np.random.default_rng(seed).random(int(60 * minutes))
    curves = Panel("Noise", {"target": np.round(x), "prediction": x, "ideal": x / 2})
    return Findings(
        (Setting("signal", "<noise>", "the same"),),
        (Claim("Fig. 0", "the seed is not 13", abs(seed - 13.0), "at least", 1),),
        (Picture("0", "Noise: Fig. 0", "Nothing.", np.arange(len(x)) / 1.0, "s", (curves,)),),
        (("from", "NRMSE"), ("noise", "1.000")),
        {"step": np.arange(len(x)) / 1.0, "x": x},
        "Everything is simulated.",
        ("A remark.",),
    )


@pytest.fixture
def toys(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "STUDIES", {"toy": Study("Toy (thesis 0)", "a toy", toy, 1.0, 0.5)})


def run(*arguments: object) -> Result:
    return CliRunner().invoke(command.study, [str(argument) for argument in arguments])


def test_without_a_name_it_lists_what_there_is_to_study() -> None:
    result = run()
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert len(lines) == len(STUDIES)
    for line, (name, study) in zip(lines, STUDIES.items(), strict=True):
        assert line.startswith(name)
        assert study.about in line


@pytest.mark.usefixtures("toys")
def test_it_tells_claims_and_settings_and_what_is_simulated_and_where_it_wrote(tmp_path: Path) -> None:
    result = run("toy", "--out", tmp_path / "deep" / "toy")
    assert result.exit_code == 0, result.output
    for told in ("the seed is not 13", "<noise>", "Everything is simulated.", "1 of 1 claims hold."):
        assert told in result.stdout
    written = sorted((tmp_path / "deep" / "toy").iterdir())
    names = ["claims.csv", "comparison.csv", "figure-0.png", "report.html", "series.csv", "settings.csv"]
    assert [path.name for path in written] == names
    assert all(str(path) in result.stdout for path in written)


@pytest.mark.usefixtures("toys")
def test_a_claim_that_does_not_hold_ends_it_with_1_and_is_marked_everywhere(tmp_path: Path) -> None:
    result = run("toy", "--seed", 13, "--out", tmp_path)
    assert result.exit_code == 1
    assert "0 of 1 claims hold." in result.stdout
    with (tmp_path / "claims.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["holds"] == "NO"
    assert "1 of 1 claims do not hold." in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("toys")
def test_equal_seeds_write_equal_bytes(tmp_path: Path) -> None:
    for folder in ("one", "two"):
        run("toy", "--seed", 7, "--minutes", 2, "--out", tmp_path / folder)
    run("toy", "--seed", 8, "--minutes", 2, "--out", tmp_path / "other")
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes()
    series = [(tmp_path / folder / "series.csv").read_bytes() for folder in ("one", "other")]
    assert series[0] != series[1]


@pytest.mark.usefixtures("toys")
def test_the_report_stands_alone_and_says_how_to_run_it_again(tmp_path: Path) -> None:
    run("toy", "--seed", 7, "--minutes", 2, "--out", tmp_path)
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "bentod study toy --seed 7 --minutes 2" in html
    assert "&lt;noise&gt;" in html
    assert "Everything is simulated." in html
    assert "A remark." in html
    assert "<svg" in html
    assert not re.findall(r'(?:src|href)="(?!#)', html)


@pytest.mark.usefixtures("toys")
def test_a_name_that_is_unknown_is_refused_with_the_nearest() -> None:
    result = run("toi")
    assert result.exit_code == 1
    assert result.stderr == "bentod: there is no study 'toi'; did you mean 'toy'?\n"


@pytest.mark.usefixtures("toys")
@pytest.mark.parametrize("minutes", [0.4, -1, 2000, float("nan")])
def test_a_run_too_short_or_too_long_is_refused(minutes: float, tmp_path: Path) -> None:
    result = run("toy", "--minutes", minutes, "--out", tmp_path / "none")
    assert result.exit_code == 1
    assert "'toy' takes 0.5 to 1000 minutes" in result.stderr
    assert not (tmp_path / "none").exists()


@pytest.mark.usefixtures("toys")
def test_without_matplotlib_it_says_at_once_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for module in [name for name in sys.modules if name in ("sim.studies.report", "sim.studies.figures")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.delitem(sys.modules, "bentod.analysis.drawing", raising=False)
    result = run("toy", "--out", tmp_path / "none")
    assert result.exit_code == 1
    assert "needs the package 'matplotlib'" in result.stderr
    assert "pip install 'bentod[analysis]'" in result.stderr
    assert result.stdout == ""
    assert not (tmp_path / "none").exists()


@pytest.mark.usefixtures("toys")
def test_a_place_that_cannot_be_written_to_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    result = run("toy", "--out", tmp_path / "taken" / "below")
    assert result.exit_code == 1
    assert result.stderr.startswith("bentod: ")
    assert len(result.stderr.splitlines()) == 1


def test_a_value_that_is_no_number_holds_no_claim() -> None:
    assert not Claim("", "", float("nan"), "at most", 1).holds
    assert not Claim("", "", float("nan"), "at least", 1).holds
    assert Claim("", "", 1.0, "at most", 1).holds
    assert Claim("", "", 1.0, "at least", 1).holds


@pytest.mark.usefixtures("toys")
def test_operators_are_refused_where_none_take_part(tmp_path: Path) -> None:
    result = run("toy", "--operators", 3, "--out", tmp_path)
    assert result.exit_code == 1
    assert "no operators take part in 'toy': --operators 3 means nothing" in result.stderr


def test_a_study_of_operators_is_told_who_takes_part_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[People] = []

    def people(seed: int, given: People) -> Findings:
        asked.append(given)
        return toy(seed, 1.0)

    monkeypatch.setattr(command, "STUDIES", {"toy": Study("Toy", "a toy", toy, 0.0, 0.0, people)})
    result = run("toy", "--operators", 3, "--modes", "a,b", "--jobs", 2, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    assert asked == [People(3, None, ("a", "b"), 2)]
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "bentod study toy --seed 1 --operators 3 --modes a,b" in html
    assert run("toy", "--minutes", 5, "--out", tmp_path).exit_code == 1
