"""The texts of a study's pages in each language."""

from functools import cache

from latentarm.web.words.catalogue import Words, languages


@cache
def study_languages() -> dict[str, Words]:
    """Every language of a study's own pages by its code, with the texts of the Drive page."""
    own = languages("latentarm_research.user_studies.serving.words")
    page = languages()
    return {code: Words(code, {**page[code].texts, **words.texts}) for code, words in own.items()}
