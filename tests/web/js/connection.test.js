import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { FakeSocket, newBrowser, pass, stateOf, welcomeOf } from "./browser.js";

const ADA = { id: "00000000000000ad", name: "Ada" };

let connection;

function connect(person = null) {
  connection = new Connection(person);
  FakeSocket.newest.opens();
  return FakeSocket.newest;
}

beforeEach(newBrowser);

test("a page introduces itself by its person's id and name, over TLS where the page came over TLS", () => {
  const socket = connect(ADA);
  assert.equal(socket.url, "wss://arm.local/drive");
  assert.deepEqual(socket.taken(), [{ type: "hello", version: 1, name: "Ada", person: ADA.id }]);
});

test("a page without a person introduces itself without a name", () => {
  assert.deepEqual(connect().taken(), [{ type: "hello", version: 1 }]);
});

test("an input echoes the newest nonce and is numbered upwards", () => {
  const socket = connect();
  socket.taken();
  socket.says(stateOf({ nonce: "a" }));
  connection.sendInput([1, 0], { source: "dpad", latched: false });
  socket.says(stateOf({ nonce: "b" }));
  connection.sendInput([0, 0], { source: "dpad", latched: true }, "close");
  connection.sendInput([0, 0], { source: "gamepad", latched: false }, null, true);
  assert.deepEqual(socket.taken(), [
    { type: "input", seq: 1, nonce: "a", u: [1, 0], source: "dpad", latched: false, gripper: null, opens: false },
    { type: "input", seq: 2, nonce: "b", u: [0, 0], source: "dpad", latched: true, gripper: "close", opens: false },
    { type: "input", seq: 3, nonce: "b", u: [0, 0], source: "gamepad", latched: false, gripper: null, opens: true },
  ]);
});

test("no input goes out before a state has come, nor when the newest is stale", () => {
  const socket = connect();
  socket.taken();
  connection.sendInput([1, 0], { source: "dpad", latched: false });
  socket.says(stateOf());
  pass(250);
  connection.sendInput([1, 0], { source: "dpad", latched: false });
  assert.deepEqual(socket.taken(), []);
  socket.says(stateOf());
  connection.sendInput([1, 0], { source: "dpad", latched: false });
  assert.equal(socket.taken().length, 1);
});

test("a page is told that the server was started again, and that alone where another run came with it", () => {
  const told = [];
  connect().says(welcomeOf());
  for (const type of ["run_changed", "server_changed"]) connection.addEventListener(type, () => told.push(type));
  FakeSocket.newest.says(welcomeOf({ id: "again" }));
  assert.deepEqual(told, []);
  FakeSocket.newest.says(welcomeOf({ server: "second", run: "two" }));
  assert.deepEqual(told, ["server_changed"]);
});

test("nothing is driving or enabled once the connection is lost", () => {
  const socket = connect();
  socket.says(stateOf({ you: true, phase: "moving" }));
  assert.ok(connection.driving && connection.engaged && connection.fresh);
  socket.close();
  assert.ok(!connection.driving && !connection.engaged && !connection.fresh);
  assert.equal(connection.send({ type: "stop" }), false);
});

test("a lost connection is tried again, at ever longer intervals of up to 8 s, and at once fast after success", () => {
  const waits = [];
  connect();
  for (let tries = 0; tries < 7; tries += 1) {
    const before = FakeSocket.all.length;
    FakeSocket.newest.close();
    let waited = 0;
    while (FakeSocket.all.length === before) {
      pass(100);
      waited += 100;
    }
    waits.push(waited);
  }
  assert.deepEqual(waits, [500, 1000, 2000, 4000, 8000, 8000, 8000]);
  FakeSocket.newest.opens();
  FakeSocket.newest.close();
  pass(500);
  assert.equal(FakeSocket.all.length, 9);
});

test("inputs are numbered from one again on a new connection", () => {
  connect().says(stateOf());
  connection.sendInput([0, 0], { source: "pointer", latched: false });
  FakeSocket.newest.close();
  pass(500);
  FakeSocket.newest.opens();
  FakeSocket.newest.says(stateOf({ nonce: "new" }));
  FakeSocket.newest.taken();
  connection.sendInput([0, 0], { source: "pointer", latched: false });
  assert.equal(FakeSocket.newest.taken()[0].seq, 1);
});

test("another person is another page to the server", () => {
  connect(ADA);
  connection.become({ id: "00000000000000be", name: "Bea" });
  pass(500);
  FakeSocket.newest.opens();
  assert.equal(FakeSocket.newest.taken()[0].name, "Bea");
});

test("predicted paths stay while the server does not send new ones", () => {
  const socket = connect();
  const ghosts = { up: [[0, 0, 1]], down: [], left: [], right: [] };
  socket.says(stateOf({ ghosts }));
  socket.says(stateOf({ ghosts: null, tick: 1 }));
  assert.deepEqual(connection.state.ghosts, ghosts);
});

test("a page hears when another run is driven, but not on its first welcome", () => {
  const socket = connect();
  const heard = [];
  connection.addEventListener("run_changed", (event) => heard.push(event.detail));
  socket.says(welcomeOf({ run: "one" }));
  socket.says(welcomeOf({ run: "one" }));
  socket.says(welcomeOf({ run: "two" }));
  assert.deepEqual(heard, ["two"]);
});
