"""A figure for each task, after the paper's."""
