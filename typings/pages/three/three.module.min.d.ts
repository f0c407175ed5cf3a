/** What the minified three.js exports. */
export * from "three";
