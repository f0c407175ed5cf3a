"""Reproduce the tables of a study's report from the CSV files of its dataset alone.

Usage: python analysis/tables.py [FOLDER]; the tables go to FOLDER, by default results/ of the dataset.
It needs numpy, pandas, scipy and statsmodels. analysis/tables.R does the same in R.
"""

import sys
import warnings
from itertools import combinations, product
from math import comb
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.special import gammaln, nctdtrinc
from scipy.stats import f as f_distribution
from scipy.stats import t as t_distribution
from statsmodels.regression.linear_model import OLS
from statsmodels.regression.mixed_linear_model import MixedLM

DATASET = Path(__file__).resolve().parents[1]
LEVEL, TAIL = 0.05, 0.025
MOST_EXACT = 13  # people up to whom every swap of two conditions is tried
MOST_GROUPS = 20_000  # ways to form two groups, up to which every one is tried
DRAWS, SEED = 9999, 17  # of random ones, where there are more
NAN = float("nan")


def read(name: str) -> Any:
    """A table of the dataset."""
    (path,) = (DATASET / "data").glob(f"*_description-{name}_data.csv")
    return pd.read_csv(path, keep_default_na=False, na_values=[""])


def spreads(values: Any) -> bool:
    """True if values differ by more than rounding."""
    return len(values) > 1 and np.std(values, ddof=1) > 1e-9 * np.abs(values).max()


def cell_means(trials: Any, measure: str, tasks: list[str]) -> Any:
    """Means over trials, then over tasks, by person and condition; NaN where a task has no figure."""
    cells = trials.groupby(["person", "condition", "task"])[measure].mean().unstack("task")
    return cells.reindex(columns=tasks).mean(axis=1, skipna=False)


def side_means(trials: Any, measure: str, conditions: list[str], tasks: list[str]) -> Any:
    """Each person's mean over some conditions; NaN where one of them has no figure."""
    if not tasks:
        return pd.Series(dtype=float)
    means = cell_means(trials, measure, tasks).unstack("condition").reindex(columns=conditions)
    return means.mean(axis=1, skipna=False)


def results(trials: Any, measures: list[str]) -> Any:
    """Mean and SD over people, for each task, condition and measure."""
    rows = []
    for task, condition, measure in product(trials.task.unique(), trials.condition.unique(), measures):
        means = side_means(trials, measure, [condition], [task]).dropna()
        if len(means):
            rows.append([task, condition, measure, len(means), means.mean(), means.std()])
    return pd.DataFrame(rows, columns=["task", "condition", "measure", "n", "mean", "sd"])


def scores_of(answers: Any) -> tuple[Any, Any]:
    """The scales by condition, with Cronbach's alpha and its interval (Feldt 1965); and people's scores."""
    rows, scores = [], []
    answers = answers.assign(
        turned=np.where(answers.reversed == 1, answers.points + 1 - answers.answer, answers.answer)
    )
    items = answers.groupby("scale").item.unique()
    for (scale, condition), given in answers.groupby(["scale", "condition"]):
        table = given.pivot(index="person", columns="item", values="turned").reindex(columns=items[scale])
        table = table.dropna()
        score = table.mean(axis=1)
        n, k = table.shape
        alpha = low = high = NAN
        if n > 1 and k > 1 and table.sum(axis=1).var() > 0:
            alpha = k / (k - 1) * (1 - table.var().sum() / table.sum(axis=1).var())
            ends = f_distribution.ppf([1 - TAIL, TAIL], n - 1, (n - 1) * (k - 1))
            low, high = 1 - (1 - alpha) * ends
        rows.append([scale, condition, n, score.mean(), score.std(), alpha, low, high])
        scores += [[person, condition, scale, value] for person, value in score.items()]
    columns = ["scale", "condition", "n", "mean", "sd", "alpha", "alpha_low", "alpha_high"]
    long = pd.DataFrame(scores, columns=["person", "condition", "scale", "score"])
    wide = long.pivot(index=["person", "condition"], columns="scale", values="score").reset_index()
    return pd.DataFrame(rows, columns=columns), wide.assign(task="questionnaire", trial=0)


def options_of(options: Any) -> Any:
    """People who chose each option by condition, and people who answered the question."""
    groups = options.groupby(["item", "condition", "option"], sort=False)
    return groups.chosen.agg(n="size", chosen="sum").reset_index()


