"""What recognition asks is passed on as muscles that work, until a lead is off that no site watches."""

from dataclasses import replace

import numpy as np

from bentod.config_conditioning import Leads
from bentod.emg.electrodes import Electrodes
from bentod.muscles import Look, Muscles
from tests.emg.live.signals import ELECTRODES, FILTERS, RATE_HZ
from tests.emg.live.test_recogniser import Rig


class Worn(Rig):
    """A rig whose recogniser is a part of muscles without a site."""

    def __init__(self) -> None:
        super().__init__()
        electrodes = Electrodes(FILTERS, Leads(), RATE_HZ, ELECTRODES)
        self.muscles = Muscles(self.feed, electrodes=electrodes)
        self.muscles.recognise(self.recogniser)

    def hold(self, label: str, hum_v: float = 0.0) -> Look:
        """What muscles say after a second of it, one channel of which hums."""
        self.person.prompt(label)
        for _ in range(33):
            samples = self.person.read(self.index, 30).copy()
            at = np.arange(self.index, self.index + 30) / RATE_HZ
            samples[:, 3] += (hum_v * np.sin(2 * np.pi * 50 * at)).astype(np.float32)
            self.put(samples)
            look = self.muscles.look(self.index / RATE_HZ)
        return look


def test_a_movement_is_asked_for_until_a_lead_comes_off() -> None:
    rig = Worn()
    rig.hold("rest")
    assert rig.hold("pronation").efforts["hand"] > 0
    look = rig.hold("pronation", hum_v=5e-3)
    assert not look.efforts.get("hand")
    assert look.frame.recognition is not None
    assert "hum of 50 Hz" in look.frame.recognition.reason
    assert "channel 3" in look.frame.recognition.reason


def test_who_is_not_sure_what_muscles_do_does_not_take_them_for_being_at_rest() -> None:
    rig = Worn()
    assert not rig.hold("rest").asked.tense
    rig.hold("pronation")
    assert rig.recogniser.newest is not None
    rig.recogniser.newest = replace(rig.recogniser.newest, label="rest", speed=0.0, rejected=True)
    asked = rig.muscles.look(rig.index / RATE_HZ).asked
    assert (asked.efforts, asked.tense) == ({"hand": 0.0}, {"hand"})
