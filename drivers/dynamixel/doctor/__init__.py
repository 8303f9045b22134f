"""`bentod doctor`: what is on a bus of servos, how fast it is, and what is wrong with it."""
