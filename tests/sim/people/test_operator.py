"""Operators on an empty plane: delay, toggles, slips, and an arm that moves by itself."""

import random
from collections.abc import Callable
from dataclasses import replace

import pytest

from sim.people.operator import Operator
from sim.people.population import population
from sim.people.scene import Act, Point, View, Way
from sim.people.senses import Eyes
from sim.people.switch import Switch
from sim.people.traits import AUTHOR, NAIVE, PRACTISED, Autonomy, Switching, Traits
from sim.people.trust import Look, Trust

TICK = 1 / 30
SPEED = 0.2

CERTAIN = Switching(missed=0.0, double=0.0, wrong=0.0)
"""No slips."""


class Corner:
    """Go to (0.2, 0.2), wherever one comes from."""

    target = (0.2, 0.2)

    def value(self, position: Point, margin: float) -> float:
        return -sum(abs(a - b) for a, b in zip(position, self.target, strict=True))

    def way(self, position: Point, joint: int, drift: float, margin: float) -> Way:
        distance = self.target[joint] - position[joint]
        return Way(distance, abs(distance))

    def place(self, position: Point) -> int:
        return 0


class World:
    """An arm that does at once what the operator wants, and something by itself on top."""

    def __init__(self, traits: Traits, seed: int = 1, helps: float = 0.0, assisted: bool = False) -> None:
        self.operator = Operator(traits, seed, SPEED)
        self.position = [0.0, 0.0]
        self.active = 0
        self.toggles = 0
        self.time = 0.0
        self.farthest = 0.0
        """rad that the first joint has come at most."""
        self.acts: list[Act] = []
        self._helps = helps
        self._assisted = assisted

    def run(self, seconds: float, until: Callable[["World"], bool] = lambda _: False) -> float:
        end = self.time + seconds
        while self.time < end and not until(self):
            x, y = self.position
            view = View(self.time, (x, y), self.active, self.toggles, False, False, 0, self._assisted)
            act = self.operator.step(view, Corner())
            self.acts.append(act)
            if act.toggle:
                self.active, self.toggles = 1 - self.active, self.toggles + 1
            self.position[self.active] += act.effort * SPEED * TICK
            if act.effort:
                self.position[1 - self.active] += self._helps * TICK
            self.farthest = max(self.farthest, self.position[0])
            self.time += TICK
        return self.time

    def off(self) -> float:
        return max(abs(0.2 - position) for position in self.position)


@pytest.mark.parametrize("kind", [NAIVE, PRACTISED, AUTHOR])
def test_an_operator_brings_both_joints_to_the_goal_with_few_toggles(kind: Traits) -> None:
    slips = replace(kind.switching, missed=0.0, double=0.0, wrong=0.0)
    world = World(replace(kind, switching=slips))
    world.run(10.0)
    assert world.off() < 0.03
    assert 1 <= world.toggles <= 5


def test_nothing_is_done_before_the_goal_can_have_been_seen() -> None:
    traits = replace(AUTHOR, switching=CERTAIN)
    world = World(traits)
    world.operator.step(View(0.0, (0.0, 0.0), 0, 0, True, False, 0, False), Corner())
    world.time = TICK
    world.run(traits.senses.hearing - 2 * TICK)
    assert not any(act.effort for act in world.acts)
    world.run(0.5)
    assert any(act.effort for act in world.acts)


def test_the_same_seed_is_the_same_person_and_another_seed_another() -> None:
    acts = []
    for seed in (1, 1, 2):
        world = World(NAIVE, seed)
        world.run(4.0)
        acts.append(world.acts)
    assert acts[0] == acts[1]
    assert acts[0] != acts[2]


def test_whoever_does_not_foresee_their_own_motion_overshoots() -> None:
    overshoots = []
    for prediction in (1.0, 0.0):
        senses = replace(AUTHOR.senses, prediction=prediction)
        world = World(replace(AUTHOR, senses=senses, switching=CERTAIN))
        world.run(10.0, until=lambda world: world.toggles > 0)
        overshoots.append(world.farthest - 0.2)
    assert overshoots[0] < 0.012
    assert overshoots[1] > overshoots[0] + 0.01


def test_a_missed_press_is_noticed_and_made_up_for() -> None:
    traits = replace(AUTHOR, switching=replace(CERTAIN, missed=0.5))
    world = World(traits, seed=3)
    world.run(20.0)
    assert world.off() < 0.03


def test_a_toggle_takes_the_time_to_choose_and_to_press_with_the_hand_at_rest() -> None:
    world = World(replace(NAIVE, switching=replace(CERTAIN, scatter=0.0, foresight=0.0)))
    world.run(10.0, until=lambda world: world.toggles == 1)
    still = 0
    for act in reversed(world.acts[:-1]):
        if abs(act.effort) > 0.5:
            break
        still += 1
    assert still * TICK >= NAIVE.switching.choice + NAIVE.switching.press - 2 * TICK


