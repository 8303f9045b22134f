"""What makes one simulated operator: every number with its source, or marked as assumed.

Sources by short name:
  Saunders & Knill 2005 -- Exp Brain Res 162:458: corrections of a reach begin 117 ms (direction) and
    130 to 200 ms (distance) after the seen hand was shifted.
  van de Kamp 2013 -- PLoS Comput Biol 9(1):e1002843: in manual control a second response waits for
    250, 350, 550 ms after the first (system of order 0, 1, 2). Driving a velocity is order 1.
  Miall 1993 -- J Mot Behav 25(1):53: an error below 0.8 degrees at the eye starts no correction.
  Jones 2002 -- J Neurophysiol 88:1533: the noise of a force grows with the force.
  Sensinger 2015 -- PLoS One 10(8):e0136251: myoelectric control has large multiplicative noise.
  Card 1980 -- Comm ACM 23(7):396: pressing a button takes 0.08 (best) to 0.28 s (unpractised), and to
    prepare a step mentally 1.35 s.
  Hick 1952, Hyman 1953 -- a choice between two takes 0.35 to 0.45 s, and nearly nothing when it was
    made beforehand.
  Welford 1980 -- simple reaction to sound 0.14 to 0.16 s.
  Rabbitt 1966 -- after an error people are slower for a while.
  Yang 2021 -- Hum Factors 65(5):862: a failure of automation moves trust more than a success does.
  Sherstan 2015 -- the thesis, sections 5.5 and 5.6.6, appendix B.
Saunders & Knill, van de Kamp, Miall, Sensinger and Yang were read as abstracts, Card in a summary; Jones,
Hick, Hyman, Welford and Rabbitt are cited as they are commonly quoted, and were not looked up. Margins,
trust, surprise, lenience and confusion were adjusted until the circuits of Table B.1 came out about right
(like the author with seeds 1 and 2, naive with seed 1, at 10 steps), so they cannot confirm it.
No measured time of toggling between joints was found; no source gives numbers for how people take to an
arm that moves by itself. What is said of that here is assumed, in a direction that the thesis describes.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Senses:
    """How late and how well the arm and the sounds are noticed."""

    visual_delay: float = 0.17  # s, Saunders & Knill 2005
    hearing: float = 0.16  # s from a sound to the hand, Welford 1980
    voice: float = 0.45  # s from a toggle until the joint's spoken name is understood; assumed
    blur: float = 0.003  # rad, standard deviation of a position as seen; assumed
    prediction: float = 0.8  # share of one's own motion within the delay that one foresees, 0..1; assumed


@dataclass(frozen=True, slots=True)
class Hands:
    """How an intention becomes effort."""

    interval: float = 0.35  # s between two decisions, van de Kamp 2013
    lag: float = 0.07  # s, time constant from intent to effort; assumed
    noise: float = 0.08  # share of the effort, drawn anew with every push; Jones 2002, size assumed
    tremor: float = 0.02  # share of the effort, in every tick; assumed
    misjudgement: float = 0.1  # sd of the share by which a push is too long or too short; assumed
    fine: float = 0.05  # rad, shorter pushes are made more slowly; assumed
    least: float = 0.35  # effort of the gentlest push; assumed


@dataclass(frozen=True, slots=True)
class Switching:
    """What it costs to change the joint, and what goes wrong."""

    choice: float = 0.40  # s to choose the other joint, Hick 1952, Hyman 1953
    foresight: float = 0.5  # share of pushes whose end and toggle are prepared while pushing; assumed
    press: float = 0.20  # s, Card 1980
    scatter: float = 0.2  # standard deviation of the logarithm of these times; assumed
    missed: float = 0.01  # chance that a press does nothing; assumed
    double: float = 0.01  # chance that it counts twice; assumed
    wrong: float = 0.005  # chance to toggle although the joint is the right one; assumed


@dataclass(frozen=True, slots=True)
class Caution:
    """How the task is gone about."""

    margin: float = 0.026  # rad kept to walls where there is a choice; assumed
    scatter: float = 0.005  # rad, standard deviation of it from leg to leg; assumed
    worth: float = 0.008  # rad; a smaller gain is not gone for, Miall 1993 (0.8 degrees are 0.014 rad)
    error_pause: float = 0.35  # s without a decision after a wall was touched; Rabbitt 1966, size assumed
    lenience: float = 0.5  # 0..1, how far trust lets light touches pass while the arm helps; assumed (5.5)


@dataclass(frozen=True, slots=True)
class Autonomy:
    """How an arm that moves by itself is taken: every number is assumed."""

    trust: float = 0.1  # 0..1, at first: no trust stops at every surprise, full trust lets it happen
    up: float = 0.015  # share of what is missing to full trust that a help gives
    down: float = 0.04  # share of the trust that a harm takes: above `up`, Yang 2021
    notice: float = 0.015  # rad of motion that was not expected, at which one looks up
    wait: float = 2.0  # s of looking, at no trust
    confusion: float = 0.6  # chance to lose the joint in a correction, while both move (thesis 5.6.6)
    realise: float = 0.5  # s of driving the wrong joint until that is noticed; twice that while both move
    habit: float = 4.0  # assisted circuits that take surprise and confusion down to 1/e
    experience: float = 0.0  # assisted circuits before the session
    learning: float = 1.0  # s in which the expectation of the arm's own motion follows what it does
    careful: float = 0.5  # share of the full effort that is not dared while the arm is strange
    easing: float = 0.5  # share of decisions in which one slows down to let the other joint come along


@dataclass(frozen=True, slots=True)
class Traits:
    """One operator. The same traits and seed give the same person."""

    name: str
    senses: Senses = Senses()
    hands: Hands = Hands()
    switching: Switching = Switching()
    caution: Caution = Caution()
    autonomy: Autonomy = Autonomy()


NAIVE = Traits("naive")
"""Somebody after the 20 circuits of familiarisation, whom the arm has never helped (subjects A to C)."""

PRACTISED = Traits(
    "practised",
    Senses(prediction=0.9),
    Hands(noise=0.06, misjudgement=0.07),
    Switching(choice=0.3, foresight=0.85, press=0.12),
    Caution(margin=0.018, scatter=0.004, error_pause=0.3, lenience=0.7),
    Autonomy(trust=0.2, wait=1.5, confusion=0.5),
)
"""Somebody quick with a joystick, whom the arm has never helped."""

AUTHOR = Traits(
    "author",
    Senses(prediction=0.97, blur=0.0015),
    Hands(noise=0.04, misjudgement=0.03, tremor=0.015),
    Switching(choice=0.2, foresight=0.98, press=0.08, missed=0.003, double=0.003, wrong=0.001),
    Caution(margin=0.013, scatter=0.002, error_pause=0.2, lenience=1.0),
    Autonomy(trust=0.85, wait=0.3, confusion=0.15, experience=50.0, easing=0.95, learning=0.4),
)
"""Somebody with hundreds of circuits behind them, dozens of them with help (Sherstan 2015, 5.5)."""
