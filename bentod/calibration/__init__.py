"""How long a joint takes to obey, measured by small steps."""
