"""Untrusted input: read within bounds, and displayed without interpreting control characters."""
