from collections.abc import Callable
from dataclasses import replace
from math import pi, radians

import pytest

from sim.servo import Servo, Setting
from sim.servo_models import AX_12A, MX_28, MX_64, MX_106, MX_SCALE, RPM, SERVO_MODELS, ServoModel
from sim.shaft import Link

LEVEL = Link(rest=0.0)
FOREARM = Link(gravity=0.67, rest=-pi / 2, inertia=0.013)


def run(servo: Servo, seconds: float) -> None:
    for _ in range(round(seconds * 1000)):
        servo.step(0.001)


def seconds_until(servo: Servo, happened: Callable[[], bool], at_most: float = 30.0) -> float:
    for step in range(round(at_most * 1000)):
        if happened():
            return step / 1000
        servo.step(0.001)
    raise AssertionError(f"did not happen in {at_most} s")


def holding(model: ServoModel, link: Link = LEVEL, goal: float = 0.0) -> Servo:
    servo = Servo(model, link)
    servo.tell(Setting(goal, torque_on=True))
    run(servo, 2.0)
    return servo


def test_a_command_takes_effect_after_the_dead_time() -> None:
    servo = Servo(MX_106, LEVEL, dead_time=0.017)
    servo.tell(Setting(1.0, torque_on=True))
    started = seconds_until(servo, lambda: servo.velocity > 0)
    assert 0.017 <= started <= 0.021


def test_commands_keep_their_order_when_the_dead_time_shrinks() -> None:
    servo = Servo(MX_106, LEVEL)
    servo.slowness = 0.03
    servo.tell(Setting(1.0, torque_on=True))
    servo.slowness = 0.0
    servo.tell(Setting(-1.0, torque_on=True))
    run(servo, 2.0)
    assert servo.position == pytest.approx(-1.0, abs=radians(1.5))


@pytest.mark.parametrize("model", SERVO_MODELS.values(), ids=str)
def test_a_servo_follows_its_moving_speed(model: ServoModel) -> None:
    servo = holding(model)
    servo.tell(Setting(1.5, speed=0.5, torque_on=True))
    run(servo, 1.0)
    before = servo.position
    run(servo, 1.0)
    assert servo.position - before == pytest.approx(0.5, rel=0.05)


@pytest.mark.parametrize(("model", "rpm"), [(MX_28, 55), (MX_64, 63), (MX_106, 45)], ids=str)
def test_moving_speed_zero_is_as_fast_as_the_datasheet_says(model: ServoModel, rpm: float) -> None:
    servo = Servo(model, Link(low=-100.0, high=100.0), position=-60.0)
    servo.tell(Setting(60.0, speed=0.0, torque_on=True))
    run(servo, 2.0)
    assert servo.velocity == pytest.approx(rpm * 2 * pi / 60, rel=0.35)


def test_goal_acceleration_softens_both_ends_of_a_movement() -> None:
    servo = holding(MX_106)
    servo.tell(Setting(1.0, speed=1.0, acceleration=2.0, torque_on=True))
    run(servo, 0.25)
    assert 0.2 < servo.velocity < 0.7
    run(servo, 3.0)
    assert servo.position == pytest.approx(1.0, abs=radians(1.0))
    assert servo.velocity == 0.0


def test_a_new_goal_behind_makes_a_servo_with_acceleration_coast() -> None:
    servo = holding(MX_106)
    servo.tell(Setting(2.0, speed=1.0, acceleration=2.0, torque_on=True))
    run(servo, 1.0)
    turned = servo.position
    servo.tell(Setting(turned, speed=1.0, acceleration=2.0, torque_on=True))
    track = []
    for _ in range(1000):
        servo.step(0.001)
        track.append(servo.position)
    peak = max(track)
    assert peak - turned == pytest.approx(1.0**2 / (2 * 2.0) + 0.018, abs=0.06)


def test_a_held_load_sinks_by_the_lag_of_the_p_controller() -> None:
    servo = Servo(MX_106, Link(gravity=2.0, rest=-pi / 2))
    servo.tell(Setting(0.0, torque_on=True))
    run(servo, 3.0)
    lag = radians(11.33) * servo.duty
    assert servo.duty > 0.1
    assert servo.position == pytest.approx(-lag, rel=0.01)


