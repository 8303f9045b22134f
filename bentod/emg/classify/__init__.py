"""Classifiers of windows of muscle signals: training, files of what was trained, and decisions."""
