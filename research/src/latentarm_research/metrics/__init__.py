"""Measures of simulated drives, and of decoders beyond `latentarm evaluate`."""
