"""The words of the pages: one JSON file for each language."""
