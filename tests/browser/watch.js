// Watches one slider panel from inside the page, where no other clock is in the way: when its picture changes, how
// long after the key that was, how tall the cell's output is each time, and whether an error stands in it.
(root) => {
  const area = root.closest(".jp-OutputArea") ?? root;
  const failure = /could not be drawn.{0,100}|\w+(Error|Exception): .{0,100}/;
  const words = () => [...root.querySelectorAll("desc, pre")].map((part) => part.textContent).join("\n");
  const watch = { seen: "", pressed: 0 };

  const height = () => Math.round(area.getBoundingClientRect().height);
  watch.markup = () => [...root.querySelectorAll("svg")].map((svg) => svg.outerHTML).join("");
  watch.look = () => {
    watch.failures.push(...(words().match(failure) ?? []).slice(0, 1));
    if (watch.markup() === watch.seen) return;
    if (watch.pressed) watch.waits.push(performance.now() - watch.pressed);
    watch.seen = watch.markup();
    watch.pressed = 0;
  };
  watch.anew = () => {
    Object.assign(watch, { heights: [height()], failures: [], waits: [], pressed: 0, seen: watch.markup() });
  };

  watch.anew();
  root.addEventListener("keydown", (event) => (watch.pressed = event.timeStamp), { capture: true });
  new ResizeObserver(() => watch.heights.push(height())).observe(area); // once a frame: what an eye can see
  new MutationObserver(watch.look).observe(root, { subtree: true, childList: true, characterData: true });
  return watch;
};
