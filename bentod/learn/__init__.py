"""Learning, while the arm is in use, what the wearer is about to do."""
