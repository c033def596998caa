// The scene in the page: what it shows, and what it hears. The kernel puts board.js and hand.js in front of it: widgets
// come as one module.

const OTHERS = [
  ["pause", "Pause", true],
  ["undo", "Back to the start", false],
  ["unseen", "What have I not seen yet?", true],
  ["truth", "Show the truth", true],
  ["move", "Move something", false],
  ["automatic", "Compare: automatic", false],
];
const LEGEND = [
  "Thin lines: beams. Dots: cells that were hit. In colour: certain; grey, with ?: not certain what it is.",
  "Solid: seen; dashed: only supposed. Thick: a wall; dotted: of no kind; squares: strays.",
  "Hatched: not seen yet. Pale: the truth. Scans of the robot alone: + at way-points, \u25c7 exploring.",
].join(" ");

// The page.

function build(el) {
  const root = made(el, "div", "primkit-scene", {
    "tabindex": "0",
    "role": "application",
    "aria-label": "Robot on a board. Drive it with W A S D or the arrow keys; Tab leads to the buttons, Escape away.",
    "data-lm-suppress-shortcuts": "true", // else Lab takes the keys for its own: d d deletes a cell
  });
  const seat = made(root, "div", "seat");
  const view = made(seat, "div", "view"), panel = made(seat, "div", "panel");
  const parts = { root };
  parts.canvas = made(view, "canvas", "", { "role": "img", "aria-label": "The board" });
  made(view, "div", "cover", { "aria-hidden": "true" }, "Click to drive");
  parts.focus = made(panel, "p", "focus", {}, AWAY);
  parts.score = made(panel, "p", "score");
  parts.rest = made(panel, "p", "rest");
  parts.trouble = made(panel, "p", "trouble", { "role": "alert" });
  const controls = made(panel, "div", "controls");
  const pad = made(controls, "div", "pad", { "role": "group", "aria-label": "Drive" });
  parts.pad = PAD.map(([word, sign]) => made(pad, "button", word, { "type": "button", "aria-label": word }, sign));
  const others = made(controls, "div", "others");
  parts.others = OTHERS.map(([word, label, toggles]) => {
    const pressed = toggles ? { "aria-pressed": "false" } : {};
    return made(others, "button", word, { "type": "button", ...pressed }, label);
  });
  parts.says = made(panel, "p", "says", { "role": "status", "aria-live": "polite" });
  parts.automatic = made(panel, "div", "automatic", { "role": "status", "aria-live": "polite" });
  parts.record = made(panel, "p", "record");
  const legend = made(panel, "details", "legend");
  made(legend, "summary", "", {}, "What do the lines mean?");
  made(legend, "p", "", {}, LEGEND);
  return parts;
}

// The runs beside each other: by hand, from way-points, explored.

function tabled(place, rows) {
  place.textContent = "";
  if (!rows) return;
  const table = made(place, "table", "");
  rows.forEach((row, number) => {
    const line = made(table, "tr", "");
    row.slice(0, -1).forEach((text, i) => made(line, number === 0 || i === 0 ? "th" : "td", "", {}, text));
    if (row.at(-1)) line.title = row.at(-1);
  });
  rows.filter((row) => row.at(-1)).forEach((row) => made(place, "p", "", {}, `${row[0]}: ${row.at(-1)}.`));
}

// What the page knows.

function learn(known, message, buffers) {
  const { cells = [], gone = [], board, unseen, say, done, busy, ...rest } = message;
  if (board) Object.assign(known, { board, cells: new Map(), way: [] });
  gone.forEach((cell) => known.cells.delete(cell.join()));
  cells.forEach((cell) => known.cells.set(cell.join(), cell));
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

const write = (part, words = "") => part.textContent === words || (part.textContent = words); // told aloud only if new

function render({ model, el }) {
  const parts = build(el);
  const known = { cells: new Map(), way: [], shapes: [] };
  const picture = new Picture(parts.canvas, parts.root);
  let silent;
  const ask = (message) => {
    silent ??= setTimeout(() => {
      known.trouble = SILENT;
      soon();
    }, LATE);
    model.send(message);
  };
  const clock = new Clock(ask);
  const forget = listen(parts, clock, ask);
  const toggled = { pause: () => known.paused, truth: () => known.truthful, unseen: () => Boolean(known.unseen?.all) };

  let due = 0, tabled_;
  const show = () => {
    due = 0;
    if (!known.board) return;
    picture.draw(known);
    write(parts.score, known.score);
    write(parts.rest, known.rest && `Also ${known.rest}.`);
    write(parts.trouble, known.trouble);
    write(parts.record, known.record);
    if (known.automatic !== tabled_) tabled(parts.automatic, (tabled_ = known.automatic)?.table);
    parts.others.forEach((button, i) => {
      const state = toggled[OTHERS[i][0]];
      if (OTHERS[i][0] === "move") button.hidden = !known.moving;
      if (state) button.setAttribute("aria-pressed", String(Boolean(state())));
    });
    parts.canvas.setAttribute("aria-label", told(known));
    parts.root.dataset.scans = known.scans; // what is drawn now
    parts.root.dataset.pose = known.pose.join(" ");
    parts.root.dataset.busy = clock.busy; // whether shapes are looked for still
  };
  const soon = () => (due ||= requestAnimationFrame(show));

  const hear = (message, buffers) => {
    silent = clearTimeout(silent);
    if (known.trouble === SILENT) known.trouble = "";
    clock.hear(message);
    learn(known, message, buffers);
    if (message.say) write(parts.says, message.say);
    soon();
  };
  model.on("msg:custom", hear);
  const unwatch = onLook(parts.canvas, soon);
  ask({ do: "hello" });
  takeFocus(parts.root);

  return () => {
    clearTimeout(silent);
    clock.stop();
    clock.end();
    model.off("msg:custom", hear);
    unwatch();
    cancelAnimationFrame(due);
    forget();
  };
}

export default { render };
