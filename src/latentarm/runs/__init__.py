"""A trained run: training, its folder, its task, its evaluation, and people's alignments with it."""
