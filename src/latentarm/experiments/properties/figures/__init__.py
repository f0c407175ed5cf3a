"""Figures of section 8.1: the paper's figures 5 to 8 on simulated arms, noise, and the paper beside ours."""
