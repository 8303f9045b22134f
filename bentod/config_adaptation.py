"""The tables of the config that let recognition learn in use: adaptation, and fusion with predictions."""

from typing import Annotated, TypeAlias

from pydantic import Field

from bentod.config_base import Table

Share: TypeAlias = Annotated[float, Field(ge=0, le=1)]


class Adaptation(Table):
    """How a classifier follows the wearer, and how far."""

    rate: Annotated[float, Field(gt=0, le=0.5)] = 0.35
    """How far a class goes towards what one confirmed contraction showed of it."""
    sure: Share = 0.8
    """Least mean probability of a contraction that is learned from."""
    dissent: Annotated[float, Field(ge=0, le=0.5)] = 0.2
    """Greatest share of its windows that look like another class."""
    least_s: Annotated[float, Field(ge=0.2, le=10)] = 0.8
    """How long it must last: a wearer who sees the arm go wrong lets go before."""
    confirm_s: Annotated[float, Field(ge=0, le=10)] = 0.6
    """For how long after it no other movement may begin, for that would be a correction."""
    bound: Annotated[float, Field(gt=0, le=10)] = 1.5
    """How far a class may go from where it was trained: as a share of how far its nearest neighbour was."""
    apart: Share = 0.5
    """Least share of the trained distance that any two classes keep."""
    trouble: Share = 0.3
    """Share of calm contractions below which an earlier state is gone back to, if that is as sure."""


class Fusion(Table):
    """How much what is predicted counts in what is recognised: thesis 6.2, (6.6)."""

    beta: Annotated[float, Field(ge=0, le=0.5)] = 0.3
    """The greatest weight of a prediction, with a confidence of 1. Muscles that are sure outweigh it."""
    softness: Annotated[float, Field(ge=1, le=20)] = 1.0
    """L is taken to the power of 1 / this, as classifiers are surer than they are right. 1: (6.6) itself."""
    timescale_s: Annotated[float, Field(gt=0, le=10)] = 0.5
    """How far ahead the use of each class is predicted."""
