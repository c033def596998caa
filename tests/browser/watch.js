// Watches one slider panel from inside the page, where no other clock is in the way: when its picture changes, how
// long after the key that was, how tall the cell's output is each time, and whether an error stands in it.
(root) => {
  const area = root.closest(".jp-OutputArea") ?? root;
  const failure = /could not be drawn.{0,100}|\w+(Error|Exception): .{0,100}/;
  const watch = { seen: "", pressed: 0 };

  watch.markup = () => [...root.querySelectorAll("svg")].map((svg) => svg.outerHTML).join("");
  watch.look = () => {
    const add = (list, entry) => list.includes(entry) || list.push(entry);
    add(watch.heights, Math.round(area.getBoundingClientRect().height));
    const words = root.textContent.match(failure);
    if (words) add(watch.failures, words[0]);
    if (watch.markup() === watch.seen) return;
    if (watch.pressed) watch.waits.push(performance.now() - watch.pressed);
    watch.seen = watch.markup();
    watch.pressed = 0;
  };
  watch.anew = () => {
    Object.assign(watch, { heights: [], failures: [], waits: [], pressed: 0, seen: watch.markup() });
    watch.look();
  };

  watch.anew();
  root.addEventListener("keydown", (event) => (watch.pressed = event.timeStamp), { capture: true });
  new MutationObserver(watch.look).observe(root, { subtree: true, childList: true, characterData: true });
  return watch;
};
