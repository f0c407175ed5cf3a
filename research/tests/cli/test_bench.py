"""The bench measures what it says; how long things take is for people to read, not for a test."""

import pytest

from latentarm_research.commands import bench_step as bench


def test_bench_gives_every_figure_and_equal_losses(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("SEEDS", 3), ("EPOCHS", 2), ("WARM_UP", 50), ("PLAIN_RUNS", 1)):
        monkeypatch.setattr(bench, name, value)
    all_rows = bench.run_bench(repeats=70, seed=0, progress=False, pairs=300)
    rows = {row.measure: row for row in all_rows if row.condition is None}
    assert {
        "online_step_median_us",
        "online_step_p99_us",
        "torch_decoder_median_us",
        "batched_fit_s",
        "sequential_fit_s",
        "sequential_over_batched",
    } <= rows.keys()
    # In single precision, and some processors add in another order where matrices are stacked. The losses of
    # other seeds differ by percents.
    assert rows["batched_fit_loss"].mean == pytest.approx(rows["sequential_fit_loss"].mean, rel=1e-4)
    many = {row.measure: row for row in all_rows if row.condition == "50 goals"}
    assert {"online_step_median_us", "online_step_p99_us"} <= many.keys()
    assert rows["online_step_median_us"].n == many["online_step_median_us"].n == 70
    ratio = many["online_step_median_us"].mean / rows["online_step_median_us"].mean
    assert many["online_step_over_3_goals"].mean == ratio
    led = {row.measure: row for row in all_rows if row.condition == "way back"}
    layers = rows["torch_layers_median_us"].mean
    assert led["online_step_median_us"].n == 70
    assert led["online_step_over_torch_layers"].mean == led["online_step_median_us"].mean / layers
    plain = {row.measure: row for row in all_rows if row.condition and row.condition.startswith("cAE, 30-30")}
    ratio = 3 * plain["plain_run_s"].mean / plain["fit_of_3_seeds_s"].mean
    assert plain["plain_run_over_fit_per_seed"].mean == ratio
    assert plain["plain_run_to_that_loss_s"].mean <= plain["plain_run_s"].mean
