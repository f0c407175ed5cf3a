"""Records of the page's server: people, and all their drives."""
