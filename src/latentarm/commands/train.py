"""`latentarm train`: a latent action model from a dataset."""

from latentarm.commands.configuration import write_options
from latentarm.commands.output import note, say, show
from latentarm.runs.options import TrainOptions


def train(options: TrainOptions) -> int:
    """Learn a latent action model from a dataset.

    For example: latentarm train --demonstrations pour --model cae --latent-dim 2 --seeds 5
    """
    from latentarm.models.training import epoch_bar
    from latentarm.runs.advice import model_advice
    from latentarm.runs.training import train_run

    with epoch_bar(options.bars) as report:
        training = train_run(options, report)
    folder, json = options.folder, options.json
    write_options(folder, "train", context=training.context)
    note(training.import_warnings)
    show(training.rows, json)
    if options.context is None and training.objects:
        things = ", ".join(training.objects)
        say(
            f"The decoder also sees where the {things} are, and is driven only where that is known. To train"
            " one that sees the joints alone: --context joints.",
            json,
        )
    if advice := model_advice(options.model, training.episodes):
        say(advice, json)
    say(f"The run is {folder}/; next: latentarm evaluate {folder}", json)
    return 0