def two_sides(trials: Any, claim: Any, subject: list[str], against: list[str], tasks: list[str]) -> Any:
    """People's means on both sides; within people those of the same people."""
    if claim.design == "within":
        both = [side_means(trials, claim.measure, side, tasks) for side in (subject, against)]
        both = pd.concat(both, axis=1).dropna()
        return both[0].to_numpy(), both[1].to_numpy()
    means = cell_means(trials, claim.measure, tasks).dropna().reset_index(name="mean")
    return tuple(means["mean"][means.condition.isin(side)].to_numpy() for side in (subject, against))


def tested(claim: Any, one: Any, other: Any) -> dict[str, Any]:
    """The t-test of a claim, and its effect size."""
    if claim.design == "within":
        if len(one) < 2 or not spreads(one - other):
            return {}
        values = one - other
        n, dof, size = len(values), len(values) - 1, len(values) - 1
        difference, se = values.mean(), values.std(ddof=1) / np.sqrt(n)
        d, root = difference / values.std(ddof=1), np.sqrt(n)
    else:
        n, m = len(one), len(other)
        if min(n, m) < 2 or not (spreads(one) or spreads(other)):
            return {}
        parts = one.var(ddof=1) / n, other.var(ddof=1) / m
        difference, se = one.mean() - other.mean(), np.sqrt(sum(parts))
        dof = sum(parts) ** 2 / (parts[0] ** 2 / (n - 1) + parts[1] ** 2 / (m - 1))
        size, root = n + m - 2, np.sqrt(n * m / (n + m))
        d = difference / np.sqrt(((n - 1) * one.var(ddof=1) + (m - 1) * other.var(ddof=1)) / size)
    reach, t = se * t_distribution.ppf(1 - TAIL, dof), difference / se
    if claim.direction == "equal":
        p = t_distribution.cdf((abs(difference) - claim.margin) / se, dof)
    else:
        p = 2 * t_distribution.sf(abs(t), dof)
    correction = np.exp(gammaln(size / 2) - gammaln((size - 1) / 2)) / np.sqrt(size / 2) if size > 1 else NAN
    return {
        "difference": difference, "low": difference - reach, "high": difference + reach, "t": t, "dof": dof,
        "p": p, "d": d, "g": d * correction, "d_low": nctdtrinc(size, 1 - TAIL, d * root) / root,
        "d_high": nctdtrinc(size, TAIL, d * root) / root,
    }  # fmt: skip


def compared(trials: Any, claim: Any, subject: list[str], against: list[str], tasks: list[str]) -> Any:
    """All trials that a claim compares: value, label, person from 0, and what is held fixed."""
    rows = trials[
        trials.condition.isin([*subject, *against]) & trials.task.isin(tasks) & trials[claim.measure].notna()
    ]
    if claim.design == "within":
        met = [set(rows.person[rows.condition.isin(side)]) for side in (subject, against)]
        rows = rows[rows.person.isin(met[0] & met[1])]
    label = np.where(rows.condition.isin(subject), 0.5, -0.5)
    fixed = np.column_stack([rows.order, rows.trial, *(rows.task == task for task in tasks[1:])]).astype(
        float
    )
    fixed = fixed - fixed.mean(axis=0) if len(rows) else fixed
    person = np.unique(rows.person, return_inverse=True)[1]
    value = rows[claim.measure].to_numpy()
    return value, label, person, fixed[:, np.abs(fixed).max(axis=0, initial=0) > 0]


