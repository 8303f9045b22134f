"""Muscle signals between a source and the controller."""
