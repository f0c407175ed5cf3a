"""Shared autonomy: what the person may want (belief), how to help, and how much."""
