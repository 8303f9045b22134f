"""How late ticks begin on this machine: ways to tick, a load to tick under, and what is said of it."""
