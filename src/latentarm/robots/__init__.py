"""The robots that can be driven: their chains, their limits and their shapes."""
