// The hand on the robot: the clock, the keys and the buttons.

const KEYS = {
  KeyW: "forward", ArrowUp: "forward",
  KeyS: "back", ArrowDown: "back",
  KeyA: "left", ArrowLeft: "left",
  KeyD: "right", ArrowRight: "right",
};
const PAD = [["forward", "▲"], ["left", "◀"], ["back", "▼"], ["right", "▶"]];
const PERIOD = 100; // ms: a step takes a tenth of a second
const SOON = 90; // ms: timers are not exact
const LATE = 5000; // ms: an answer that has not come by then will not come; the kernel may have been restarted
const SILENT = "Python does not answer. Is another cell running? After a restart of the kernel, run this cell again.";
const AWAY = "Click here, then drive with W A S D or the arrow keys, two at once.";
const HERE = "You drive: W A S D or the arrow keys. Escape or a click elsewhere stops.";
const WRITES = "input, textarea, select, [contenteditable=true]"; // who is writing is not disturbed

// The clock: while something is held it asks for a step every tenth of a second, and once more when all is let go;
// never for a second one before the first is answered. The shortest tap is a step. While the kernel is busy beside the
// drive, and nobody drives, it asks for news as often.

class Clock {
  constructor(ask) {
    this.ask = ask;
    this.held = new Map(); // what holds it (a key, a pointer): the word
    this.tapped = new Set(); // words that were held at some time since the last step
    this.asked = -Infinity;
    this.waits = this.moves = this.busy = false;
  }

  hold(holder, word) {
    if (this.held.get(holder) === word) return; // a key that repeats itself
    this.held.set(holder, word);
    this.tapped.add(word);
    this.start();
    this.tick(); // the first step at once
  }

  start() {
    this.timer ??= setInterval(() => this.tick(), PERIOD);
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
    const drives = this.tapped.size > 0 || this.held.size > 0 || this.moves;
    if (!drives && !this.busy) {
      this.end();
      return;
    }
    const words = new Set([...this.tapped, ...this.held.values()]);
    this.tapped.clear();
    this.moves = words.size > 0;
    this.waits = true;
    this.asked = performance.now();
    this.ask(drives ? { do: "step", held: [...words] } : { do: "news" });
  }

  end() {
    clearInterval(this.timer);
    this.timer = undefined;
  }

  hear({ done, busy }) {
    if (done) this.waits = false;
    if (busy !== undefined) this.busy = busy;
    if (this.busy) this.start();
  }
}

// The focus: a scene that has just come in sight takes it, so that no key goes to the notebook: d d deletes a cell.

function takeFocus(root) {
  const seen = new IntersectionObserver(([entry]) => {
    seen.disconnect();
    if (entry.isIntersecting && !document.activeElement?.closest(WRITES)) root.focus({ preventScroll: true });
  });
  seen.observe(root);
}

function leaveTo(place) {
  document.activeElement.blur();
  place?.focus({ preventScroll: true });
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
    if (event.key === "Escape") leaveTo(root.parentElement.closest("[tabindex]"));
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
    if (!event.target.closest("button, summary")) root.focus({ preventScroll: true });
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
