"""Muscles measured from the page: the same procedure as `bentod calibrate emg`, seen by all browsers."""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass, field

from bentod.calibration.measuring import Plan, Step, apply, chosen, measure
from bentod.calibration.muscles import Setting
from bentod.dashboard.own import Own, Stage, Visit, own
from bentod.errors import BadRequest, BentodError, Refused
from bentod.frames import Value

KEY = "calibration"
"""Under which the state goes with every frame, and under which the server keeps it."""

_USUAL = Plan()

BOUNDS: Mapping[str, tuple[float, float, float]] = {
    "ready": (0.0, 30.0, _USUAL.ready),
    "rest": (1.5, 60.0, _USUAL.rest),
    "hold": (1.5, 30.0, _USUAL.hold),
}
"""s: at least, at most, and if nothing is said; by parameter."""

CANCELLED = "It was cancelled; nothing was set."
GONE = "The page that wanted it is gone; nothing was set."


@dataclass(frozen=True, slots=True)
class _Shared:
    """The connection that all browsers share: it is still there when the page that began is gone."""

    stage: Stage

    async def call(self, method: str, /, *params: Value, **named: Value) -> Value:
        return await self.stage.look(method, named)


@dataclass(frozen=True, slots=True)
class _Own:
    """The browser's own connection, for what changes the arm."""

    visit: Visit

    async def call(self, method: str, /, *params: Value, **named: Value) -> Value:
        return await self.visit.act(method, named)


@dataclass(slots=True)
class Run:
    """One calibration, from its first word to what came of it."""

    number: int
    sites: list[str]
    before: Value
    limit: asyncio.Timeout = field(default_factory=lambda: asyncio.timeout(None))
    phase: str = "asking"  # then "found" or "over"; "set" when the daemon was told
    why: str = ""  # it is over
    step: Step | None = None
    until: float = 0.0  # monotonic s, when what is asked now ends
    found: list[Setting] = field(default_factory=list)
    done: list[str] = field(default_factory=list)  # sites that were set

    def asked(self, step: Step) -> None:
        """Take in what the wearer is to do."""
        self.step = step
        self.until = asyncio.get_running_loop().time() + (step.ready or step.seconds)

    def cancel(self, why: str) -> None:
        """End it, if it goes on; the muscles are put back as they were."""
        if self.phase == "asking" and not self.why:
            self.why = why
            self.limit.reschedule(asyncio.get_running_loop().time())

    async def go(self, stage: Stage, plan: Plan) -> None:
        """Measure. Raises BentodError: it cannot be, or is cancelled."""
        try:
            async with self.limit:
                self.found = await measure(_Shared(stage), plan, self.asked)
            self.phase = "found"
        except TimeoutError:
            raise Refused(self.why) from None
        except BentodError as error:
            self.why = self.why or str(error)
            raise
        finally:
            self.phase = "found" if self.phase == "found" else "over"
            self.why = self.why or ("" if self.phase == "found" else GONE)

    def told(self) -> Value:
        """What goes with every frame: s, and the number of the step from 0, which is rest."""
        step = self.step
        left = max(self.until - asyncio.get_running_loop().time(), 0.0)
        told: dict[str, Value] = {"run": self.number, "phase": self.phase, "why": self.why}
        if self.phase != "asking" or step is None:
            return told
        now: dict[str, Value] = {
            "step": step.number,
            "site": step.site,
            "ready": step.ready > 0,
            "left": round(left, 2),
        }
        return {**told, **now, "of": 1 + len(self.sites), "seconds": step.seconds}


