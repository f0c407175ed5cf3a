"""The paper's network f and its priors (equations 19 to 23); the page learns by a Gaussian process."""
