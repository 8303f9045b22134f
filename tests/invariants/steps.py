"""What clients, faults and time may do to the arm: single steps, and how to draw a sequence of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TypeAlias

from hypothesis import strategies as st

from bentod.frames import Value
from tests.rig import Table, number, table

CLIENTS = 3


@dataclass(frozen=True, slots=True)
class Call:
    """A client asks something, and waits for the answer or does not."""

    client: int
    method: str
    params: Value
    wait: bool = False


@dataclass(frozen=True, slots=True)
class Vanish:
    """A client's connection is gone; its next step is that of a newcomer."""

    client: int


@dataclass(frozen=True, slots=True)
class Garble:
    """A client sends what is no message."""

    client: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Muscles:
    """The source of muscle signals breaks or is mended; an end is for good."""

    fault: str  # "stall", "nan" or "end"
    on: bool


@dataclass(frozen=True, slots=True)
class Recover:
    """Everything is mended, and the arm armed and released again as a user would."""


@dataclass(frozen=True, slots=True)
class Let:
    """Time passes."""

    seconds: float


Step: TypeAlias = Call | Vanish | Garble | Muscles | Recover | Let

RUBBISH: Sequence[Value] = (
    None, True, -1, 2**40, 1e9, -1e9, 0.0, float("nan"), float("inf"), "", "nobody", "x" * 300, [], {},
    [None], ["nobody"], [[]], {"a": {}}, b"\x00",
)  # fmt: skip
"""Arguments that are wrong nearly everywhere."""


@dataclass(frozen=True, slots=True)
class Api:
    """What the daemon says of itself: its methods, joints, groups, sites and faults."""

    methods: Mapping[str, Sequence[Table]]  # parameters by name of the method
    joints: Sequence[Table]
    groups: Sequence[str]
    sites: Sequence[str]
    faults: Sequence[str]

    def names(self, parameter: str) -> Sequence[str]:
        """What a text of this name may be; empty: anything."""
        known = {
            "joint": [str(joint["name"]) for joint in self.joints],
            "joints": [str(joint["name"]) for joint in self.joints],
            "group": self.groups,
            "site": self.sites,
            "fault": self.faults,
        }
        return known.get(parameter, ())


def steps(api: Api, phases: int = 6) -> st.SearchStrategy[list[Step]]:
    """Sequences of about five times `phases`, which hypothesis can shrink to nothing."""
    one: st.SearchStrategy[Step] = st.one_of(
        _moves(api),
        _moves(api),
        _verbs(api),
        _verbs(api),
        _faults(api),
        _any_call(api),
        st.builds(Vanish, _client()),
        st.builds(Garble, _client(), st.binary(min_size=1, max_size=40)),
        st.builds(Muscles, st.sampled_from(("stall", "nan", "stall", "nan", "end")), st.booleans()),
        st.just(Recover()),
        _time(),
        _time(),
        _time(),
    )
    # Of a plain list that may be short most are short, and too little happens.
    phase = st.lists(one, max_size=10)
    return st.lists(phase, min_size=phases, max_size=phases).map(lambda parts: list(chain(*parts)))


def _client() -> st.SearchStrategy[int]:
    return st.integers(0, CLIENTS - 1)


def _time() -> st.SearchStrategy[Step]:
    few_ticks = st.floats(0.0, 0.2, allow_subnormal=False)
    return st.builds(Let, few_ticks | st.floats(0.2, 2.5))


def _moves(api: Api) -> st.SearchStrategy[Step]:
    """Wishes that are mostly granted, if the arm may move."""

    def move(joint: Table, velocity: float, place: float, lease: float, kind: int) -> Value:
        most = number(joint, "max_velocity_rad_s")
        low, high = number(joint, "min_rad"), number(joint, "max_rad")
        params: dict[str, Value] = {"joint": joint["name"], "lease_s": lease}
        if kind != 1:
            params["velocity"] = velocity * most
        if kind != 0:
            params["position"] = min(max(low + place * (high - low), low), high)
        return params

    share = st.sampled_from((-1.0, 1.0)) | st.floats(-1.0, 1.0)
    lease = st.sampled_from((0.2, 2.0)) | st.floats(0.05, 3.0)
    kinds = st.sampled_from((0, 0, 1, 2))
    moves = st.builds(move, st.sampled_from(list(api.joints)), share, st.floats(0.0, 1.0), lease, kinds)
    efforts = st.fixed_dictionaries(
        {"group": st.sampled_from(list(api.groups)), "effort": share, "lease_s": lease}
    )
    waits = st.booleans()
    single = st.builds(Call, _client(), st.just("move"), moves, waits)
    return single | st.builds(Call, _client(), st.just("group_command"), efforts, waits)