def test_an_arm_that_moves_by_itself_stops_a_newcomer_and_not_somebody_used_to_it() -> None:
    rests = []
    for autonomy in (Autonomy(trust=0.0), Autonomy(trust=0.98, experience=100.0)):
        world = World(replace(AUTHOR, switching=CERTAIN, autonomy=autonomy), helps=0.1, assisted=True)
        world.run(1.5)
        rests.append(sum(act.effort == 0 for act in world.acts))
    assert rests[0] > rests[1] + 10


def test_help_saves_the_toggle_of_whoever_is_used_to_it() -> None:
    used = replace(AUTHOR, switching=CERTAIN)
    alone, helped = World(used), World(used, helps=0.2, assisted=True)
    for world in (alone, helped):
        world.run(10.0, until=lambda world: world.off() < 0.02)
    assert helped.toggles < alone.toggles
    assert helped.time < alone.time


def look(position: Point, rates: Point = (0.1, 0.1), elapsed: float = TICK) -> Look:
    return Look(position, rates, 0, elapsed, assisted=True)


def watched(other: float, autonomy: Autonomy, seed: int = 1) -> Trust:
    """After driving joint 0 while joint 1 moved by itself at `other` rad/s for two seconds."""
    draw = random.Random(seed)
    trust = Trust(autonomy, draw)
    for i in range(60):
        trust.watch(look((0.1 * i * TICK, other * i * TICK), (0.1, other)), Corner(), 0.0)
    return trust


def test_help_wins_trust_and_harm_loses_more_of_it() -> None:
    start = Autonomy(trust=0.5)
    won = watched(0.1, start).trust - 0.5
    lost = 0.5 - watched(-0.1, start).trust
    assert 0 < won < lost


def test_what_the_arm_does_by_itself_comes_to_be_expected_as_far_as_it_is_trusted() -> None:
    trust = watched(0.1, Autonomy(trust=0.9, learning=0.3))
    assert trust.expects(look((0.2, 0.2)), 0, 0) == pytest.approx(0.1 * trust.trust, rel=0.05)
    alone = replace(look((0.2, 0.2)), assisted=False)
    assert trust.expects(alone, 0, 0) == 0.0


def test_habit_takes_surprise_and_confusion_away() -> None:
    new, old = Autonomy(confusion=1.0), Autonomy(confusion=1.0, experience=100.0)
    assert watched(0.0, new).strangeness == 1.0
    assert watched(0.0, new).confused()
    assert not watched(0.0, old).confused()


def test_the_voice_corrects_what_was_believed_of_the_joint() -> None:
    switch = Switch(CERTAIN, random.Random(1))
    switch.begin(0.0, prepared=True)
    now = 0.0
    while not switch.step(now, View(now, (0.0, 0.0), 0, 0, False, False, 0, False)):
        now += TICK
    assert switch.belief == 1
    switch.lose()
    said = View(now + 0.2, (0.0, 0.0), 1, 1, False, False, 0, False)
    switch.step(now + 0.6, said)
    assert switch.belief == 1


def test_eyes_are_late_by_their_delay() -> None:
    eyes = Eyes(NAIVE.senses, SPEED, random.Random(1))
    for i in range(30):
        eyes.look(View(i * TICK, (i * TICK, 0.0), 0, 0, False, False, 0, False))
    late = 29 * TICK - eyes.seen().time
    assert NAIVE.senses.visual_delay - 1e-6 <= late < NAIVE.senses.visual_delay + TICK


def test_a_population_is_drawn_from_its_seed_and_a_larger_one_begins_with_the_smaller() -> None:
    assert population(12, 7)[:5] == population(5, 7)
    assert population(5, 7) != population(5, 8)
    names = [person.name for person in population(12, 7)]
    assert len(set(names)) == 12
    assert sum(name.startswith("naive") for name in names) == 6
    assert sum(name.startswith("author") for name in names) == 3


def test_people_of_a_population_have_possible_traits() -> None:
    for person in population(200, 3):
        assert 0.13 <= person.senses.visual_delay <= 0.28
        assert 0.5 <= person.senses.prediction <= 1.0
        assert 0.0 <= person.autonomy.trust < 1.0
        assert person.caution.margin > 0


def pushed(lenience: float, pressing: bool) -> float:
    """Effort within 0.4 s after the rod of somebody who trusts the arm has touched a wall."""
    traits = replace(AUTHOR, caution=replace(AUTHOR.caution, lenience=lenience))
    operator, corner = Operator(traits, 3, SPEED), Corner()
    operator.trust.trust = 1.0
    total = 0.0
    for i in range(60):
        touching = i >= 30
        view = View(
            i * TICK, (0.0, 0.0), 1, 0, False, touching, 0, assisted=True, pressing=touching and pressing
        )
        effort = operator.step(view, corner).effort
        total += abs(effort) * (36 <= i < 48)
    return total


def test_whoever_is_lenient_lets_the_rod_slide_along_a_wall_unless_it_presses() -> None:
    assert pushed(1.0, pressing=False) > pushed(0.0, pressing=False)
    assert pushed(1.0, pressing=False) > pushed(1.0, pressing=True)
