// The board in the page: draws what the robot knows. Cells come as an array, or as a map's values.

const SMALL = 400; // px: in narrower pictures shapes have their kind written on them, and not their sizes
const PLAIN = "12px system-ui, sans-serif", LABEL = `600 ${PLAIN}`, SIGN = "700 18px system-ui, sans-serif";
const DARK = 0.4; // a background that is darker than this share of white is a dark one
const TOWARDS_WHITE = 0.5; // so far colours go there on a dark background: a contrast of 4.5 and more

// A part of a page, below its parent.
const made = (parent, tag, className, attributes = {}, words = "") => {
  const part = parent.appendChild(document.createElement(tag));
  part.className = className;
  part.textContent = words;
  Object.entries(attributes).forEach(([name, value]) => part.setAttribute(name, value));
  return part;
};

// Tells whenever the page may look different: another size, another theme. Returns how to stop that.
const onLook = (part, tell) => {
  const sized = new ResizeObserver(tell), themed = new MutationObserver(tell);
  sized.observe(part);
  themed.observe(document.body, { attributes: true });
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  system.addEventListener("change", tell);
  return () => {
    sized.disconnect();
    themed.disconnect();
    system.removeEventListener("change", tell);
  };
};

// The colours of a theme: on a dark background greys are turned round, and colours go halfway to white.

const parts = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
const isGrey = ([red, green, blue]) => red === green && green === blue;
const onDark = (color) => {
  const rgb = parts(color);
  const towards = (part) => (isGrey(rgb) ? 255 - part : Math.round(part + (255 - part) * TOWARDS_WHITE));
  return `rgb(${rgb.map(towards).join()})`;
};
const eachOnDark = (colors) => Object.fromEntries(Object.entries(colors).map(([name, color]) => [name, onDark(color)]));

function theme(root, { colors, kinds, inks }) {
  const back = getComputedStyle(root).backgroundColor;
  const [red, green, blue] = back.match(/[\d.]+/g).map(Number);
  const dark = (red + green + blue) / 765 < DARK;
  root.classList.toggle("dark", dark);
  if (!dark) return { back, ...colors, kinds, inks };
  return { back, ...eachOnDark(colors), kinds: eachOnDark(kinds), inks: eachOnDark(kinds) };
}

class Picture {
  constructor(canvas, root) {
    this.canvas = canvas;
    this.root = root;
    this.pen = canvas.getContext("2d");
  }

  draw(known) {
    const { board, look, pose } = known;
    const width = this.canvas.clientWidth, sharp = window.devicePixelRatio || 1;
    if (!board || !width) return;
    const side = Math.round(width * sharp);
    if (this.canvas.width !== side) this.canvas.width = this.canvas.height = side;
    this.pen.save(); // so that no picture depends on the one before
    this.pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    this.pen.clearRect(0, 0, width, width);
    this.low = 40; // px: room for the scales, left of the board and below it
    this.scale = (width - this.low - 8) / board.size;
    this.half = board.size / 2;
    this.unit = board.unit; // m: lengths come in tenths of a millimetre, times the board's scale
    this.width = width;
    this.color = theme(this.root, look);
    this.unseen(known);
    this.frame(board);
    this.pen.save();
    this.pen.beginPath();
    this.pen.rect(this.low - 2, 0, width, width - this.low + 2); // what is wrong may lie anywhere: not on the scales
    this.pen.clip();
    (known.truth ?? []).forEach((ring) => this.line(this.tenths(ring), this.color.grey, 4, [], 0.5));
    this.places(known.automatic);
    this.line(known.way, this.color.grey, 1);
    this.beams(known);
    this.cells(known);
    this.rest(known);
    known.shapes.forEach((shape) => this.outline(shape));
    this.pen.restore();
    this.robot(pose, board);
    known.shapes.forEach((shape) => this.label(shape));
    this.pen.restore();
  }

  at([x, y]) {
    return [this.low + (x + this.half) * this.scale, 8 + (this.half - y) * this.scale];
  }

