"""Drives as they are recorded: journals, their export to datasets and MCAP files."""
