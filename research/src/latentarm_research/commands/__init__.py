"""The commands that the research distribution adds to the command line."""
