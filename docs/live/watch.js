"use strict";
// A robot, live: the estimates of `sigmahat live --to foxglove`, by the protocol of Foxglove.

const PROTOCOL = "foxglove.sdk.v1", TOPIC = /^\/(.+)\/estimate$/;
const WATCHED_SECONDS = 20, MOST_SAMPLES = 1e5, AGAIN = 2000; // [s] shown, [1], [ms]
const MESSAGE = { subscription: 1, time: 5, data: 13 }; // where they begin [bytes]

const watch = {
  field: document.getElementById("watched-joint"),

  open() {
    for (const section of document.querySelectorAll("main > section"))
      section.hidden = section.id !== "watch";
    say("intro", "The stiffness of the joints of a robot, as sigmahat live estimates it while they move.");
    this.plots = ["watched-stiffness", "watched-torque"].map((id) => new Plot(id));
    this.field.addEventListener("change", () => this.choose(this.field.value));
    if (WATCHED) this.connect();
    else say("watch-message", "Expected the address of a WebSocket, as in ?ws=ws://127.0.0.1:8765");
    requestAnimationFrame(() => this.frame());
  },

  /** Connects, and again whenever the connection ends. */
  connect() {
    this.channels = new Map();
    this.subscribed = null;
    this.socket = new WebSocket(WATCHED, [PROTOCOL]);
    this.socket.binaryType = "arraybuffer";
    this.socket.addEventListener("open", () => say("watch-message", ""));
    this.socket.addEventListener("message", ({ data }) => {
      if (typeof data === "string") this.take(JSON.parse(data));
      else this.receive(data);
    });
    this.socket.addEventListener("close", () => {
      say("watch-message", `Nobody answers at ${WATCHED}; this page tries again`);
      setTimeout(() => this.connect(), AGAIN);
    });
  },

  take({ op, channels = [] }) {
    if (op !== "advertise") return;
    for (const { id, topic } of channels) {
      const name = TOPIC.exec(topic)?.[1];
      if (name !== undefined) this.channels.set(name, id);
    }
    const chosen = this.field.value, names = [...this.channels.keys()].sort();
    this.field.replaceChildren(...names.map((name) => new Option(name)));
    if (names.length) this.choose(names.includes(chosen) ? chosen : names[0]);
  },

  choose(name) {
    this.field.value = name;
    const id = this.channels.get(name), old = this.subscribed;
    if (old !== null) this.send({ op: "unsubscribe", subscriptionIds: [old] });
    this.subscribed = id;
    this.send({ op: "subscribe", subscriptions: [{ id, channelId: id }] });
    this.history = new Samples(["t", "sigma", "sigma_high", "tau_e", "tau_e_high"], MOST_SAMPLES);
    this.first = this.last = null;
    this.isNew = false;
  },

  send(message) {
    this.socket.send(JSON.stringify(message));
  },

  receive(buffer) {
    const view = new DataView(buffer);
    if (view.getUint8(0) !== 1 || view.getUint32(MESSAGE.subscription, true) !== this.subscribed) return;
    const stamp = view.getBigUint64(MESSAGE.time, true);
    const data = new TextDecoder().decode(new Uint8Array(buffer, MESSAGE.data));
    this.last = JSON.parse(data);
    this.first ??= stamp;
    const t = Number(stamp - this.first) / 1e9, names = Object.keys(this.history.columns).slice(1);
    this.history.push(t, ...names.map((name) => this.last[name] ?? NaN));
    this.isNew = true;
  },

  frame() {
    requestAnimationFrame(() => this.frame());
    if (!this.isNew) return;
    this.isNew = false;
    const t = this.history.get("t"), now = t.at(-1);
    const from = t.findIndex((each) => each > now - WATCHED_SECONDS);
    const x = [Math.max(0, now - WATCHED_SECONDS), Math.max(WATCHED_SECONDS, now)];
    for (const [plot, name] of [[this.plots[0], "sigma"], [this.plots[1], "tau_e"]]) {
      const [y, high] = ["", "_high"].map((end) => this.history.get(name + end).subarray(from));
      const curve = { x: t.subarray(from), y, half: high.map((each, i) => each - y[i]), color: "estimate" };
      plot.draw({ x, y: roomy(range(y, ...(this.last.confident ? ends(curve) : []))), curves: [curve] });
    }
    const { sigma, sigma_high: high, tau_e: torque, tau_e_high: most, doubt } = this.last;
    say("watched-t", `${now.toFixed(1)} s`);
    say("watched-sigma", `${withBand(sigma, high - sigma)} N·m/rad`);
    say("watched-tau", `${withBand(torque, most - torque)} N·m`);
    say("watched-doubt", confidence(DOUBT[doubt]));
  },
};

if (WATCHED !== null) watch.open();
