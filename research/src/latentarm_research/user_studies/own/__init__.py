"""Studies that a laboratory defines itself, in a JSON file: read strictly, and checked before a run."""
