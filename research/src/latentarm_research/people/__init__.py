"""Simulated people who give inputs: for tests, figures and tuning, never a substitute for real ones."""
