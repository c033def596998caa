// The scene in the page: takes keys and buttons, has the clock, and draws what the kernel sends.

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
const FAR = 1e-4; // m: lengths come in tenths of a millimetre
const SMALL = 400; // px: in narrower pictures shapes have their kind written on them, and not their sizes
const LABEL = "600 12px system-ui, sans-serif";
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

// What the page knows, and its picture.

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

class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
  }

  draw(known) {
    const { board, look, pose } = known;
    if (!board) return;
    const width = this.canvas.clientWidth, sharp = window.devicePixelRatio || 1;
    const side = Math.round(width * sharp);
    if (this.canvas.width !== side) this.canvas.width = this.canvas.height = side;
    this.pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    this.pen.clearRect(0, 0, width, width);
    this.low = 40; // px: room for the scales, left of the board and below it
    this.scale = (width - this.low - 8) / board.size;
    this.half = board.size / 2;
    this.width = width;
    this.unseen(known, look);
    this.frame(board, look);
    (known.truth ?? []).forEach((ring) => this.line(this.tenths(ring), look.colors.grey, 4, [], 0.35));
    this.places(known.automatic, look);
    this.line(known.way, look.colors.grey, 1);
    this.beams(known, look);
    this.cells(known, look);
    known.shapes.forEach((shape) => this.outline(shape, look));
    this.robot(pose, board, look);
    this.labels(known.shapes, look);
  }

  at([x, y]) {
    return [this.low + (x + this.half) * this.scale, 8 + (this.half - y) * this.scale];
  }

  tenths(points) {
    return points.map(([x, y]) => [x * FAR, y * FAR]);
  }

  line(points, color, width, dash = [], alpha = 1) {
    const { pen } = this;
    pen.beginPath();
    points.forEach((point) => pen.lineTo(...this.at(point)));
    Object.assign(pen, { strokeStyle: color, lineWidth: width, globalAlpha: alpha });
    pen.setLineDash(dash);
    pen.stroke();
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  words(text, [x, y], color, align, font = "12px system-ui, sans-serif") {
    Object.assign(this.pen, { fillStyle: color, textAlign: align, textBaseline: "middle", font });
    this.pen.fillText(text, x, y);
  }

  frame({ size }, { colors }) {
    const h = this.half, low = this.low;
    this.line([[-h, -h], [h, -h], [h, h], [-h, h], [-h, -h]], colors.ink, 1);
    for (const share of [-0.4, -0.2, 0, 0.2, 0.4]) {
      const value = share * size, text = value.toFixed(size < 1 ? 2 : 1).replace("-", "−");
      const [x, y] = this.at([value, -h]);
      this.words(text, [x, y + 10], colors.ink, "center");
      this.words(text, [low - 4, this.at([0, value])[1]], colors.ink, "right");
    }
    this.words("x [m]", [this.at([0, -h])[0], this.at([0, -h])[1] + 24], colors.ink, "center");
    this.pen.save();
    this.pen.translate(8, this.at([0, 0])[1]);
    this.pen.rotate(-Math.PI / 2);
    this.words("y [m]", [0, 0], colors.ink, "center");
    this.pen.restore();
  }

  unseen({ unseen, board }, { colors }) {
    if (!unseen?.all) return;
    const side = board.size / unseen.n;
    const { pen } = this;
    pen.beginPath();
    for (const [i, j] of unseen.all) {
      const x = i * side - this.half, y = j * side - this.half; // a stroke from corner to corner: together, a hatching
      pen.moveTo(...this.at([x, y]));
      pen.lineTo(...this.at([x + side, y + side]));
    }
    Object.assign(pen, { strokeStyle: colors.grey, lineWidth: 1, globalAlpha: 0.6 });
    pen.stroke();
    pen.globalAlpha = 1;
  }

  places(automatic, { colors }) {
    for (const [x, y] of this.tenths(automatic?.places ?? [])) {
      this.line([[x - 0.008, y], [x + 0.008, y]], colors.grey, 1);
      this.line([[x, y - 0.008], [x, y + 0.008]], colors.grey, 1);
    }
  }

  beams({ pose: [x, y, heading], ranges, board }, { colors }) {
    ranges.forEach((range, beam) => {
      const bearing = heading + (2 * Math.PI * beam) / ranges.length;
      const far = range < 0 ? board.reach : range * FAR;
      const end = [x + far * Math.cos(bearing), y + far * Math.sin(bearing)];
      this.line([[x, y], end], colors.beam, 1, range < 0 ? [2, 4] : [], range < 0 ? 0.35 : 0.9);
      if (range < 0) return;
      this.pen.fillStyle = colors.hit;
      this.pen.beginPath();
      this.pen.arc(...this.at(end), 3, 0, 2 * Math.PI);
      this.pen.fill();
    });
  }

  cells({ cells, board }, { colors }) {
    this.pen.fillStyle = colors.ink;
    for (const [i, j] of cells) {
      const [x, y] = this.at([(i + 0.5) * board.cell, (j + 0.5) * board.cell]);
      this.pen.fillRect(x - 0.75, y - 0.75, 1.5, 1.5);
    }
  }

  outline({ kind, stretches }, { kinds }) {
    for (const [seen, points] of stretches) this.line(this.tenths(points), kinds[kind], seen ? 3 : 2, seen ? [] : [6, 5]);
  }

  labels(shapes, { inks }) {
    shapes.forEach((shape) => this.label(shape, inks[shape.kind]));
  }

  label({ name, place, stretches }, color) {
    const { pen } = this, comma = name.indexOf(", ");
    const lines = this.width < SMALL ? [name.slice(0, comma)] : [name.slice(0, comma), name.slice(comma + 2)];
    pen.font = LABEL;
    const half = Math.max(...lines.map((text) => pen.measureText(text).width)) / 2 + 3;
    const [across, down] = this.at(this.tenths([place])[0]);
    const outline = stretches.flatMap(([, points]) => this.tenths(points)).map((point) => this.at(point));
    const top = Math.min(...outline.map(([, y]) => y));
    const fits = outline.every(([x, y]) => Math.abs(x - across) > half || Math.abs(y - down) > 16);
    const x = Math.min(Math.max(across, this.low + half), this.width - 8 - half); // a label stays on the board
    const first = fits ? down - 8 * (lines.length - 1) : Math.max(top - 16 * lines.length + 4, 16); // or above it
    lines.forEach((text, i) => {
      Object.assign(pen, { strokeStyle: "#ffffff", lineWidth: 4, lineJoin: "round", textAlign: "center", font: LABEL });
      pen.textBaseline = "middle";
      pen.strokeText(text, x, first + 16 * i);
      this.words(text, [x, first + 16 * i], color, "center", LABEL);
    });
  }

  robot([x, y, heading], { body }, { colors }) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(...this.at([x, y]), body * this.scale, 0, 2 * Math.PI);
    Object.assign(pen, { fillStyle: "#ffffff", strokeStyle: colors.ink, lineWidth: 2 });
    pen.fill();
    pen.stroke();
    this.line([[x, y], [x + body * Math.cos(heading), y + body * Math.sin(heading)]], colors.ink, 3);
  }
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
