"""From tables of the config, each of which may stand for a family, to questions with names of their own."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TypeAlias

from bentod.config_learn import ARM, Gvf, Learn
from bentod.errors import ConfigError, nearest
from bentod.frames import JointSpec
from bentod.learn.advice import guess
from bentod.learn.expression import Expression, Vocabulary
from bentod.learn.expression_nodes import name_text
from bentod.learn.question import Estimates, Question
from bentod.learn.returns import discount
from bentod.learn.signals import Named, starred

MOST = 65_536
"""Questions that a config may ask."""

_NAME = re.compile(r"[a-zA-Z][a-zA-Z0-9_.@-]{0,127}")
_HOLDERS = ("cumulant", "timescale")
_Horizon: TypeAlias = tuple[str, float | str]
"""What stands for {timescale} in a name, and γ."""


def expand(learn: Learn, specs: Sequence[JointSpec], signals: Named, rate_hz: float) -> tuple[Question, ...]:
    """All questions of a config: those about the arm itself, then those of `learn.gvfs`, in order.

    Raises:
        ConfigError: a table is wrong, or two questions have the same name; says which table and key.
    """
    known = [*([ARM] if learn.joints else []), *(table.name for table in learn.representations)]
    if learn.joints and learn.representation not in known:
        hint = nearest(learn.representation, known)
        raise ConfigError(f"learn.representation: there is no '{learn.representation}'{hint}")
    tables: list[tuple[str, Sequence[Question]]] = [
        ("learn.timescales", about_the_arm(learn, specs, signals))
    ]
    for number, table in enumerate(learn.gvfs):
        where = f"learn.gvfs.{number}"
        if table.representation not in known:
            hint = nearest(table.representation, known) if known else ": without joints there is none"
            raise ConfigError(f"{where}.representation: there is no '{table.representation}'{hint}")
        tables.append((where, questions_of(table, signals, rate_hz, where)))
    questions = _all(tables)
    vocabulary = Vocabulary(signals, learn.define).asking([question.name for question in questions])
    for where, family in tables:
        for question in family:
            _check(question, vocabulary, where)
    return questions


def about_the_arm(learn: Learn, specs: Sequence[JointSpec], signals: Named) -> tuple[Question, ...]:
    """Where each of its joints will be, thesis 5.3: R = (1 − γ) θ, at first the joint's minimum.

    With `learn.adviser` it is at first what that says. Raises ConfigError: it cannot.
    """
    if not learn.joints:
        return ()
    named = {spec.name: spec for spec in specs}
    asked = [named[name] for name in learn.predict or named]
    return tuple(
        Question(
            name=f"{spec.name}.position@{timescale:g}",
            cumulant=name_text(f"{spec.name}.position"),
            gamma=discount(timescale),
            scaled=True,
            lam=learn.trace_lambda,
            step_size=learn.step_size,
            algorithm="true_online",
            representation=learn.representation,
            initial=0.0 if learn.adviser else spec.minimum,
            estimates=Estimates(confidence_range=spec.maximum - spec.minimum),
            guess=guess(signals, learn.adviser, f"{spec.name}.position@{timescale:g}"),
        )
        for timescale in learn.timescales
        for spec in asked
    )


def questions_of(
    table: Gvf, signals: Named, rate_hz: float, where: str = "gvf", most: int = MOST
) -> tuple[Question, ...]:
    """The questions that one table stands for: each cumulant at each timescale, each with its companion.

    `where`: the table's place in the config. `most`: of these, companions not counted. Whether
    expressions are such is not looked at here.

    Raises:
        ConfigError: a name does not fit, or a timescale is shorter than a tick.
    """
    if not isinstance(table.cumulant, str) and len(table.cumulant) > most:
        raise ConfigError(f"{where}.cumulant: {len(table.cumulant)} are more than {most}")
    cumulants = _cumulants(table, signals, where)
    horizons = _horizons(table, rate_hz, where)
    family: list[Question] = []
    for (label, cumulant), (scale, gamma) in _products(table, cumulants, horizons, where, most):
        name = table.name.replace("{cumulant}", label).replace("{timescale}", scale)
        if not _NAME.fullmatch(name):
            raise ConfigError(
                f"{where}.name: {name[:140]!r} is no name: give the cumulant one in learn.define, "
                "of letters, digits and _.@- (at most 128 characters in all)"
            )
        question = _question(table, name, cumulant, gamma, _guess(table, name, signals, where))
        family += [question, _variance(question)] if table.variance else [question]
    return _all([(where, family)])


def _guess(table: Gvf, name: str, signals: Named, where: str) -> str:
    try:
        return guess(signals, table.adviser, name)
    except ConfigError as error:
        raise ConfigError(f"{where}.adviser: {error}") from None


def _question(table: Gvf, name: str, cumulant: str, gamma: float | str, guess: str) -> Question:
    return Question(
        name=name,
        cumulant=cumulant,
        gamma=gamma,
        scaled=table.scaling == "instantaneous",
        lam=table.trace_lambda,
        step_size=table.step_size,
        algorithm=table.algorithm,
        representation=table.representation,
        policy=table.policy or "",
        initial=0.0 if guess else table.initial,
        options=dict(table.options),
        estimates=Estimates(table.confidence, table.confidence_range, table.interval, table.variance),
        guess=guess,
    )


def _variance(question: Question) -> Question:
    """The companion that learns the variance of the λ-return, from δ² and with γ̄ = (γλ)².

    After Sherstan et al., "Comparing Direct and Indirect Temporal-Difference Methods for Estimating the
    Variance of the Return", UAI 2018.
    """
    gamma, lam = question.gamma, question.lam
    squared = f"square(clip({gamma}, 0, 1) * {lam!r})" if isinstance(gamma, str) else (gamma * lam) ** 2
    return replace(
        question,
        name=f"{question.name}.variance",
        cumulant=f'delta2("{question.name}")',
        gamma=squared,
        scaled=False,
        initial=0.0,
        estimates=Estimates(confidence=False),
        guess="",
    )


def _cumulants(table: Gvf, signals: Named, where: str) -> list[tuple[str, str]]:
    """What stands for {cumulant} in a name, and the expression."""
    texts = (table.cumulant,) if isinstance(table.cumulant, str) else table.cumulant
    found: list[tuple[str, str]] = []
    for written in texts:
        try:
            names = starred(written.strip(), signals.names)
        except ConfigError as error:
            raise ConfigError(f"{where}.cumulant: {error}") from None
        known = names != (written.strip(),)
        found += [(name, name_text(name) if known else name) for name in names]
    return found


def _horizons(table: Gvf, rate_hz: float, where: str) -> list[_Horizon]:
    if table.gamma is not None:
        if table.gamma == 1 and table.scaling == "instantaneous":
            raise ConfigError(
                f"{where}.gamma = 1: multiplies the cumulant by 1 − γ = 0; say scaling = 'cumulative'"
            )
        return [("", table.gamma)]
    if table.timescale is not None:
        return [(f"{ticks:g}", discount(ticks)) for ticks in _several(table.timescale)]
    seconds = _several(table.timescale_s or ())
    for time in seconds:
        if time * rate_hz < 1:
            raise ConfigError(
                f"{where}.timescale_s = {time:g}: is {time * rate_hz:g} ticks at {rate_hz:g} Hz, and must be "
                f"at least 1 (from {math.ceil(1e4 / rate_hz) / 1e4:g} s on)"
            )
    return [(f"{time:g}s", discount(time * rate_hz)) for time in seconds]


def _several(value: float | tuple[float, ...]) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)


def _products(
    table: Gvf, cumulants: Sequence[tuple[str, str]], horizons: Sequence[_Horizon], where: str, most: int
) -> Iterator[tuple[tuple[str, str], _Horizon]]:
    """Every cumulant at every horizon. Raises ConfigError: the name cannot tell them apart."""
    holders = re.findall(r"\{([^{}]*)\}", table.name)
    for holder in holders:
        if holder not in _HOLDERS:
            raise ConfigError(f"{where}.name: unknown placeholder '{{{holder}}}'{nearest(holder, _HOLDERS)}")
    if "timescale" in holders and table.gamma is not None:
        raise ConfigError(f"{where}.name: {{timescale}} stands for nothing, because gamma is given")
    for holder, many in zip(_HOLDERS, (cumulants, horizons), strict=True):
        if len(many) > 1 and holder not in holders:
            raise ConfigError(f"{where}.name: needs {{{holder}}}, because there are {len(many)} of them")
    if len(cumulants) * len(horizons) > most:
        raise ConfigError(f"{where}: {len(cumulants) * len(horizons)} questions are more than {most}")
    return ((cumulant, horizon) for horizon in horizons for cumulant in cumulants)


def _check(question: Question, vocabulary: Vocabulary, where: str) -> None:
    texts = {"cumulant": question.cumulant, "gamma": question.gamma, "policy": question.policy}
    for key, text in texts.items():
        if isinstance(text, str) and text:
            try:
                Expression.parse(text, vocabulary)
            except ConfigError as error:
                raise ConfigError(f"{where}.{key}: {error}") from None


def _all(tables: Sequence[tuple[str, Sequence[Question]]]) -> tuple[Question, ...]:
    """The questions of all tables. Raises ConfigError: a name is given twice, or there are too many."""
    found: dict[str, str] = {}
    for where, questions in tables:
        for question in questions:
            if question.name in found:
                raise ConfigError(
                    f"{where}: the question '{question.name}' is asked twice, first by {found[question.name]}"
                )
            found[question.name] = where
    if len(found) > MOST:
        raise ConfigError(f"learn.gvfs: {len(found)} questions are more than {MOST}")
    return tuple(question for _, questions in tables for question in questions)
