"""The daemon: from muscle to motion."""
