// @ts-check
/** What sites are set to: shown at once as it was wished, and for good once the daemon has said yes. */

const LOOK_AGAIN = 2000; // ms: others may have changed something
const USUAL = { gain: [1e-6, 1e6], threshold_v: [0, 10], max_v: [1e-9, 10], release: [0.1, 1] };

export class SiteSettings {
  #wanted = new Map();
  #asking = new Set();
  #looking = false;

  constructor(app) {
    this.app = app;
    this.sites = []; // as emg_get tells
    this.rate = 0; // Hz
    this.listeners = [];
    setInterval(() => document.hidden || this.refresh(), LOOK_AGAIN);
    app.onEvent((event) => event.kind === "emg" && this.refresh());
    app.onLink(({ daemon }) => daemon && this.refresh());
  }

  /** Values of a site: what is wished before what is confirmed. */
  values(name) {
    return { ...this.sites.find((site) => site.name === name), ...this.#wanted.get(name) };
  }

  pending(name) {
    return this.#wanted.has(name) || this.#asking.has(name);
  }

  /** Smallest and greatest value that the daemon takes for a parameter of `emg_set`. */
  bounds(parameter) {
    const method = this.app.methodTable.find((one) => one.name === "emg_set");
    const told = method?.parameters.find((one) => one.name === parameter);
    return [told?.minimum ?? USUAL[parameter][0], told?.maximum ?? USUAL[parameter][1]];
  }

  /** Wish something of a site, e.g. {threshold_v: 1e-5}; what is refused is told and falls back. */
  set(name, changes) {
    this.#wanted.set(name, { ...this.#wanted.get(name), ...changes });
    this.#tell();
    if (!this.#asking.has(name)) void this.#ask(name);
  }

  async refresh() {
    if (this.#looking || !this.app.linkState.daemon) return;
    this.#looking = true;
    try {
      const told = await this.app.call("emg_get");
      const known = JSON.stringify([told.sites, told.rate_hz]);
      this.rate = told.rate_hz;
      this.sites = told.sites;
      if (known !== this.known) this.#tell();
      this.known = known;
    } catch {
      // The page says elsewhere that the daemon is gone; it is asked again.
    } finally {
      this.#looking = false;
    }
  }

  /** One request at a time for each site; the newest wish waits. */
  async #ask(name) {
    this.#asking.add(name);
    while (this.#wanted.has(name)) {
      const changes = this.#wanted.get(name);
      const told = await this.#tried(name, changes);
      if (told) Object.assign(this.sites.find((site) => site.name === name) ?? {}, changes);
      if (!told || this.#wanted.get(name) === changes) this.#wanted.delete(name);
    }
    this.#asking.delete(name);
    this.#tell();
  }

  async #tried(name, changes) {
    try {
      await this.app.call("emg_set", { site: name, ...changes });
      return true;
    } catch (error) {
      this.app.say(error.message, "error");
      return false;
    }
  }

  #tell() {
    for (const listener of this.listeners) listener();
  }
}
