/** The connection that pictures come through: WebRTC to the server alone, and to no other address. */

/** @import {CameraState} from "./camera_view.js" */
/** @import {ServerClock} from "./picture_age.js" */

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;
/** A connection that is not there by then is tried anew, ms. */
const CONNECTED_WITHIN_MS = 8000;
/** How often the server is asked what time it is there, ms: more often at first. */
const ASK_MS = 1000;
const ASK_FIRST_MS = 60;
const FIRST_QUESTIONS = 6;

export class CameraLink {
  /**
   * @param {number} count how many cameras there are
   * @param {ServerClock} clock
   * @param {{track: (number: number, track: MediaStreamTrack | null) => void, refused: (notice: Notice | null) => void,
   *   told: (cameras: {state: CameraState, rtp: number | null, at: number | null}[]) => void}} heard what is done with what comes
   */
  constructor(count, clock, heard) {
    this._count = count;
    this._clock = clock;
    this._heard = heard;
    /** Whose page this is to the server; null while nothing is wanted. @type {string | null} */
    this._page = null;
    /** @type {RTCPeerConnection | null} */
    this._peer = null;
    this._waitMs = FIRST_WAIT_MS;
    this._timer = 0;
  }

  get connected() {
    return this._peer?.connectionState === "connected";
  }

  /** Want pictures for a page of this id, or none. @param {string | null} page */
  want(page) {
    if (page === this._page) return;
    this._page = page;
    this._waitMs = FIRST_WAIT_MS;
    this._hangUp();
    if (page !== null) void this._connect(page);
  }

  _hangUp() {
    clearTimeout(this._timer);
    const peer = this._peer;
    this._peer = null;
    if (!peer) return;
    peer.close();
    for (let number = 0; number < this._count; number += 1) this._heard.track(number, null);
  }

  _again() {
    this._hangUp();
    const page = this._page;
    if (page === null) return;
    this._timer = setTimeout(() => void this._connect(page), this._waitMs);
    this._waitMs = Math.min(2 * this._waitMs, LONGEST_WAIT_MS);
  }

  /** @param {string} page */
  async _connect(page) {
    const peer = new RTCPeerConnection({ bundlePolicy: "max-bundle" });
    this._peer = peer;
    this._timer = setTimeout(() => this._again(), CONNECTED_WITHIN_MS);
    const receiving = Array.from({ length: this._count }, () => peer.addTransceiver("video", { direction: "recvonly" }));
    for (const { receiver } of receiving) receiver.jitterBufferTarget = 0;
    peer.addEventListener("track", ({ track, transceiver }) => this._heard.track(receiving.indexOf(transceiver), track));
    peer.addEventListener("connectionstatechange", () => {
      if (peer !== this._peer) return;
      if (this.connected) {
        clearTimeout(this._timer);
        this._waitMs = FIRST_WAIT_MS;
      } else if (["failed", "disconnected", "closed"].includes(peer.connectionState)) this._again();
    });
    this._talk(peer.createDataChannel("cameras"));
    try {
      await peer.setLocalDescription();
      const answer = await fetch("/cameras", {
        method: "POST", headers: { "content-type": "application/json" },
        body: JSON.stringify({ page, sdp: peer.localDescription?.sdp }),
      });
      const said = await answer.json();
      if (peer !== this._peer) return;
      this._heard.refused(answer.ok ? null : said.notice);
      if (!answer.ok) throw new Error("refused");
      await peer.setRemoteDescription({ type: "answer", sdp: said.sdp });
    } catch {
      if (peer === this._peer) this._again();
    }
  }

  /** @param {RTCDataChannel} channel */
  _talk(channel) {
    let asked = 0;
    const ask = () => {
      if (channel.readyState !== "open") return;
      channel.send(JSON.stringify({ type: "time", sent: performance.now() }));
      asked += 1;
      setTimeout(ask, asked < FIRST_QUESTIONS ? ASK_FIRST_MS : ASK_MS);
    };
    channel.addEventListener("open", ask);
    channel.addEventListener("close", () => {
      if (this.connected) this._again();
    });
    channel.addEventListener("message", ({ data }) => {
      const said = JSON.parse(data);
      if (said.type === "time") this._clock.answered(said.sent, performance.now(), said.now);
      else if (said.type === "cameras") this._heard.told(said.cameras);
    });
  }
}
