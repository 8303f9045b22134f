"""How far a prediction can be believed (thesis 6.1), each measure cheap enough for every tick."""
