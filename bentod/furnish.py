"""The desk as the config wants it: what a daemon and a replay of its recording have in common."""

from collections.abc import Sequence
from functools import partial

from bentod.arm_state import Rules
from bentod.config import Config
from bentod.config_tables import Emg
from bentod.contracts import JoystickSource
from bentod.control.groups import Groups
from bentod.control.health import Ladder
from bentod.control.modes import Modes
from bentod.control.proportional import Envelope, Loudness
from bentod.desk import Desk
from bentod.emg.electrodes import Electrodes
from bentod.emg.envelopes import LowPass, RootMeanSquare
from bentod.emg.feed import Feed
from bentod.emg.live.recogniser import Recogniser
from bentod.foresight import weighing, with_use
from bentod.joystick import Joystick
from bentod.mind import Mind
from bentod.muscles import Muscles
from bentod.serve.room import About


def furnished(
    config: Config,
    torque: Sequence[bool],
    feed: Feed | None,
    mind: Mind | None = None,
    pads: JoystickSource | None = None,
) -> Desk:
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
    muscles = _muscles(emg, feed) if emg else Muscles()
    if muscles.recognition:
        muscles.recognition.fuse = weighing(
            muscles.recognition.table, lambda: None if mind.broken else mind.predictor
        )
    desk = Desk(specs, groups, modes, rules, muscles, mind)
    if config.joystick:
        desk.joystick = Joystick(config.joystick, pads)
        desk.joystick.tell = partial(desk.journal.note, "joystick")
    return desk


def _muscles(emg: Emg, feed: Feed | None) -> Muscles:
    """Raises ConfigError: a filter does not suit the source's rate, or its library is missing."""
    if feed is None:
        return Muscles(None, emg.sites, emg.pairs, emg.window, emg.single_sites)
    rate_hz, channels = feed.ring.rate_hz, feed.ring.channels
    loudness = _loudness(emg, rate_hz, channels)
    electrodes = Electrodes(emg.filters, emg.leads, rate_hz, channels)
    found = Muscles(feed, emg.sites, emg.pairs, emg.window, emg.single_sites, loudness, electrodes)
    if emg.recognition:
        found.recognise(Recogniser(emg.recognition, emg.filters, feed))
    return found


def _loudness(emg: Emg, rate_hz: float, channels: int) -> Loudness:
    if emg.envelope == "low_pass":
        return LowPass(emg.envelope_hz, rate_hz, channels)
    mean = Envelope(emg.window)
    return RootMeanSquare(mean) if emg.envelope == "rms" else mean


def mind_of(config: Config) -> Mind:
    """Learners and assist as the config wants them. Raises ConfigError: a question is not one."""
    specs = [joint.spec() for joint in config.joints]
    sites = [site.name for site in config.emg.sites] if config.emg else []
    groups = Groups(specs, {group.name: group.joints for group in config.groups})
    assists = [assist for _, assist in config.helped()]
    recognition = config.emg.recognition if config.emg else None
    if recognition is None:
        return Mind(specs, config.rate_hz, groups, config.learn, assists, sites)
    learn = with_use(config.learn, recognition, config.rate_hz)
    classes = [one.name for one in recognition.classes]
    return Mind(specs, config.rate_hz, groups, learn, assists, sites, classes=classes)


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
        voice=config.voice.describe(),
    )
