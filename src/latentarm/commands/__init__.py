"""One module for each command of `latentarm`: its options, and what it calls and prints."""
