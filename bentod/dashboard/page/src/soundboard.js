// What is heard: sounds by event, one at a time, the newest first of all; and the quiet tone of the selected joint.
import { candidates } from "./soundcues.js";

const LOWEST_HZ = 220;
const PENTATONIC = [0, 2, 4, 7, 9];
const NOTES = 20;
const RAMP_S = 0.04; // time constant with which the tone changes, so that nothing clicks
const GAP_S = 0.04;
const KEPT = 50; // events that are remembered as heard

/** The pitch (Hz) of the joint of this index, as bentod/voice/tones.py has it. */
export function note(index) {
  const octave = Math.floor((index % NOTES) / PENTATONIC.length);
  return LOWEST_HZ * 2 ** (octave + PENTATONIC[(index % NOTES) % PENTATONIC.length] / 12);
}

export class SoundBoard {
  #app;
  #context = null;
  #master = null;
  #hum = null;
  #level = 0;
  #names = null;
  #buffers = new Map();
  #playing = [];
  #turn = 0;
  heard = [];

  constructor(app) {
    this.#app = app;
  }

  get on() {
    return this.#context !== null;
  }

  get context() {
    return this.#context;
  }

  /** The node that everything is heard through. */
  get output() {
    return this.#master;
  }

  /** The loudness of the quiet tone as it is meant to be now, 0 for none. */
  get level() {
    return this.#level;
  }

  /** Browsers let a page be heard only after a click or a key: call this from one. */
  start(volume) {
    if (this.#context) return;
    this.#context = new AudioContext();
    this.#master = this.#context.createGain();
    this.#master.connect(this.#context.destination);
    this.volume(volume);
    void this.#context.resume();
  }

  async stop() {
    const context = this.#context;
    this.#context = this.#hum = null;
    this.#level = 0;
    this.#playing = [];
    this.#buffers.clear();
    await context?.close();
  }

  /** 0..1 */
  volume(share) {
    this.#master?.gain.setTargetAtTime(share, this.#context.currentTime, RAMP_S);
  }

  /** Names of the sounds by event; silent ones are not there. Rejects: the daemon is away. */
  async names() {
    this.#names ??= await this.#app.call("dashboard.sounds");
    return this.#names;
  }

  /** The events one after another; what still sounds ends. */
  async play(events) {
    if (!this.on) return;
    const turn = ++this.#turn;
    try {
      const buffers = (await Promise.all(events.map((event) => this.#buffer(event)))).filter(Boolean);
      if (turn !== this.#turn || !this.on) return;
      this.#sequence(buffers);
      this.heard = [...this.heard, ...events].slice(-KEPT);
    } catch {
      // The server is away, or its WAV is none: there is nothing to be heard, and the page says so itself.
    }
  }

  /** The tone of `pitch` (Hz) at `level` (share of full scale, 0 for silence). */
  hum(pitch, level) {
    this.#level = this.on && pitch ? level : 0;
    if (!this.on || (!this.#hum && !this.#level)) return;
    this.#hum ??= this.#oscillator();
    const now = this.#context.currentTime;
    if (pitch) this.#hum.oscillator.frequency.setTargetAtTime(pitch, now, RAMP_S);
    this.#hum.gain.gain.setTargetAtTime(this.#level, now, RAMP_S);
  }

  #oscillator() {
    const oscillator = this.#context.createOscillator();
    const gain = this.#context.createGain();
    gain.gain.value = 0;
    oscillator.connect(gain).connect(this.#master);
    oscillator.start();
    return { oscillator, gain };
  }

  async #buffer(event) {
    const names = await this.names();
    const key = candidates(event).find((candidate) => candidate in names);
    const id = key && names[key];
    if (id && !this.#buffers.has(id)) {
      const wav = await this.#app.call("dashboard.sound", { id });
      const buffer = await this.#context?.decodeAudioData(wav.slice().buffer);
      if (buffer) this.#buffers.set(id, buffer);
    }
    return id ? this.#buffers.get(id) : null;
  }

  #sequence(buffers) {
    for (const source of this.#playing) source.stop();
    let when = this.#context.currentTime;
    this.#playing = buffers.map((buffer) => {
      const source = this.#context.createBufferSource();
      source.buffer = buffer;
      source.connect(this.#master);
      source.start(when);
      when += buffer.duration + GAP_S;
      return source;
    });
  }
}
