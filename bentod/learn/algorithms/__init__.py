"""Learners of one general value function each, one file an algorithm; for many, `bentod.learn.group`."""
