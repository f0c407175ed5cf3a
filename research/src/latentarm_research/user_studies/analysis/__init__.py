"""What records of trials say of hypotheses: tests of people's means, models of all trials, and as printed."""
