"""The dataset on disk, importers, validation, context-action pairs, and summaries."""
