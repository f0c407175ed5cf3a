"""What is measured of simulated drives, and of decoders beyond `latentarm evaluate`."""
