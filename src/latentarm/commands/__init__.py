"""One module for each command of `latentarm`, with its options, calls and messages."""