def test_friction_holds_a_light_load_and_not_a_heavy_one() -> None:
    light, heavy = (Servo(MX_106, Link(gravity=g, rest=-pi / 2)) for g in (0.1, 0.3))
    run(light, 1.0)
    run(heavy, 1.0)
    assert light.position == 0.0
    assert heavy.position < -0.5


def test_a_falling_joint_stops_at_its_hard_stop() -> None:
    servo = Servo(MX_106, Link(gravity=0.67, rest=-pi / 2, low=-0.4))
    run(servo, 3.0)
    assert (servo.position, servo.velocity) == (-0.4, 0.0)


def test_a_limp_servo_forgets_where_it_was_to_go() -> None:
    servo = holding(MX_106, FOREARM, 0.5)
    servo.tell(Setting(0.5, torque_on=False))
    run(servo, 1.0)
    assert servo.reference == servo.position < 0.0


def test_a_torque_limit_of_nothing_lets_the_arm_down() -> None:
    servo = holding(MX_106, FOREARM)
    servo.tell(Setting(0.0, torque_on=True, torque_limit=0.0))
    run(servo, 1.0)
    assert servo.position < -0.3


def test_sensors_show_ticks_speed_steps_and_duty() -> None:
    servo = holding(MX_28, goal=100.4 * MX_SCALE.tick)
    servo.position = 100.4 * MX_SCALE.tick
    servo.velocity = -10.3 * MX_SCALE.speed
    seen = servo.sense()
    assert (seen.ticks, seen.speed) == (MX_SCALE.centre + 100, -10)
    assert seen.load == servo.duty


@pytest.mark.parametrize(
    ("model", "position", "ticks"),
    [(MX_28, -4.0, 0), (MX_28, 4.0, 4095), (AX_12A, -3.0, 0), (AX_12A, 3.0, 1023)],
)
def test_the_position_sensor_stops_at_its_ends(model: ServoModel, position: float, ticks: int) -> None:
    assert Servo(model, LEVEL, position).sense().ticks == ticks


@pytest.mark.parametrize(("name", "rpm"), [("AX-12A", 0.111), ("MX-64", 0.114), ("MX-64(2.0)", 0.229)])
def test_speeds_are_counted_as_the_models_manual_says(name: str, rpm: float) -> None:
    servo = Servo(SERVO_MODELS[name], LEVEL)
    servo.velocity = 10 * rpm * RPM
    assert servo.sense().speed == 10


def test_a_degree_is_three_and_a_half_counts_of_an_ax() -> None:
    assert Servo(AX_12A, LEVEL, radians(29.4)).sense().ticks == 512 + 100


def test_work_heats_a_servo_within_minutes() -> None:
    servo = Servo(MX_28, Link(gravity=0.8, rest=-pi / 2))
    servo.tell(Setting(0.0, torque_on=True))
    run(servo, 60.0)
    assert 25.5 < servo.temperature < 40.0
    assert servo.errors() == ()


def test_a_blocked_servo_cuts_its_torque_after_ten_seconds() -> None:
    servo = holding(MX_28)
    servo.stuck = True
    servo.tell(Setting(1.0, torque_on=True))
    tripped = seconds_until(servo, lambda: servo.shutdown != "")
    assert tripped == pytest.approx(10.0, abs=0.1)
    run(servo, 0.1)
    assert servo.errors() == ("Overload Error",)
    assert servo.duty == 0.0
    servo.restore()
    assert servo.errors() == ()


def test_a_servo_that_is_hot_refuses_to_be_restored() -> None:
    servo = holding(MX_28)
    servo.temperature = servo.ambient = 85.0
    run(servo, 0.1)
    servo.restore()
    assert servo.shutdown == "overheat"
    assert servo.errors() == ("Overheating Error",)


