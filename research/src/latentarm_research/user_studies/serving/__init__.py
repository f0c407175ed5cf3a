"""Studies with real people: places, the way through a study, its pages, and the drives on the Drive page."""
