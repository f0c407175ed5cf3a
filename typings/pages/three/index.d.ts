/** What the bundle of three.js exports, as far as the page uses it. */
import * as THREE from "three";

export { THREE };
