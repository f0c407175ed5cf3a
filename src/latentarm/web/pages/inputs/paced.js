/** Work that may be left out for a while, where a page has to keep up with something else. */

/**
 * Does it at once, or where the last time was too short ago, as soon as that is over: however often it is asked for.
 *
 * @param {() => boolean} act whether there was something to do: what comes after nothing need not wait
 * @param {() => number} gapMs the least time between two times, ms
 */
export function paced(act, gapMs) {
  let doneAt = -Infinity;
  let waiting = 0;

  const now = () => {
    clearTimeout(waiting);
    waiting = 0;
    const began = performance.now();
    if (act()) doneAt = began;
  };
  return () => {
    const early = doneAt + gapMs() - performance.now();
    if (early <= 0) now();
    else waiting ||= setTimeout(now, early);
  };
}
