"""Names, words and tones that tell what the arm does to whoever does not look at it."""
