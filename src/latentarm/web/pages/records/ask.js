/** Requests about what the server keeps: JSON both ways. */

import { byId, setText } from "../layout/dom.js";
import { say, sayNotice } from "../layout/words.js";

/**
 * The server's answer, null where it says nothing, or an error with a sentence for the person.
 * @param {"GET" | "POST" | "PUT" | "DELETE"} method @param {string} path @param {unknown} [body] an object, or a file @returns {Promise<any>}
 */
export async function ask(method, path, body) {
  const content = body === undefined ? undefined : body instanceof Blob ? body : JSON.stringify(body);
  const answer = await fetch(path, { method, body: content, cache: "no-store" }).catch(() => {
    throw new Error(say("records.no_answer"));
  });
  const told = answer.status === 204 ? null : await answer.json().catch(() => null);
  if (answer.ok) return told;
  throw new Error(answer.status === 413 ? say("records.too_large") : told?.notice ? sayNotice(told.notice) : say("records.no_answer"));
}

/** Say what went wrong where the person looks; nothing where the text is empty. @param {string} text @param {string} [where] */
export function showProblem(text, where = "problem") {
  setText(byId(where), text);
  byId(where).hidden = text === "";
}

/** Do it, and say what went wrong. @param {() => Promise<unknown>} act @param {string} [where] */
export async function attempt(act, where) {
  showProblem("", where);
  try {
    await act();
  } catch (error) {
    showProblem(error instanceof Error ? error.message : String(error), where);
  }
}

/** A moment as people write it. @param {string} iso @param {Intl.DateTimeFormatOptions} [style] */
export function sayTime(iso, style = { dateStyle: "medium", timeStyle: "short" }) {
  const { lang } = document.documentElement;
  // The page's language as it is written where the browser is from: `en-GB` writes dates otherwise than `en`.
  return new Date(iso).toLocaleString(navigator.languages.find((one) => one.startsWith(`${lang}-`)) ?? lang, style);
}
