// The scene in the page: takes keys and buttons, has the clock, and hears what the kernel sends. The kernel puts
// board.js in front of it: widgets come as one module.

const KEYS = {
  KeyW: "forward", ArrowUp: "forward",
  KeyS: "back", ArrowDown: "back",
  KeyA: "left", ArrowLeft: "left",
  KeyD: "right", ArrowRight: "right",
};
const PAD = [["forward", "▲"], ["left", "◀"], ["back", "▼"], ["right", "▶"]];
const OTHERS = [
  ["pause", "Pause", true],
  ["undo", "Back to the start", false],
  ["unseen", "What have I not seen yet?", true],
  ["truth", "Show the truth", true],
  ["automatic", "Compare: automatic", false],
];
const PERIOD = 100; // ms: a step takes a tenth of a second
const SOON = 90; // ms: timers are not exact
const LATE = 5000; // ms: an answer that has not come by then will not come; the kernel may have been restarted
const AWAY = "Click here, then drive with W A S D or the arrow keys, two at once.";
const HERE = "You drive: W A S D or the arrow keys. A click elsewhere or Tab stops.";
const LEGEND = [
  "Blue lines: beams. Dots: cells that were hit. Solid outline: seen. Dashed: only supposed.",
  "Hatched: not seen yet. Grey: the truth. +: way-points of the automatic movement.",
].join(" ");

const made = (parent, tag, className, attributes = {}, words = "") => {
  const part = parent.appendChild(document.createElement(tag));
  part.className = className;
  part.textContent = words;
  Object.entries(attributes).forEach(([name, value]) => part.setAttribute(name, value));
  return part;
};

// The page.

function build(el) {
  const root = made(el, "div", "primkit-scene", {
    "tabindex": "0",
    "role": "application",
    "aria-label": "Robot on a board. Drive it with W A S D or the arrow keys; Tab leads to the buttons.",
    "data-lm-suppress-shortcuts": "true", // else Lab takes the keys for its own: d d deletes a cell
  });
  const parts = { root };
  parts.focus = made(root, "p", "focus", {}, AWAY);
  parts.canvas = made(root, "canvas", "", { "role": "img", "aria-label": "The board" });
  parts.score = made(root, "p", "score");
  parts.says = made(root, "p", "says", { "role": "status", "aria-live": "polite" });
  const controls = made(root, "div", "controls");
  const pad = made(controls, "div", "pad", { "role": "group", "aria-label": "Drive" });
  parts.pad = PAD.map(([word, sign]) => made(pad, "button", word, { "type": "button", "aria-label": word }, sign));
  const others = made(controls, "div", "others");
  parts.others = OTHERS.map(([word, label, toggles]) => {
    const pressed = toggles ? { "aria-pressed": "false" } : {};
    return made(others, "button", word, { "type": "button", ...pressed }, label);
  });
  parts.automatic = made(root, "p", "automatic", { "role": "status", "aria-live": "polite" });
  parts.record = made(root, "p", "record");
  made(root, "p", "legend", {}, LEGEND);
  return parts;
}

// The clock: while something is held it asks for a step every tenth of a second, and once more when all is let go;
// never for a second one before the first is answered. The shortest tap is a step.

class Clock {
  constructor(ask) {
    this.ask = ask;
    this.held = new Map(); // what holds it (a key, a pointer): the word
    this.tapped = new Set(); // words that were held at some time since the last step
    this.asked = -Infinity;
    this.waits = this.moves = false;
  }

  hold(holder, word) {
    if (this.held.get(holder) === word) return; // a key that repeats itself
    this.held.set(holder, word);
    this.tapped.add(word);
    this.timer ??= setInterval(() => this.tick(), PERIOD);
    this.tick(); // the first step at once
  }

  release(holder) {
    this.held.delete(holder);
  }

  stop() {
    this.held.clear();
    this.tapped.clear();
  }

  tick() {
    const since = performance.now() - this.asked;
    if (since < SOON || (this.waits && since < LATE)) return;
    if (!this.tapped.size && !this.held.size && !this.moves) {
      clearInterval(this.timer);
      this.timer = undefined;
      return;
    }
    const words = new Set([...this.tapped, ...this.held.values()]);
    this.tapped.clear();
    this.moves = words.size > 0;
    this.waits = true;
    this.asked = performance.now();
    this.ask({ do: "step", held: [...words] });
  }

  answered() {
    this.waits = false;
  }
}

// The keys and the buttons.

