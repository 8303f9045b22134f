"""Simulated hardware, simulated people, and the studies that use them."""
