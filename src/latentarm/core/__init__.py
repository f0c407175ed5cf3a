"""The foundation of every package: types, errors, catalogues, and bounded reading of files."""
