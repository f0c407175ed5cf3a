"""The studies: the paper's three simulations, and all models on recorded demonstrations.

A study is a package with these modules:

- ``preset.py``: a frozen dataclass of sizes, and ``PRESETS``, at least ``paper`` and ``smoke``.
- ``cell.py``: a frozen cell that carries everything it depends on, its seed too, and a function that
  measures it. Models are fitted by `fitting.fit_model`, randomness comes from `streams`.
- ``hypotheses.py``: each `claims.Hypothesis`, what came of its claims as `claims.Tested`, and targets, as
  `targets.Target`. `claim_tables` shows them on a page.
- ``tables.py``, ``figures.py`` and ``page.md``: tables by `tables`, drawings by `drawing`, and the page as a
  Jinja template (`page.render_page`). Figures of runs are `tables.Series`, of which rows are made.
- ``study.py``: ``STUDY``, a `study.Study`: which grids of cells are run, and the `study.Report` on them.

`study.run_study` does the rest, the same for all of them: it claims the folder, runs the grids and writes
``results.json``, ``results.md``, ``report.html`` and ``report.pdf`` of it, ``hypotheses.json``,
``timings.json``, the study's own documents and its figures. ``latentarm reproduce`` offers every study of
`catalogue.STUDIES`. A user study runs the same way: see `latentarm_research.user_studies.run.study_of`.
"""
