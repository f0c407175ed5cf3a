/** The language of the pages: the server reads the choice from a cookie and makes the page in it. */

const COOKIE = "latentarm_language";
const LIFE_S = 365 * 24 * 3600;

/** @param {HTMLSelectElement} select */
export function attachLanguage(select) {
  select.addEventListener("change", () => {
    const secure = location.protocol === "https:" ? "; secure" : "";
    document.cookie = `${COOKIE}=${select.value}; path=/; max-age=${LIFE_S}; samesite=strict${secure}`;
    location.reload();
  });
}
