from hypothesis import settings

# On a busy machine a single example may take long without anything being wrong.
settings.register_profile("latentarm", deadline=None)
settings.register_profile("thorough", max_examples=10_000, deadline=None)
settings.load_profile("latentarm")
