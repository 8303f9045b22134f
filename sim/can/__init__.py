"""Simulated motor controllers on a CAN bus, with a codec of their own."""
