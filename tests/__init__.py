"""Tests: sentences as names, virtual time, real bytes."""
