"""One HTML page and one PDF of a study that was run."""
