"""Joints driven by motor controllers on a CAN bus."""
