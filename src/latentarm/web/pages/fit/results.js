/** What was measured, with today's setting, the proposed one and the reason for it, in words; and what has changed since last time. */

import { DIRECTIONS } from "../inputs/deflection.js";
import { say, sayList, sayNumber, sayPercent } from "../layout/words.js";
import { sayTime } from "../records/ask.js";
import { Hold, Trials } from "./exercises.js";
import { acceptFor, deadZoneFor, driftOf, dwellFor, quantile, reachFor, releaseFor, settled, shakingOf, STEADY, tremorFor } from "./measures.js";

/** @typedef {{key: keyof typeof KINDS, value: number, measured?: string, proposed?: string | number, why?: WordKey}} Finding `measured` and `why` where they are not the usual ones */
/** @typedef {{words: (value: any) => string, least: number, setting?: "deadZone" | "tremor" | "reach" | "dwellS" | "acceptS" | "releaseS", name?: WordKey}} Kind how it is said, from which difference on it is another, and the setting that it is about */

/** What takes longer from press to picture is felt to be late, ms (Miller, Fall Joint Computer Conference, 1968). */
const LATE_MS = 100;
/** One press in five may come while the computer does something else. */
const MOST = 0.8;
/** This share of choices must be right. */
const GOOD = 0.75;
const SHARE = { words: sayPercent, least: 0.02 };
const SECONDS = { words: (/** @type {number} */ value) => say("unit.seconds", { value: sayNumber(value, 2) }), least: 0.05 };
const MS = { words: (/** @type {number} */ value) => say("fit.ms", { value: Math.round(value) }), least: 20 };
const KINDS = /** @satisfies {Record<string, Kind>} */ (/** @type {const} */ ({
  drift: { ...SHARE, setting: "deadZone", name: "settings.dead_zone" },
  shaking: { ...SHARE, setting: "tremor", name: "settings.tremor" },
  reach: { ...SHARE, setting: "reach", name: "settings.reach" },
  chosen: SHARE,
  reaction: { ...SECONDS, setting: "dwellS", name: "settings.dwell" },
  hold: { ...SECONDS, setting: "acceptS", name: "settings.accept" },
  doubles: { words: sayNumber, least: 2, setting: "releaseS", name: "settings.release" },
  speed: MS,
}));
/** @param {Finding} finding @returns {Kind} */
const kindOf = ({ key }) => KINDS[key];

/** @param {unknown[]} exercises that were done @param {number[]} delays from press to picture, ms @param {Values} values @returns {Finding[]} */
export function findingsOf(exercises, delays, values) {
  const trials = exercises.filter((one) => one instanceof Trials);
  const found = [...ofHolds(exercises.filter((one) => one instanceof Hold)), ...trials.flatMap((one) => ofTrials(one, values)), ofDelays(delays)];
  // There is none of what was not done.
  return found.filter(({ value }) => Number.isFinite(value));
}

/** @param {Hold[]} holds @returns {Finding[]} */
function ofHolds(holds) {
  const done = holds.map(({ towards, samples }) => ({ towards, samples, still: settled(samples) })).filter(({ still }) => still.length);
  const rest = done.find(({ towards }) => !towards)?.samples ?? [];
  const pushes = done.flatMap(({ towards, samples, still }) => {
    const [right, up] = DIRECTIONS[towards ?? "up"];
    return towards ? [{ towards, samples, far: quantile(still.map(([x, y]) => right * x + up * y), 0.5), ...shakingOf(samples) }] : [];
  });
  const [drift, deadZone, ranges] = [driftOf(rest), deadZoneFor(rest), pushes.map(({ far }) => far)];
  const { hz, size } = pushes.reduce((most, one) => (one.size < most.size ? most : one), { hz: 0, size: NaN });
  return [
    { key: "drift", value: drift, proposed: deadZone, why: drift > Number(deadZone) ? "fit.drift_much" : "fit.drift_why" },
    { key: "shaking", value: size, measured: size > STEADY ? say("fit.times_a_second", { size: sayPercent(size), times: sayNumber(hz) }) : undefined, proposed: tremorFor(pushes.map(({ samples }) => samples)) },
    { key: "reach", value: Math.min(...ranges), measured: sayList(pushes.map(({ towards, far }) => say(`stick.${towards}`, { percent: Math.round(100 * far) }))), proposed: reachFor(ranges) },
  ];
}

/** @param {Trials} trials @param {Values} values @returns {Finding[]} */
function ofTrials({ counts, done, reactions, holds, doubles }, values) {
  // A choice is not lit shorter for who takes the wrong one.
  const [dwell, least] = [dwellFor(reactions), counts.right < GOOD * done ? values.dwellS : 0];
  return [
    { key: "chosen", value: counts.right / done, measured: say("fit.of", { ...counts, done }) },
    { key: "reaction", value: quantile(reactions, 0.9), proposed: dwell && Math.max(dwell, least) },
    { key: "hold", value: quantile(holds, 0.5), proposed: acceptFor(holds, values.acceptS) },
    { key: "doubles", value: doubles.length, proposed: releaseFor(doubles, values.releaseS, holds.length) },
  ];
}

/** @param {number[]} delays ms @returns {Finding} */
function ofDelays(delays) {
  const value = quantile(delays, 0.5);
  return { key: "speed", value, measured: say("fit.at_worst", { usual: MS.words(value), worst: MS.words(Math.max(...delays)) }), why: quantile(delays, MOST) <= LATE_MS ? "fit.quick" : "fit.slow" };
}

/** The settings that would change. @param {Finding[]} findings @param {Values} values @returns {Partial<Values>} */
export function proposals(findings, values) {
  return Object.fromEntries(findings.flatMap((one) => {
    const { setting } = kindOf(one);
    return setting && one.proposed !== undefined && one.proposed !== values[setting] ? [[setting, one.proposed]] : [];
  }));
}

/** What it is called, what was measured, today's setting with the proposed one, and why. @param {Finding} finding @param {Values} values */
export function textsOf(finding, values) {
  const { key, value, proposed, why = `fit.${key}_why` } = finding;
  const { words, setting, name } = kindOf(finding);
  const texts = [say(`fit.${key}`), finding.measured ?? words(value)];
  if (!setting || !name) return [...texts, "", say(/** @type {WordKey} */ (why))];
  const sayValue = (/** @type {any} */ one) => (setting === "tremor" ? say(/** @type {WordKey} */ (`settings.tremor_${one}`)) : setting.endsWith("S") ? SECONDS.words(one) : sayPercent(one));
  const change = setting in proposals([finding], values) ? say("fit.from_to", { name: say(name), today: sayValue(values[setting]), proposed: sayValue(proposed) }) : say("fit.stays", { name: say(name), today: sayValue(values[setting]) });
  return [...texts, change, say(proposed === undefined ? "fit.too_few" : /** @type {WordKey} */ (why))];
}

/** What is otherwise than last time, by at least a quarter, one sentence each. @param {Finding[]} findings @param {Record<string, number> | undefined} before @returns {string[]} */
export function changes(findings, before) {
  if (!before) return [say("fit.first")];
  const changed = findings.filter((one) => Math.abs(one.value - before[one.key]) >= Math.max(kindOf(one).least, before[one.key] / 4));
  const date = sayTime(new Date(before.at).toISOString(), { dateStyle: "long" });
  return [say(changed.length ? "fit.since" : "fit.same", { date }), ...changed.map((one) =>
    say("fit.went", { what: say(`fit.${one.key}`), before: kindOf(one).words(before[one.key]), now: kindOf(one).words(one.value) }))];
}
