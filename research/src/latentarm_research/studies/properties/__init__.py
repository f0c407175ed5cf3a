"""`latentarm reproduce properties`: do learned latent actions have the user-friendly properties?"""