  tenths(points) {
    return points.map(([x, y]) => [x * this.unit, y * this.unit]);
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

  words(text, [x, y], color, align, font = PLAIN) {
    Object.assign(this.pen, { fillStyle: color, textAlign: align, textBaseline: "middle", font });
    this.pen.fillText(text, x, y);
  }

  // Words with a rim of the background, to be read on anything.
  label_(text, [x, y], color, font) {
    const { pen } = this;
    Object.assign(pen, { strokeStyle: this.color.back, lineWidth: 4, lineJoin: "round", textAlign: "center", font });
    pen.textBaseline = "middle";
    pen.strokeText(text, x, y);
    this.words(text, [x, y], color, "center", font);
  }

  frame({ size }) {
    const h = this.half, { low } = this, { ink } = this.color;
    this.line([[-h, -h], [h, -h], [h, h], [-h, h], [-h, -h]], ink, 1);
    for (const share of [-0.4, -0.2, 0, 0.2, 0.4]) {
      const value = share * size, text = value.toFixed(Math.max(0, 1 - Math.floor(Math.log10(size)))).replace("-", "−");
      const [x, y] = this.at([value, -h]);
      this.words(text, [x, y + 10], ink, "center");
      this.words(text, [low - 4, this.at([0, value])[1]], ink, "right");
    }
    this.words("x [m]", [this.at([0, -h])[0], this.at([0, -h])[1] + 24], ink, "center");
    this.pen.save();
    this.pen.translate(8, this.at([0, 0])[1]);
    this.pen.rotate(-Math.PI / 2);
    this.words("y [m]", [0, 0], ink, "center");
    this.pen.restore();
  }

  unseen({ unseen, board }) {
    if (!unseen?.all) return;
    const side = board.size / unseen.n;
    const { pen } = this;
    pen.beginPath();
    for (const [i, j] of unseen.all) {
      const x = i * side - this.half, y = j * side - this.half; // a stroke from corner to corner: together, a hatching
      pen.moveTo(...this.at([x, y]));
      pen.lineTo(...this.at([x + side, y + side]));
    }
    Object.assign(pen, { strokeStyle: this.color.grey, lineWidth: 1, globalAlpha: 0.6 });
    pen.stroke();
    pen.globalAlpha = 1;
  }

  places(automatic) {
    const { "way-points": points = [], explore = [] } = automatic?.places ?? {}, arm = 80 * this.unit;
    for (const [x, y] of this.tenths(points)) {
      this.line([[x - arm, y], [x + arm, y]], this.color.grey, 1);
      this.line([[x, y - arm], [x, y + arm]], this.color.grey, 1);
    }
    for (const [x, y] of this.tenths(explore)) {
      this.line([[x - arm, y], [x, y + arm], [x + arm, y], [x, y - arm], [x - arm, y]], this.color.ink, 1.5);
    }
  }

  beams({ pose: [x, y, heading], ranges, board }) {
    ranges.forEach((range, beam) => {
      const bearing = heading + (2 * Math.PI * beam) / ranges.length;
      const far = range < 0 ? board.reach : range * board.unit;
      const end = [x + far * Math.cos(bearing), y + far * Math.sin(bearing)];
      this.line([[x, y], end], this.color.beam, 1, range < 0 ? [2, 4] : [], range < 0 ? 0.35 : 0.9);
      if (range < 0) return;
      this.pen.fillStyle = this.color.hit;
      this.pen.beginPath();
      this.pen.arc(...this.at(end), 3, 0, 2 * Math.PI);
      this.pen.fill();
    });
  }

  cells({ cells, board }) {
    this.pen.fillStyle = this.color.ink;
    for (const [i, j] of cells.values()) {
      const [x, y] = this.at([(i + 0.5) * board.cell, (j + 0.5) * board.cell]);
      this.pen.fillRect(x - 0.75, y - 0.75, 1.5, 1.5);
    }
  }

  // What is no shape: walls, things of no kind, and strays.
  rest({ walls = [], others = [], strays = [] }) {
    walls.forEach((wall) => this.line(this.tenths(wall), this.color.ink, 4, [], 0.6));
    others.forEach((ring) => this.line(this.tenths(ring), this.color.ink, 2, [2, 3]));
    for (const [x, y] of this.tenths(strays)) {
      const [across, down] = this.at([x, y]);
      Object.assign(this.pen, { strokeStyle: this.color.hit, lineWidth: 1 });
      this.pen.strokeRect(across - 2, down - 2, 4, 4);
    }
  }

  outline({ kind, certain, stretches }) {
    const color = certain ? this.color.kinds[kind] : this.color.grey;
    for (const [seen, points] of stretches) this.line(this.tenths(points), color, seen ? 3 : 1.5, seen ? [] : [6, 5]);
  }

  label({ kind, certain, name, place, stretches }) {
    const { pen } = this, comma = name.indexOf(", ");
    const long = this.width < SMALL ? [name.slice(0, comma)] : [name.slice(0, comma), name.slice(comma + 2)];
    const lines = certain ? long : ["?"], font = certain ? LABEL : SIGN;
    pen.font = font;
    const half = Math.max(...lines.map((text) => pen.measureText(text).width)) / 2 + 3;
    const [across, down] = this.at(this.tenths([place])[0]);
    const outline = stretches.flatMap(([, points]) => this.tenths(points)).map((point) => this.at(point));
    const top = Math.min(...outline.map(([, y]) => y));
    const fits = outline.every(([x, y]) => Math.abs(x - across) > half || Math.abs(y - down) > 16);
    const low = this.width - this.low - 12 - 16 * (lines.length - 1);
    const x = Math.min(Math.max(across, this.low + half), this.width - 8 - half); // a label stays on the board
    const first = fits ? down - 8 * (lines.length - 1) : top - 16 * lines.length + 4; // or above it
    const y = Math.min(Math.max(first, 16), low);
    lines.forEach((text, i) => this.label_(text, [x, y + 16 * i], certain ? this.color.inks[kind] : this.color.ink, font));
  }

  robot([x, y, heading], { body }) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(...this.at([x, y]), body * this.scale, 0, 2 * Math.PI);
    Object.assign(pen, { fillStyle: this.color.back, strokeStyle: this.color.ink, lineWidth: 2 });
    pen.fill();
    pen.stroke();
    this.line([[x, y], [x + body * Math.cos(heading), y + body * Math.sin(heading)]], this.color.ink, 3);
  }
}

// All that is on the board, in words.

function told({ board, pose, shapes, rest }) {
  const metres = (length) => length.toFixed(Math.max(0, Math.round(-2 - Math.log10(board.unit))));
  const [x, y, heading] = pose.map((value, i) => (i < 2 ? metres(value) : Math.round((value * 180) / Math.PI)));
  const at = ([across, up]) => `at ${metres(across * board.unit)}, ${metres(up * board.unit)}`;
  const robot = `A board of ${board.size} m. The robot is at ${x}, ${y} m, heading ${heading} degrees.`;
  const names = shapes.map(({ certain, name, place }) => `${certain ? name : "something not certain"} ${at(place)}`);
  return `${robot} ${names.length ? `Found: ${names.join("; ")}.` : "No shape found yet."}${rest ? ` Also ${rest}.` : ""}`;
}
