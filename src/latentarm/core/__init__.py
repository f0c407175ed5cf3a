"""What every other package stands on: types, errors, catalogues, and bounded reading of files."""