def mixed(value: Any, label: Any, person: Any, fixed: Any) -> dict[str, float]:
    """The condition's effect in a linear mixed model with a random intercept for each person (REML)."""
    people = person.max() + 1 if len(person) else 0
    design = np.column_stack([np.ones(len(value)), label, fixed])
    if people < 2 or len(value) == people or not spreads(value):
        return {}
    if np.linalg.matrix_rank(design) < design.shape[1] or design.shape[1] >= len(design):
        return {}
    scale = value.std(ddof=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fitted: Any = MixedLM(value / scale, design, groups=person).fit(
            reml=True, method=["bfgs", "powell"], gtol=1e-9
        )
    # Not the standard error of statsmodels, which inverts the information on all parameters together.
    own = (person[:, None] == np.arange(people)).astype(float)
    person_variance = max(float(np.asarray(fitted.cov_re).ravel()[0]), 0)
    shrink = person_variance / (fitted.scale + own.sum(axis=0) * person_variance)
    sums = own.T @ design
    information = design.T @ design - sums.T @ (shrink[:, None] * sums)
    se = np.sqrt(fitted.scale * np.linalg.inv(information)[1, 1])
    return {"estimate": scale * fitted.fe_params[1], "se": scale * se}


def swapped_p(value: Any, label: Any, person: Any, fixed: Any) -> float:
    """The p of the condition's t when the two sides of any person are swapped."""
    people = person.max() + 1 if len(person) else 0
    if people < 2 or not spreads(value):
        return NAN
    own = (person[:, None] == np.arange(people)).astype(float)
    held = np.column_stack([own, fixed])
    basis, size, _ = np.linalg.svd(held, full_matrices=False)
    basis = basis[:, size > 1e-9 * size.max()]
    left = value - basis @ (basis.T @ value)
    labels = own * label[:, None]
    labels = labels - basis @ (basis.T @ labels)
    dof = len(value) - basis.shape[1] - 1
    if dof < 1 or np.square(labels.sum(axis=1)).sum() < 1e-9:
        return NAN
    if people <= MOST_EXACT:
        swaps = np.where((np.arange(2 ** (people - 1))[:, None] >> np.arange(people)) & 1, -1.0, 1.0)
    else:
        drawn = np.random.default_rng(SEED).choice([-1.0, 1.0], (DRAWS, people))
        swaps = np.concatenate([np.ones((1, people)), drawn])
    square = np.einsum("kp,pq,kq->k", swaps, labels.T @ labels, swaps)
    explained = np.where(square > 1e-9, (swaps @ (labels.T @ left)) ** 2 / np.maximum(square, 1e-9), 0)
    size = np.sqrt(explained / np.maximum(left @ left - explained, 1e-9 * left @ left) * dof)
    return float((size >= size[0] * (1 - 1e-9)).mean())


def permuted_p(one: Any, other: Any) -> float:
    """The p of Welch's t when people are permuted between two groups."""
    pooled = np.concatenate([one, other])
    n, m = len(one), len(other)
    if min(n, m) < 2 or not spreads(pooled):
        return NAN
    pooled = pooled - pooled.mean()
    if comb(n + m, n) <= MOST_GROUPS:
        groups = np.zeros((comb(n + m, n), n + m), dtype=bool)
        np.put_along_axis(groups, np.array(list(combinations(range(n + m), n))), True, axis=1)
    else:
        own = np.arange(n + m) < n
        drawn = np.random.default_rng(SEED).permuted(np.tile(own, (DRAWS, 1)), axis=1)
        groups = np.concatenate([own[None], drawn])
    means, errors = [], []
    for inside, count in ((groups.astype(float), n), ((~groups).astype(float), m)):
        mean = inside @ pooled / count
        spread = np.maximum(inside @ np.square(pooled) - count * np.square(mean), 0)
        means.append(mean)
        errors.append(spread / (count - 1) / count)
    size = np.abs(
        (means[0] - means[1]) / np.sqrt(np.maximum(errors[0] + errors[1], 1e-9 * (pooled**2).mean()))
    )
    return float((size >= size[0] * (1 - 1e-9)).mean())


def holm(p: Any) -> Any:
    """Holm's correction (1979); NaN does not count."""
    known = p[p.notna()].sort_values()
    stepped = (known * np.arange(len(known), 0, -1)).cummax().clip(upper=1)
    return stepped.reindex(p.index)


def claims_table(trials: Any, claims: Any, sides: Any) -> Any:
    """Every claim, tested on people's means and in a model of all trials."""
    rows = []
    for claim in claims.itertuples():
        theirs = sides[sides.claim == claim.claim]
        subject, against, tasks = (
            list(theirs.name[theirs.kind == kind]) for kind in ("subject", "against", "task")
        )
        known = trials[claim.measure].notna() if claim.measure in trials else trials.person < 0
        tasks = tasks or list(trials.task[known].unique())
        row: dict[str, Any] = {
            "hypothesis": claim.hypothesis,
            "measure": claim.measure,
            "n": 0,
            "n_against": 0,
        }
        if tasks and claim.measure in trials:
            one, other = two_sides(trials, claim, subject, against, tasks)
            table = compared(trials, claim, subject, against, tasks)
            p = swapped_p(*table) if claim.design == "within" else permuted_p(one, other)
            row |= {"n": len(one), "n_against": len(other)}
            if len(one):
                row |= {"mean": one.mean(), "sd": one.std(ddof=1) if len(one) > 1 else NAN}
            if len(other):
                row |= {
                    "mean_against": other.mean(),
                    "sd_against": other.std(ddof=1) if len(other) > 1 else NAN,
                }
            row |= {**tested(claim, one, other), **mixed(*table), "p_randomisation": p}
        rows.append(row)
    columns = (
        "hypothesis measure n n_against mean sd mean_against sd_against difference low high t dof p p_holm"
        " d g d_low d_high estimate se p_randomisation"
    )
    table = pd.DataFrame(rows, columns=columns.split())
    return table.assign(p_holm=holm(table.p))


def anova_table(trials: Any, claims: Any, sides: Any, factors: Any) -> Any:
    """Analysis of variance of a 2 x 2 design, for each measure that a claim is about."""
    rows = []
    names = list(factors.factor.unique())
    level = {
        name: {one.condition: one.level - 1.5 for one in factors[factors.factor == name].itertuples()}
        for name in names
    }
    for measure, theirs in claims.groupby("measure", sort=False) if names else ():
        claim = list(theirs.itertuples())[-1]
        tasks = list(sides.name[(sides.claim == claim.claim) & (sides.kind == "task")])
        tasks = tasks or (list(trials.task[trials[measure].notna()].unique()) if measure in trials else [])
        if not tasks:
            continue
        means = cell_means(trials, measure, tasks).dropna().reset_index(name="mean")
        if means.empty:
            continue
        first, second = (means.condition.map(level[name]) for name in names)
        contrasts = {names[0]: first, names[1]: second, f"{names[0]} x {names[1]}": first * second}
        if claim.design == "within":
            whole = means.groupby("person")["mean"].transform("size") == len(level[names[0]])
            if means.person[whole].nunique() < 2 or not spreads(means["mean"][whole]):
                continue
            for name, weight in contrasts.items():
                of_people = (means["mean"] * weight)[whole].groupby(means.person[whole]).sum()
                dof = len(of_people) - 1
                f = len(of_people) * of_people.mean() ** 2 / of_people.var() if of_people.var() else NAN
                rows.append([measure, name, f, 1, dof])
        else:
            dof = len(means) - 4
            if dof < 1 or means.condition.nunique() < 4 or not spreads(means["mean"]):
                continue
            fitted: Any = OLS(
                means["mean"].to_numpy(), np.column_stack([np.ones(len(means)), *contrasts.values()])
            ).fit()
            rows += [
                [measure, name, t**2, 1, dof] for name, t in zip(contrasts, fitted.tvalues[1:], strict=True)
            ]
    if not rows:
        return pd.DataFrame()
    table = pd.DataFrame(rows, columns=["measure", "effect", "f", "dof", "dof_error"]).dropna()
    return table.assign(
        p=f_distribution.sf(table.f, table.dof, table.dof_error), eta=table.f / (table.f + table.dof_error)
    )


def main(out: Path) -> None:
    """Write all tables."""
    every, claims, sides, factors = (read(name) for name in ("trials", "claims", "sides", "factors"))
    known = {"person", "condition", "task", "order", "trial", "excluded"}
    measures = [name for name in every if name not in known]
    trials = every[every.excluded.isna()]
    tables = {"results": results(trials, measures)}
    answers = read("answers")
    if len(answers):
        tables["scales"], scores = scores_of(answers)
        order = every.drop_duplicates(["person", "condition"])[["person", "condition", "order"]]
        scores = scores.merge(order, on=["person", "condition"])
        trials = pd.concat([trials, scores[scores.person.isin(trials.person)]])
    if len(options := read("options")):
        tables["options"] = options_of(options)
    tables["claims"] = claims_table(trials, claims, sides)
    tables["anova"] = anova_table(trials, claims, sides, factors)
    out.mkdir(parents=True, exist_ok=True)
    for name, table in tables.items():
        if not len(table.columns):
            continue
        table.to_csv(out / f"{name}.csv", index=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else DATASET / "results")
