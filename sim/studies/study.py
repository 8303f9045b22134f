"""What a study is, and what it finds: claims that hold or do not, the settings, and pictures as data."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from bentod.contracts import Vector

RATE_HZ = 30
"""Time steps a second (thesis 4.5.1)."""


@dataclass(frozen=True, slots=True)
class Claim:
    """Something that a figure or a sentence of the thesis says, as a number with a bound."""

    source: str  # e.g. "Fig. 4.4"
    text: str
    value: float
    relation: Literal["at most", "at least"]
    bound: float

    @property
    def holds(self) -> bool:
        """Whether the value keeps its bound; what is not a number does not."""
        return self.value <= self.bound if self.relation == "at most" else self.value >= self.bound

    @property
    def row(self) -> tuple[str, str, str, str, str]:
        """Source, claim, value, bound and whether it holds, as texts."""
        return (
            self.source,
            self.text,
            f"{self.value:.3g}",
            f"{self.relation} {self.bound:g}",
            "yes" if self.holds else "NO",
        )


CLAIM_HEAD = ("source", "claim", "value", "bound", "holds")


@dataclass(frozen=True, slots=True)
class Setting:
    """How the thesis set something, and how this study does."""

    name: str
    thesis: str
    ours: str


SETTING_HEAD = ("setting", "thesis", "here")

Role = Literal["target", "prediction", "ideal"]


@dataclass(frozen=True, slots=True)
class Panel:
    """Curves over time: the target signal, a prediction of it, and what a perfect one would have been."""

    title: str
    curves: Mapping[Role, Vector]  # shape (steps,) each


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure with its words, yet to be drawn."""

    name: str
    title: str
    caption: str
    time: Vector  # shape (steps,)
    axis: str  # what time is counted in
    panels: tuple[Panel, ...]


@dataclass(frozen=True, slots=True)
class Line:
    """One curve, or loose points."""

    x: Vector
    y: Vector
    colour: str
    label: str = ""
    points: bool = False
    width: float = 1.0


@dataclass(frozen=True, slots=True)
class Plot:
    """Curves on one pair of axes."""

    title: str
    lines: tuple[Line, ...]
    x_axis: str = ""
    y_axis: str = ""
    ticks: tuple[str, ...] = ()  # names of x = 0, 1, … instead of numbers
    equal: bool = False  # whether both axes have the same scale


@dataclass(frozen=True, slots=True)
class Chart:
    """A figure that is not a picture of predictions, yet to be drawn."""

    name: str
    title: str
    caption: str
    plots: tuple[Plot, ...]
    columns: int = 1
    height: float = 1.5  # inches, of a row


@dataclass(frozen=True, slots=True)
class Listing:
    """A further table."""

    name: str
    title: str
    rows: tuple[Sequence[str], ...]  # the first is the head
    note: str = ""


@dataclass(frozen=True, slots=True)
class Findings:
    """What came out of one run of a study."""

    settings: tuple[Setting, ...]
    claims: tuple[Claim, ...]
    pictures: tuple[Picture, ...]
    comparison: tuple[Sequence[str], ...]  # a table; its first row is the head
    series: Mapping[str, Vector]  # every step of every signal by column name, shape (steps,) each
    simulated: str
    """What was simulated, and what about it is a guess."""
    remarks: tuple[str, ...] = ()
    charts: tuple[Chart, ...] = ()
    listings: tuple[Listing, ...] = ()

    @property
    def hold(self) -> bool:
        """Whether every claim does."""
        return all(claim.holds for claim in self.claims)


@dataclass(frozen=True, slots=True)
class People:
    """Who takes part in a study of operators, for how long, and helped how; None or empty: as usual."""

    operators: int | None = None
    circuits: int | None = None  # of each kind
    modes: tuple[str, ...] = ()
    jobs: int = 1  # processes; the findings are the same for any number of them

    @property
    def words(self) -> str:
        """The options of a command that ask for them."""
        given = (("operators", self.operators), ("circuits", self.circuits), ("modes", ",".join(self.modes)))
        return "".join(f" --{name} {value}" for name, value in given if value)


@dataclass(frozen=True, slots=True)
class Trials:
    """What a study of signals is tried on, and how often; None or empty: as usual."""

    people: int | None = None  # simulated
    splits: int | None = None  # into training and test data, at random
    sweep: bool = False  # all parameters of all features
    recordings: tuple[Path, ...] = ()
    jobs: int = 1  # processes; the findings are the same for any number of them

    @property
    def words(self) -> str:
        """The options of a command that ask for them."""
        numbers = (("operators", self.people), ("splits", self.splits))
        told = [f" --{name} {value}" for name, value in numbers if value]
        files = [f" --recording {path}" for path in self.recordings]
        return "".join([*told, " --sweep" if self.sweep else "", *files])


@dataclass(frozen=True, slots=True)
class Study:
    """An experiment that can be run again: equal seeds, and minutes or people, give equal findings."""

    title: str
    about: str  # one line
    run: Callable[[int, float], Findings]  # of a seed and minutes of simulated time
    minutes: float  # as in the thesis, or what it takes
    least_minutes: float
    people: Callable[[int, People], Findings] | None = None
    """Of a seed, if operators take part: then the number of minutes comes of what they do."""
    trials: Callable[[int, Trials], Findings] | None = None
    """Of a seed, if signals are told apart: then minutes mean nothing."""
