"""What a config has learned, in sentences: questions in the order of learning, representations, snapshots."""

from collections.abc import Iterator, Mapping, Sequence

from bentod.config import Config
from bentod.learn.encoder import Encoder
from bentod.learn.predictor import Predictor
from bentod.learn.question import Question
from bentod.learned import snapshot_path

_NAMED = 4
"""Questions that are named of those that are learned in one go."""


def sentences(config: Config, learners: Predictor, name: str, environment: Mapping[str, str]) -> list[str]:
    """What `learners`, which are those of `config`, learn; `name`: of the config."""
    horde = learners.horde
    precision = config.learn.precision if config.learn else ""
    units = [[horde.questions[place] for place in unit.places.tolist()] for unit in horde.units]
    lines = [
        f"{len(horde.questions)} GVFs learn with the kernel {learners.kernel}, in {precision}. "
        "What the assist follows comes first, then in this order:"
    ]
    lines += [f"  {_asked(unit, config.rate_hz)}" for unit in units]
    lines += _representations(horde.encoders, horde.questions)
    return [*lines, _kept(config, name, environment)]


def _asked(unit: Sequence[Question], rate_hz: float) -> str:
    first, more = unit[0], len(unit) - _NAMED
    names = ", ".join(question.name for question in unit[:_NAMED]) + (f" and {more} more" if more > 0 else "")
    how = f"{_ahead(first.gamma, rate_hz)}, λ {first.lam:g}, {first.algorithm} over {first.representation}"
    return f"{how}: {names}"


def _ahead(gamma: float | str, rate_hz: float) -> str:
    if isinstance(gamma, str):
        return f"γ = {gamma}"
    if gamma == 1:
        return "γ 1"
    return f"{1 / (1 - gamma):.4g} ticks ahead ({1 / (1 - gamma) / rate_hz:.2g} s)"


def _representations(encoders: Mapping[str, Encoder], questions: Sequence[Question]) -> Iterator[str]:
    for name, encoder in encoders.items():
        coding = encoder.coding
        active = f"{coding.active:g} active at most" if coding.binary else "some of them real numbers"
        users = sum(question.representation == name for question in questions)
        yield f"Representation {name}: {coding.size} features, {active}, for {users} GVFs."


def _kept(config: Config, name: str, environment: Mapping[str, str]) -> str:
    table = config.learn.snapshot if config.learn else None
    path = snapshot_path(table, name, environment) if table else None
    if table is None or path is None:
        return "What is learned is forgotten at the end: there is no [learn.snapshot] table."
    return f"What is learned is kept in {path}, every {table.every_s:g} s and at the end."
