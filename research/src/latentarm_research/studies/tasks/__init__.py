"""Tasks with things, in physics: a scripted demonstrator, and simulated people who drive."""
