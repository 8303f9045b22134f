"""The fault campaign: everything that breaks around an arm in motion, and what the arm did then."""
