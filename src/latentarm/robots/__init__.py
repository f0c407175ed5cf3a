"""Robots: their chains, their limits and their shapes."""
