"""Features of windows: what a classifier sees of a muscle signal."""
