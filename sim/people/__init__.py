"""Simulated people: operators who see an arm late, steer one joint of it at a time, and make mistakes."""
