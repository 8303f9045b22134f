"""Dynamixel servos in joint mode."""
