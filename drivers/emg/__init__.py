"""Sources of muscle signals."""
