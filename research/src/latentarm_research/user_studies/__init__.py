"""The paper's user studies (9.1 to 9.4) and case study (10), as definitions that people go through.

A study is a frozen `definition.Definition` in `definitions`. Simulated people go through it in `session`;
`run.study_of` makes of that a study which `latentarm_research.studies.study` runs. `analysis` knows only the
records of their trials, and `report` only these and the definition.
"""
