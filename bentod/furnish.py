"""The desk as the config wants it: what a daemon and a replay of its recording have in common."""

from collections.abc import Sequence

from bentod.arm_state import Rules
from bentod.config import Config
from bentod.control.groups import Groups
from bentod.control.health import Ladder
from bentod.control.modes import Modes
from bentod.desk import Desk
from bentod.emg.feed import Feed
from bentod.mind import Mind
from bentod.muscles import Muscles
from bentod.serve.room import About


def furnished(config: Config, torque: Sequence[bool], feed: Feed | None, mind: Mind | None = None) -> Desk:
    """A desk for joints that were found with this torque; `feed`: None without muscle signals.

    `mind`: of the same config; left out, one that knows nothing. Raises ConfigError: as `mind_of` does.
    """
    specs = [joint.spec() for joint in config.joints]
    mind = mind or mind_of(config)
    groups = mind.groups
    modes = Modes([spec.name for spec in specs], torque)
    safety = config.safety
    ladder = Ladder(safety.hold_after_s, safety.fault_after_s)
    rules = Rules(ladder, safety.fault == "limp", safety.home_speed_rad_s, safety.lease_max_s)
    emg = config.emg
    muscles = Muscles(feed, emg.sites, emg.pairs, emg.window) if emg else Muscles()
    return Desk(specs, groups, modes, rules, muscles, mind)


def mind_of(config: Config) -> Mind:
    """Learners and assist as the config wants them. Raises ConfigError: a question is not one."""
    specs = [joint.spec() for joint in config.joints]
    sites = [site.name for site in config.emg.sites] if config.emg else []
    groups = Groups(specs, {group.name: group.joints for group in config.groups})
    return Mind(specs, config.rate_hz, groups, config.learn, [assist for _, assist in config.helped()], sites)


def about(config: Config) -> About:
    """What clients are told of the arm that does not change."""
    return About(
        arm=config.arm,
        driver=", ".join(dict.fromkeys(share.driver.name for share in config.shares())),
        rate_hz=config.rate_hz,
        joints=tuple(joint.spec() for joint in config.joints),
        groups={group.name: group.joints for group in config.groups},
        emg=config.emg.source.name if config.emg else "",
        lease_max=config.safety.lease_max_s,
    )
