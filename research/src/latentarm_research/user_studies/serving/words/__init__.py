"""The texts of a study's own pages: one JSON file per language."""