def _verbs(api: Api) -> st.SearchStrategy[Step]:
    """What changes modes, goals and torque."""
    names = st.sampled_from(list(api.names("joint")))
    some = st.none() | names | st.lists(names, min_size=1, max_size=3)
    switches = st.fixed_dictionaries({"joints": some, "on": st.booleans()})
    held = st.none() | st.floats(0.05, 1.0)
    homes = st.fixed_dictionaries({"joints": some, "lease_s": held})
    waits = st.booleans()
    return st.one_of(
        st.builds(Call, _client(), st.sampled_from(("pause", "torque")), switches, waits),
        st.builds(Call, _client(), st.sampled_from(("pause", "torque")), switches, waits),
        st.builds(Call, _client(), st.just("go_home"), homes, waits),
        st.builds(
            Call, _client(), st.sampled_from(("stop", "clear_fault", "go_home_cancel")), st.just([]), waits
        ),
        st.builds(Call, _client(), st.just("emg_pause"), st.fixed_dictionaries({"on": st.booleans()}), waits),
    )


def _faults(api: Api) -> st.SearchStrategy[Step]:
    joints = st.none() | st.sampled_from(list(api.names("joint")))
    params = st.fixed_dictionaries(
        {"fault": st.sampled_from(list(api.faults)), "joint": joints, "on": st.booleans()}
    )
    return st.builds(Call, _client(), st.just("inject"), params.map(_placed), st.booleans())


def _placed(params: Mapping[str, str | bool | None]) -> Value:
    """Faults of the whole arm take no joint."""
    whole = params["fault"] in ("cable", "power", "noise")
    return {**params, "joint": None if whole else params["joint"]}


def _any_call(api: Api) -> st.SearchStrategy[Step]:
    """Every method there is, with arguments of all kinds."""
    named = [
        st.builds(Call, _client(), st.just(method), _arguments(api, parameters), st.booleans())
        for method, parameters in api.methods.items()
    ]
    odd = st.builds(Call, _client(), st.text(max_size=8), st.sampled_from(RUBBISH), st.booleans())
    return st.one_of(*named, odd)


def _arguments(api: Api, parameters: Sequence[Table]) -> st.SearchStrategy[Value]:
    values = {str(parameter["name"]): _value(api, parameter) for parameter in parameters}
    needed = {name: values[name] for name in values if _is_needed(name, parameters)}
    given = st.fixed_dictionaries(needed, optional={n: v for n, v in values.items() if n not in needed})
    in_order = st.tuples(*values.values()).map(list)
    return st.one_of(given, given, in_order, st.sampled_from(RUBBISH))


def _is_needed(name: str, parameters: Sequence[Table]) -> bool:
    return any(parameter["name"] == name and parameter["required"] is True for parameter in parameters)


def _value(api: Api, parameter: Table) -> st.SearchStrategy[Value]:
    """Mostly as the method wants it."""
    kind = str(parameter["type"])
    fit: st.SearchStrategy[Value]
    if "number" in kind:
        low, high = (number(parameter, key) if key in parameter else 0.0 for key in ("minimum", "maximum"))
        fit = st.floats(low, high)
    elif "flag" in kind:
        fit = st.booleans()
    elif "text" in kind:
        choices = parameter.get("choices") or list(api.names(str(parameter["name"])))
        fit = st.sampled_from(choices) if isinstance(choices, list) and choices else st.text(max_size=8)
    else:
        fit = st.sampled_from(RUBBISH)
    return st.one_of(fit, fit, fit, st.sampled_from(RUBBISH))


def api_of(methods: Value, info: Value, muscles: Value) -> Api:
    """What list_methods, get_info and emg_get answer, put together."""
    assert isinstance(methods, list)
    about = table(info)
    entries = {str(table(m)["name"]): _tables(table(m)["parameters"]) for m in methods}
    sites = [str(site["name"]) for site in _tables(table(muscles)["sites"])]
    faults = about["faults"]
    assert isinstance(faults, list)
    return Api(
        entries, _tables(about["joints"]), list(table(about["groups"])), sites, [str(f) for f in faults]
    )


def _tables(value: Value) -> list[Table]:
    assert isinstance(value, list)
    return [table(entry) for entry in value]
