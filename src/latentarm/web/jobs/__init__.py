"""Slow work in child processes: training, and asking a person what they mean by their input."""