def test_a_stuck_servo_pulls_and_does_not_move() -> None:
    servo = holding(MX_64)
    servo.stuck = True
    where = servo.position
    servo.tell(Setting(1.0, torque_on=True))
    run(servo, 0.5)
    assert servo.position == where
    assert servo.current > 1.0


def test_a_blocked_servo_pulls_and_can_only_go_back() -> None:
    servo = holding(MX_28)
    servo.block(True)
    where = servo.position
    servo.tell(Setting(1.0, torque_on=True))
    run(servo, 0.5)
    assert servo.position == where
    assert servo.duty > 0.5
    servo.tell(Setting(-0.5, torque_on=True))
    run(servo, 1.0)
    assert servo.position == pytest.approx(-0.5, abs=radians(1))
    servo.block(False)
    servo.tell(Setting(0.5, torque_on=True))
    run(servo, 1.0)
    assert servo.position == pytest.approx(0.5, abs=radians(1))


def test_a_reboot_makes_it_limp_and_deaf_for_a_while() -> None:
    servo = holding(MX_106, FOREARM)
    servo.trip("overload")
    servo.reboot()
    run(servo, 0.29)
    early = servo.answers
    run(servo, 0.02)
    assert (early, servo.answers) == (False, True)
    assert servo.position < -0.03
    assert (servo.boots, servo.shutdown) == (1, "")


def test_a_watchdog_that_hears_nothing_stops_the_motion_at_once() -> None:
    servo = holding(MX_64)
    servo.tell(Setting(2.0, speed=0.5, acceleration=1.0, torque_on=True))
    servo.watch(0.5)
    run(servo, 0.4)
    servo.heard()
    run(servo, 0.4)
    early = servo.tripped
    run(servo, 0.11)
    assert (early, servo.tripped) == (False, True)
    stopped = servo.reference
    run(servo, 1.0)
    assert servo.reference == stopped
    assert servo.position == pytest.approx(stopped, abs=radians(1))


def test_a_servo_at_rest_lives_through_a_stretch_as_it_would_step_by_step() -> None:
    slow, fast = (Servo(MX_106, Link(gravity=0.67, rest=-pi / 2), seed="same") for _ in range(2))
    for goal in (0.4, 0.4, -0.2):
        setting = Setting(goal, speed=0.5, torque_on=True)
        slow.tell(setting)
        fast.tell(setting)
        run(slow, 3.0)
        fast.run(3000, 0.001)
        assert fast.position == slow.position
        assert fast.time == pytest.approx(slow.time)
        assert fast.temperature == pytest.approx(slow.temperature, abs=0.01)


def test_power_comes_back_limp() -> None:
    servo = holding(MX_106, FOREARM)
    servo.power(False)
    run(servo, 0.05)
    servo.power(True)
    run(servo, 1.0)
    assert servo.position < -0.3
    assert servo.boots == 1


def test_glitches_are_rare_wild_and_repeatable() -> None:
    def seen(seed: str) -> list[int]:
        servo = Servo(MX_28, LEVEL, seed=seed)
        servo.glitch_rate = 0.1
        return [servo.sense().ticks for _ in range(200)]

    wild = [ticks for ticks in seen("a") if ticks != MX_SCALE.centre]
    assert 5 <= len(wild) <= 40
    assert seen("a") == seen("a") != seen("b")


def test_a_weak_supply_weakens_the_servo_and_is_complained_of() -> None:
    servo = holding(MX_28)
    servo.supply = 5.5
    assert servo.errors() == ("Input Voltage Error",)
    assert servo.sense().voltage == pytest.approx(5.5, abs=0.1)


def test_a_finer_step_gives_the_same_movement() -> None:
    coarse, fine = (Servo(MX_106, FOREARM, seed="same") for _ in range(2))
    setting = Setting(0.7, speed=0.5, torque_on=True)
    coarse.tell(setting)
    fine.tell(replace(setting))
    for _ in range(1000):
        coarse.step(0.001)
        for _ in range(4):
            fine.step(0.00025)
    assert coarse.position == pytest.approx(fine.position, abs=radians(0.5))
