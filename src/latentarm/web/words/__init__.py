"""The texts of the pages: one JSON file per language."""
