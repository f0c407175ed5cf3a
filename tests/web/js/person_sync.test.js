import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachPersonSync } from "#pages/settings/person_sync.js";
import { Settings } from "#pages/settings/settings.js";
import { newBrowser, pass } from "./browser.js";

const ADA = { id: "00000000000000ad", name: "Ada" };

let fakes;
/** What the server keeps of Ada, and whether it takes changes and answers. */
let server;

beforeEach(() => {
  fakes = newBrowser();
  server = { kept: { sensitivity: 0.3 }, hears: true, looks: [] };
  fakes.fetch = globalThis.fetch = async (address, { method, body } = {}) => {
    if (method === "PUT") {
      if (!server.hears) return new Promise(() => {});
      server.kept = JSON.parse(body);
    }
    if (method === undefined) await new Promise((answer) => server.looks.push(answer));
    return { ok: true, status: 200, json: async () => ({ ...ADA, settings: server.kept }) };
  };
});

const settled = () => new Promise((done) => setImmediate(done));
/** A page opens, and Ada sits there. */
async function opened() {
  fakes.window = globalThis.window = new EventTarget();
  const settings = new Settings();
  attachPersonSync(settings);
  if (!settings.person) settings.become(ADA);
  await answered();
  return settings;
}
async function answered() {
  for (const answer of server.looks.splice(0)) answer();
  await settled();
}

test("settings of the server count on a page that opens", async () => {
  assert.equal((await opened()).values.sensitivity, 0.3);
});

test("a change that the server has not taken when its page goes away is there on the next page, and sent again", async () => {
  const settings = await opened();
  server.hears = false;
  settings.change({ swapAxes: true });
  window.dispatchEvent(new Event("pagehide"));
  server.hears = true;
  const next = await opened();
  assert.equal(next.values.swapAxes, true);
  pass(301);
  await settled();
  assert.equal(server.kept.swapAxes, true);
  server.kept = { ...server.kept, sensitivity: 0.7 };
  assert.equal((await opened()).values.sensitivity, 0.7);
});

test("a change made before the server has said what it keeps counts more", async () => {
  await opened();
  const settings = new Settings();
  attachPersonSync(settings);
  settings.change({ swapAxes: true });
  pass(301);
  await settled();
  server.kept = { sensitivity: 0.3 };
  await answered();
  assert.equal(settings.values.swapAxes, true);
});
