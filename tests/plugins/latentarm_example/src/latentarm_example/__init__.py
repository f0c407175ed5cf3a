"""What a distribution adds to latentarm: a model, a task, an arm and a belief, in one module each."""