function listen(parts, clock, ask) {
  const { root } = parts;
  const shown = () => {
    const here = root.contains(document.activeElement) && document.hasFocus();
    root.classList.toggle("driving", here);
    parts.focus.textContent = here ? HERE : AWAY;
    const held = new Set(clock.held.values());
    parts.pad.forEach((button, i) => button.classList.toggle("held", held.has(PAD[i][0])));
  };
  const leave = () => {
    clock.stop();
    shown();
  };

  root.addEventListener("keydown", (event) => {
    if (event.key === "Tab") return;
    event.stopPropagation(); // no key in here is the notebook's
    if (event.ctrlKey || event.altKey || event.metaKey || !(event.code in KEYS)) return;
    event.preventDefault(); // arrow keys would scroll the page
    clock.hold(event.code, KEYS[event.code]);
    shown();
  });
  root.addEventListener("keyup", (event) => {
    clock.release(event.code);
    shown();
  });
  root.addEventListener("focusin", shown);
  root.addEventListener("focusout", (event) => root.contains(event.relatedTarget) || leave());
  root.addEventListener("pointerdown", (event) => {
    if (event.target.tagName !== "BUTTON") root.focus({ preventScroll: true });
  });

  parts.pad.forEach((button, i) => {
    const [word] = PAD[i];
    const release = (event) => {
      clock.release(`pointer ${event.pointerId}`);
      shown();
    };
    button.addEventListener("pointerdown", (event) => {
      button.setPointerCapture(event.pointerId); // so that the release is seen wherever it happens
      root.focus({ preventScroll: true });
      event.preventDefault();
      clock.hold(`pointer ${event.pointerId}`, word);
      shown();
    });
    ["pointerup", "pointercancel", "lostpointercapture"].forEach((kind) => button.addEventListener(kind, release));
    button.addEventListener("contextmenu", (event) => event.preventDefault()); // a long touch holds, nothing else
    button.addEventListener("click", (event) => {
      if (event.detail > 0) return; // the pointer has held it already
      clock.hold("button", word); // Enter or Space: one step
      clock.release("button");
    });
  });
  parts.others.forEach((button, i) => button.addEventListener("click", () => ask({ do: OTHERS[i][0] })));

  window.addEventListener("blur", leave);
  return () => window.removeEventListener("blur", leave);
}

// What the page knows.

function learn(known, message, buffers) {
  const { cells = [], board, unseen, say, done, ...rest } = message;
  if (board) Object.assign(known, { board, cells: [], way: [] });
  known.cells.push(...cells);
  Object.assign(known, rest);
  if (unseen !== undefined) known.unseen = unseen ? squares(unseen, buffers[0]) : [];
  if (message.pose) {
    const [x, y] = message.pose;
    const last = known.way.at(-1);
    if (!last || Math.hypot(x - last[0], y - last[1]) > 0.004) known.way.push([x, y]);
  }
}

function squares(n, bits) {
  const all = [];
  for (let k = 0; k < n * n; k += 1) {
    if (bits.getUint8(k >> 3) & (128 >> (k & 7))) all.push([Math.floor(k / n), k % n]);
  }
  return { n, all };
}

// All together.

function render({ model, el }) {
  const parts = build(el);
  const known = { cells: [], way: [], shapes: [] };
  const picture = new Picture(parts.canvas);
  const ask = (message) => model.send(message);
  const clock = new Clock(ask);
  const forget = listen(parts, clock, ask);
  const toggled = { pause: () => known.paused, truth: () => known.truthful, unseen: () => Boolean(known.unseen?.all) };

  let due = 0;
  const show = () => {
    due = 0;
    picture.draw(known);
    parts.score.textContent = known.score ?? "";
    parts.record.textContent = known.record ?? "";
    parts.automatic.textContent = known.automatic?.words ?? "";
    parts.others.forEach((button, i) => {
      const state = toggled[OTHERS[i][0]];
      if (state) button.setAttribute("aria-pressed", String(Boolean(state())));
    });
    const names = known.shapes.map(({ name }) => name).join("; ") || "no shape found yet";
    parts.canvas.setAttribute("aria-label", `The board: ${names}.`);
    parts.root.dataset.scans = known.scans; // what is drawn now
    parts.root.dataset.pose = (known.pose ?? []).join(" ");
  };
  const soon = () => (due ||= requestAnimationFrame(show));

  const hear = (message, buffers) => {
    if (message.done) clock.answered();
    learn(known, message, buffers);
    if (message.say) parts.says.textContent = message.say;
    soon();
  };
  model.on("msg:custom", hear);
  const sized = new ResizeObserver(soon);
  sized.observe(parts.canvas);
  ask({ do: "hello" });

  return () => {
    clock.stop();
    clearInterval(clock.timer);
    model.off("msg:custom", hear);
    sized.disconnect();
    cancelAnimationFrame(due);
    forget();
  };
}

export default { render };
