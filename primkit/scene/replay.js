// A film of a drive in the page: play, pause, and a slider for the time. The kernel puts board.js in front of it, sends
// all at once, and is not needed any more.

const LEGEND = [
  "Thin lines: beams. Dots: cells that were hit. In colour: certain; grey, with ?: not certain what it is.",
  "Solid: seen; dashed: only supposed. Thick: a wall; dotted: of no kind; squares: strays. Pale: the truth.",
].join(" ");
const NOTHING = { shapes: [], score: "0 found", rest: "" };
const STEP = 0.004; // m: the way is drawn in steps of this length
const FASTER = [1, 4, 16]; // times as fast as it was driven

function build(el) {
  const root = made(el, "div", "primkit-scene replay", {
    "role": "group",
    "aria-label": "A drive, played",
    "data-lm-suppress-shortcuts": "true", // else Lab takes the keys of the slider and the buttons for its own
  });
  const seat = made(root, "div", "seat");
  const view = made(seat, "div", "view"), panel = made(seat, "div", "panel");
  const parts = { root };
  parts.canvas = made(view, "canvas", "", { "role": "img", "aria-label": "The board" });
  parts.score = made(panel, "p", "score");
  parts.rest = made(panel, "p", "rest");
  parts.time = made(panel, "input", "time", { "type": "range", "min": "0", "value": "0", "aria-label": "Scan" });
  const controls = made(made(panel, "div", "controls"), "div", "others");
  parts.play = made(controls, "button", "play", { "type": "button" }, "Play");
  parts.speed = made(controls, "button", "speed", { "type": "button" });
  parts.truth = made(controls, "button", "truth", { "type": "button", "aria-pressed": "false" }, "Show the truth");
  made(panel, "p", "legend", {}, LEGEND);
  return parts;
}

// What was known after a scan.

class Film {
  constructor(told, [ranges, cells]) {
    Object.assign(this, told);
    this.ranges = ranges;
    this.cells = Array.from({ length: cells.byteLength / 8 }, (_, k) => [0, 4].map((at) => cells.getInt32(8 * k + at, true)));
  }

  get last() {
    return this.poses.length - 1;
  }

  rangesOf(scan) {
    return Array.from({ length: this.beams }, (_, beam) => this.ranges.getInt16(2 * (scan * this.beams + beam), true));
  }

  wayTo(scan) {
    const way = [];
    this.poses.slice(0, scan + 1).forEach(([x, y], number) => {
      const last = way.at(-1);
      if (!last || number === scan || Math.hypot(x - last[0], y - last[1]) > STEP) way.push([x, y]);
    });
    return way;
  }

  after(scan) {
    const look = this.looks.findLast((one) => one.scan <= scan) ?? NOTHING;
    const { board, look: colors } = this;
    const seen = { pose: this.poses[scan], ranges: this.rangesOf(scan), cells: this.cells.slice(0, this.known[scan]) };
    return { ...look, board, look: colors, ...seen, way: this.wayTo(scan), found: look.score };
  }
}

function render({ model, el }) {
  const parts = build(el);
  const picture = new Picture(parts.canvas, parts.root);
  let film, scan = 0, playing, faster = 0, truthful = false, due = 0;

  const show = () => {
    due = 0;
    if (!film) return;
    const known = film.after(scan);
    picture.draw({ ...known, truth: truthful ? film.truths : [] });
    const time = `${(scan * film.period).toFixed(1)} of ${(film.last * film.period).toFixed(1)} s`;
    parts.score.textContent = `${time} · ${scan + 1} scan${scan ? "s" : ""} · ${known.found}`;
    parts.time.value = scan;
    parts.time.setAttribute("aria-valuetext", parts.score.textContent);
    parts.play.textContent = playing ? "Pause" : "Play";
    parts.speed.textContent = `${FASTER[faster]} × as fast`;
    parts.truth.setAttribute("aria-pressed", String(truthful));
    parts.truth.hidden = film.truths.length === 0;
    parts.rest.textContent = known.rest && `Also ${known.rest}.`;
    parts.canvas.setAttribute("aria-label", told(known));
    parts.root.dataset.scan = scan;
  };
  const soon = () => (due ||= requestAnimationFrame(show));
  const pause = () => {
    clearInterval(playing);
    playing = undefined;
    soon();
  };
  const play = () => {
    clearInterval(playing);
    if (scan >= film.last) scan = 0;
    let at = scan; // by the clock, so that a slow page leaves frames out and not time
    const begun = performance.now(), from = at;
    playing = setInterval(() => {
      at = from + Math.floor(((performance.now() - begun) * FASTER[faster]) / (1000 * film.period));
      scan = Math.min(at, film.last);
      if (scan === film.last) pause();
      soon();
    }, 1000 * Math.min(film.period, 0.05));
    soon();
  };

  const hear = (message, buffers) => {
    film = new Film(message, buffers);
    parts.time.max = film.last;
    soon();
  };
  parts.play.addEventListener("click", () => (playing ? pause() : film && play()));
  parts.speed.addEventListener("click", () => {
    faster = (faster + 1) % FASTER.length;
    if (playing) play();
    soon();
  });
  parts.truth.addEventListener("click", () => {
    truthful = !truthful;
    soon();
  });
  parts.time.addEventListener("input", () => {
    scan = Number(parts.time.value);
    pause();
  });
  parts.root.addEventListener("keydown", (event) => event.key !== "Tab" && event.stopPropagation()); // not the notebook's
  parts.root.addEventListener("click", ({ target }) => target.closest("button") || parts.time.focus()); // nor after a click
  model.on("msg:custom", hear);
  const unwatch = onLook(parts.canvas, soon);
  model.send({ do: "hello" });

  return () => {
    clearInterval(playing);
    model.off("msg:custom", hear);
    unwatch();
    cancelAnimationFrame(due);
  };
}

export default { render };
