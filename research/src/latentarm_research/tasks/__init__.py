"""Tasks of the paper's simulations, at which no arm is driven on the page."""
