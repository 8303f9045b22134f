import json
from collections.abc import Mapping

import pytest

from bentod.lateness.report import Report
from bentod.lateness.ticking import Ticks
from bentod.lateness.trial import CLOCK, DAEMON, SLEEP, Case, Round, cases, trial, undisturbed

EARLY, LATE = Ticks((50e-6,) * 2000, 0), Ticks((50e-6,) * 1990 + (3e-3,) * 10, 0)


def report(found: Mapping[Case, Ticks], *stolen: float, busy: float = 0.0) -> Report:
    machine: dict[str, str | int] = {"cpu": "a cpu", "cores": 2, "kernel": "a kernel", "python": "3"}
    rounds = [Round(share, found) for share in stolen or (0.0,)]
    return Report(machine, "normal, on core 0, 1", busy, rounds)


def told(found: Mapping[Case, Ticks], *stolen: float, busy: float = 0.0) -> str:
    return "\n".join(report(found, *stolen, busy=busy).lines())


def test_rates_that_begin_on_time_are_safe_and_others_are_not() -> None:
    found = {Case(DAEMON, 30.0, False): EARLY, Case(DAEMON, 200.0, False): LATE}
    assert report(found).verdict() == (
        "30 Hz is safe here, 200 Hz is not safe here (idle, one tick in a thousand is 3 ms late or more)."
    )


def test_one_missed_tick_is_too_many() -> None:
    found = {Case(DAEMON, 30.0, False): EARLY, Case(DAEMON, 30.0, True): Ticks(EARLY.late, 1)}
    assert report(found).verdict() == "30 Hz is not safe here (under load, a tick was missed)."


def test_a_naive_sleep_says_nothing_about_the_machine() -> None:
    found = {Case(CLOCK, 1000.0, False): EARLY, Case(SLEEP, 1000.0, False): LATE}
    assert report(found).verdict() == "1000 Hz is safe here."


def test_the_clock_alone_does_not_speak_for_a_rate_that_has_a_daemon() -> None:
    found = {Case(DAEMON, 200.0, False): EARLY, Case(CLOCK, 200.0, False): LATE}
    assert report(found).verdict() == "200 Hz is safe here."


def test_few_ticks_are_said_to_be_few() -> None:
    assert "Measure longer" in told({Case(CLOCK, 30.0, False): Ticks((1e-6,) * 10, 0)})
    assert "Measure longer" not in told({Case(CLOCK, 30.0, False): EARLY})


def test_other_programs_and_the_host_are_named_as_culprits() -> None:
    text = told({Case(CLOCK, 30.0, False): EARLY}, 0.0, 0.0, 0.0, 0.2, busy=2.5)
    assert "load average 2.5" in text
    assert "1 of 4 rounds were disturbed by the host" in text
    assert "took up to 20.0%" in told({Case(CLOCK, 30.0, False): EARLY}, 0.2)


def test_programs_get_plain_data_that_adds_up() -> None:
    data = json.loads(json.dumps(report({Case(DAEMON, 30.0, True): LATE}, 0.0, 0.0).data()))
    (run,) = data["runs"]
    assert sum(run["counts"]) == run["ticks"] == 2 * len(LATE.late)
    assert len(run["counts"]) == len(data["edges_s"]) + 1
    assert run["late_s"]["max"] == pytest.approx(3e-3)


def test_no_daemon_is_measured_faster_than_a_config_allows() -> None:
    found = cases([DAEMON, CLOCK], [30.0, 1000.0], [False, True])
    assert {case.rate_hz for case in found if case.way == DAEMON} == {30.0}
    assert {case.rate_hz for case in found if case.way == CLOCK} == {30.0, 1000.0}


def test_cases_take_turns_and_each_round_begins_with_another() -> None:
    order: list[str] = []
    three = [Case(name, 30.0, False) for name in "abc"]
    trial({case: lambda: EARLY for case in three}, order.append, rounds=3)
    assert [told[0] for told in order] == list("abcbcacab")


def test_disturbed_rounds_are_left_out_unless_hardly_any_would_be_left() -> None:
    found = {Case(CLOCK, 30.0, False): EARLY}
    calm, disturbed = Round(0.0, found), Round(0.1, found)
    assert undisturbed([calm, disturbed, calm, calm]) == [calm] * 3
    assert undisturbed([calm, disturbed, calm]) == [calm, disturbed, calm]
