"""The bench measures what it says; how long things take is for people to read, not for a test."""

from latentarm.experiments.bench import run_bench


def test_bench_gives_every_figure_and_equal_losses() -> None:
    rows = {row.measure: row for row in run_bench(repeats=200, seed=0, progress=False, pairs=3000)}
    assert {
        "online_step_median_us",
        "online_step_p99_us",
        "torch_decoder_median_us",
        "batched_fit_s",
        "sequential_fit_s",
        "sequential_over_batched",
    } <= rows.keys()
    assert rows["batched_fit_loss"].mean == rows["sequential_fit_loss"].mean
