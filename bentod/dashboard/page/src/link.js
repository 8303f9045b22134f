// The WebSocket to the page's server: token first, then calls, holds and frames. Comes back by itself.
import { decode, encode } from "@msgpack/msgpack";

const ACKNOWLEDGE = 3; // frames between two acknowledgements; the server sends at most 8 ahead
const FIRST_WAIT = 250; // ms until the next attempt to connect; twice as long each time
const LONGEST_WAIT = 4000;
const SILENCE = 3000; // ms without a word, after which the server counts as lost; it says one each second
const NOT_VALID = 4401;

/** Told what arrives: welcome, frame, event, dropped, link. */
export class Link {
  constructor(token, handlers) {
    this.token = token;
    this.handlers = handlers;
    this.seen = 0;
    this.skipped = 0;
    this.received = 0;
    this._acknowledged = 0;
    this._number = 0;
    this._calls = new Map();
    this._wait = FIRST_WAIT;
    this._heard = 0;
    this._open();
    setInterval(() => this._watch(), 1000);
    addEventListener("online", () => this._again(0));
  }

  get up() {
    return this._socket?.readyState === WebSocket.OPEN;
  }

  /** Ask for `method` once; the answer, or an Error that says why not. */
  call(method, params = {}) {
    if (!this.up) return Promise.reject(new Error("The page has lost its server."));
    const number = ++this._number;
    return new Promise((resolve, reject) => {
      this._calls.set(number, { resolve, reject });
      this._send(["call", number, method, params, this.seen]);
    });
  }

  hold(key, method, params) {
    this._send(["hold", key, method, params, this.seen]);
    this._acknowledged = this.seen;
  }

  release(key) {
    this._send(["release", key]);
  }

  _send(words) {
    if (this.up) this._socket.send(encode(words));
  }

  _open() {
    clearTimeout(this._timer);
    this._abandon();
    const address = new URL("ws", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    address.hash = "";
    const socket = new WebSocket(address);
    this._socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this._send(["token", this.token]);
    socket.onmessage = (message) => socket === this._socket && this._take(decode(new Uint8Array(message.data)));
    socket.onclose = (close) => socket === this._socket && this._closed(close);
  }

  /** A server that is frozen does not even answer a farewell. */
  _abandon() {
    const socket = this._socket;
    this._socket = null;
    socket?.close();
  }

  _closed(close) {
    this._heard = 0;
    for (const { reject } of this._calls.values()) reject(new Error("The page has lost its server."));
    this._calls.clear();
    this.seen = this._acknowledged = 0;
    if (close.code === NOT_VALID) {
      this.handlers.link({ page: false, daemon: false, why: "token" });
      return;
    }
    this.handlers.link({ page: false, daemon: false, why: "The page has lost its server." });
    this._again(this._wait);
    this._wait = Math.min(2 * this._wait, LONGEST_WAIT);
  }

  _again(wait) {
    if (this.up) return;
    clearTimeout(this._timer);
    this._timer = setTimeout(() => this._open(), wait);
  }

  _watch() {
    if (!this.up || !this._heard || performance.now() - this._heard < SILENCE) return;
    this._abandon();
    this._closed({ code: 0 });
  }

  _take([kind, ...rest]) {
    this._heard = performance.now();
    if (kind === "frame") this._frame(...rest);
    else if (kind === "answer") this._settle(rest[0], "resolve", rest[1]);
    else if (kind === "refused") this._settle(rest[0], "reject", new Error(rest[1]));
    else if (kind === "welcome") this._welcome(rest[0]);
    else if (kind === "alive") return;
    else if (kind === "event") this.handlers.event(rest[0]);
    else if (kind === "dropped") this.handlers.dropped(rest[0], rest[1]);
    else if (kind === "link") this.handlers.link({ page: true, daemon: rest[0], why: rest[1] });
  }

  _welcome(told) {
    this._wait = FIRST_WAIT;
    this.handlers.welcome(told);
  }

  _settle(number, way, value) {
    this._calls.get(number)?.[way](value);
    this._calls.delete(number);
  }

  _frame(number, state, emg, told) {
    if (this.seen) this.skipped += Math.max(0, number - this.seen - 1);
    this.seen = number;
    this.received += 1;
    if (number - this._acknowledged >= ACKNOWLEDGE) {
      this._send(["seen", number]);
      this._acknowledged = number;
    }
    this.handlers.frame(state, emg, told);
  }
}
