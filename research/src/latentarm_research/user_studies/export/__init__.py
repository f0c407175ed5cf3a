"""A study as a dataset for other programs, with scripts that reproduce the tables of its report."""
