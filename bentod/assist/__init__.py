"""Predictions turned into motion of the joints nobody attends to."""
