"""Measurements behind figures of the documentation: a module with a function ``measure`` for each."""
