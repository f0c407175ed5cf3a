"""Importers of demonstrations: one file per format, and what they share."""
