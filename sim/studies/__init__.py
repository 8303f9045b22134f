"""Experiments of the thesis: simulated worlds and people, the daemon's learners, and what must come out."""