class Calibrations:
    """The newest calibration; at most one is under way."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self.run: Run | None = None
        stage.watchers.append(self._watch)

    async def start(self, visit: Visit, plan: Plan) -> None:
        """Measure, which takes as long as it takes. Raises BentodError."""
        described = await self._stage.look("emg_get", {})
        if self.run and self.run.phase == "asking":
            raise Refused("muscles are being calibrated already: wait for the end, or cancel it")
        sites = chosen(described, plan.sites)
        run = self.run = Run(self.run.number + 1 if self.run else 1, sites, described)

        async def gone() -> None:
            run.cancel(GONE)

        visit.on_leave(gone)
        await run.go(self._stage, plan)

    def _watch(self, frame: dict[str, Value]) -> None:
        if self.run:
            self._stage.told[KEY] = self.run.told()


async def start(visit: Visit, params: dict[str, Value]) -> Value:
    """Measure rest and a contraction of each site; returns what was found, and sets nothing.

    Raises:
        BadRequest: a time is out of its bounds.
        BentodError: there is no such site, one goes on already, it was cancelled, or too little was seen.
    """
    kept = _kept(visit.stage)
    await kept.start(visit, _plan(params))
    return _report(kept.run)


async def cancel(visit: Visit, params: dict[str, Value]) -> Value:
    """End what is under way; nothing is set. Raises Refused: nothing is."""
    run = _kept(visit.stage).run
    if run is None or run.phase != "asking":
        raise Refused("no calibration is under way")
    run.cancel(CANCELLED)
    return None


async def use(visit: Visit, params: dict[str, Value]) -> Value:
    """Set the sites to what was found, where a contraction can be told from rest. Raises BentodError."""
    run = _kept(visit.stage).run
    if run is None or not run.found:
        raise Refused("nothing was measured that could be set")
    run.done = await apply(_Own(visit), run.found)
    run.phase = "set"
    return _report(run)


async def get(visit: Visit, params: dict[str, Value]) -> Value:
    """What the newest calibration found, V after gain; nil: there was none."""
    return _report(_kept(visit.stage).run)


def _kept(stage: Stage) -> Calibrations:
    kept = stage.kept.get(KEY)
    if not isinstance(kept, Calibrations):
        kept = stage.kept[KEY] = Calibrations(stage)
    return kept


def _plan(params: dict[str, Value]) -> Plan:
    ready, rest, hold = (_seconds(params, name) for name in BOUNDS)
    sites = params.get("sites") or []
    if not isinstance(sites, list) or not all(isinstance(site, str) for site in sites):
        raise BadRequest("sites must be a list of names", "sites")
    return Plan([str(site) for site in sites], ready, rest, hold)


def _seconds(params: dict[str, Value], name: str) -> float:
    low, high, usual = BOUNDS[name]
    value = params.get(name, usual)
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise BadRequest(f"{name} must be from {low:g} to {high:g} s, not {value!r}", name)
    return float(value)


def _report(run: Run | None) -> Value:
    if run is None:
        return None
    results = [_result(one, run.before) for one in run.found]
    return {"run": run.number, "phase": run.phase, "sites": list[Value](run.sites),
            "results": list[Value](results), "set": list[Value](run.done)}  # fmt: skip


def _result(found: Setting, before: Value) -> dict[str, Value]:
    """V after gain; `lines`: as the config would have them."""
    after = {"threshold_v": found.threshold, "max_v": found.maximum}
    return {
        "site": found.site,
        "rest_v": found.rest,
        "scatter_v": found.scatter,
        "contraction_v": found.contraction,
        "separable": found.separable,
        "remarks": list[Value](found.remarks),
        "before": _values(before, found.site),
        "after": {**after},
        "lines": "\n".join(
            [f'name = "{found.site}"', *(f"{key} = {volts:g}" for key, volts in after.items())]
        ),
    }


def _values(described: Value, name: str) -> Value:
    match described:
        case {"sites": [*sites]}:
            for site in sites:
                match site:
                    case {"name": str(known), "threshold_v": low, "max_v": high} if known == name:
                        return {"threshold_v": low, "max_v": high}
    return None


METHODS: dict[str, Own] = own(
    observer={"dashboard.calibrate_get": get},
    operator={
        "dashboard.calibrate_start": start,
        "dashboard.calibrate_cancel": cancel,
        "dashboard.calibrate_use": use,
    },
)
"""By name."""
