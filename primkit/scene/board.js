// The board in the page: draws what the robot knows. Cells come as an array, or as a map's values.

const FAR = 1e-4; // m: lengths come in tenths of a millimetre
const SMALL = 400; // px: in narrower pictures shapes have their kind written on them, and not their sizes
const LABEL = "600 12px system-ui, sans-serif";

// A part of a page, below its parent.
const made = (parent, tag, className, attributes = {}, words = "") => {
  const part = parent.appendChild(document.createElement(tag));
  part.className = className;
  part.textContent = words;
  Object.entries(attributes).forEach(([name, value]) => part.setAttribute(name, value));
  return part;
};

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
    this.pen.save(); // so that no picture depends on the one before
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
    this.pen.restore();
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
    const { "way-points": points = [], explore = [] } = automatic?.places ?? {}, arm = 0.008;
    for (const [x, y] of this.tenths(points)) {
      this.line([[x - arm, y], [x + arm, y]], colors.grey, 1);
      this.line([[x, y - arm], [x, y + arm]], colors.grey, 1);
    }
    for (const [x, y] of this.tenths(explore)) {
      this.line([[x - arm, y], [x, y + arm], [x + arm, y], [x, y - arm], [x - arm, y]], colors.ink, 1.5);
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
    for (const [i, j] of cells.values()) {
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
