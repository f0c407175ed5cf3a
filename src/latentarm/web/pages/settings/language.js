/** The language of the pages: the server reads the choice from a cookie and makes the page in it. */

const COOKIE = "latentarm_language";
const LIFE_S = 365 * 24 * 3600;

/** @param {string} language */
function choose(language) {
  const secure = location.protocol === "https:" ? "; secure" : "";
  document.cookie = `${COOKIE}=${language}; path=/; max-age=${LIFE_S}; samesite=strict${secure}`;
}

/** True if the page has none of the languages that a browser asks for. @param {readonly string[]} wanted @param {string[]} known codes */
export function isForeign(wanted, known) {
  return wanted.length > 0 && !wanted.some((tag) => known.includes(tag.toLowerCase().split("-")[0]));
}

/** @param {HTMLSelectElement} select @param {HTMLElement} offer is shown once to those whose language is not there */
export function attachLanguage(select, offer) {
  select.addEventListener("change", () => {
    choose(select.value);
    // A switch can choose what is chosen already.
    if (select.value !== document.documentElement.lang) location.reload();
  });
  const buttons = [...offer.querySelectorAll("button")];
  const known = buttons.map((button) => button.dataset.language ?? "");
  if (document.cookie.includes(`${COOKIE}=`) || !isForeign(navigator.languages, known)) return;
  choose(document.documentElement.lang);
  offer.hidden = false;
  for (const button of buttons) {
    button.addEventListener("click", () => {
      choose(button.dataset.language ?? "");
      if (button.dataset.language === document.documentElement.lang) offer.hidden = true;
      else location.reload();
    });
  }
}
