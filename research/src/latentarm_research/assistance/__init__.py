"""Published beliefs and kinds of help that the paper's own is compared with, and the bound on help."""
