"""Tasks with cups on a counter: those of the paper's fourth user study, and the apple pie of its second."""
