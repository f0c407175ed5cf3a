"""The process that owns the arm: it drives at its own rate on its own clock."""
