/** How a training stands, in words, and what a new run may be called. */

import { say, sayNumber } from "../layout/words.js";

/** @import {Training} from "../connection/messages.js" */

/** Whether a training is under way. @param {Training | null} training */
export function isBusy(training) {
  return training?.phase === "exporting" || training?.phase === "training";
}

/** How much of it is done, percent. @param {Training} training */
export function progressShare({ phase, epoch, epochs }) {
  if (phase === "done") return 100;
  return epochs ? Math.round((100 * epoch) / epochs) : 0;
}

/** How long it will take, for everybody. @param {Training} training */
export function leftWords({ phase, seconds_left }) {
  if (phase === "exporting") return say("training.exporting_text");
  return seconds_left === null ? "" : say("training.seconds_left", { seconds: Math.ceil(seconds_left) });
}

/** How far it is, in figures. @param {Training} training */
export function progressWords({ phase, epoch, epochs, loss }) {
  const parts = [];
  if (epochs && phase === "training") parts.push(say("training.pass_of", { epoch, epochs }));
  if (epochs && phase === "done") parts.push(say(epoch < epochs ? "training.passes_until" : "training.passes", { count: epoch }));
  if (loss !== null) parts.push(say("training.loss", { loss: sayNumber(loss, 3) }));
  return parts.join(" · ");
}

/** A name that no run has: what is written, or the next number once a run was trained under it. @param {string} written @param {LearningState} learning */
export function freeName(written, { runs, training }) {
  const used = training?.phase === "done" && training.run === written;
  if (written && !used) return written;
  const stem = (written || say("teach.first_name")).replace(/-\d+$/, "");
  let number = 1;
  while (runs.includes(`${stem}-${number}`)) number += 1;
  return `${stem}-${number}`;
}
