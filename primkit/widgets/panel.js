// What ipywidgets leaves out for a slider: its name and a rounded value for who cannot see it, keys that the notebook
// leaves alone (an arrow would go to the next cell, D D delete this one), and a word when Python does not answer.
const LATE = 5000; // ms: an answer that has not come by then will not come
const SILENT = "Python does not answer. Is another cell running? After a restart of the kernel, run this cell again.";

// What stands beside a control, or else above it.
const named = (control) =>
  control.querySelector(".widget-label")?.textContent.trim() || control.previousElementSibling?.textContent.trim() || "";

const tell = (slider) => {
  const [handle, readout] = [".noUi-handle", ".widget-readout"].map((part) => slider.querySelector(part));
  const say = () => {
    if (handle.getAttribute("aria-valuetext") !== readout.textContent)
      handle.setAttribute("aria-valuetext", readout.textContent);
  };
  handle.setAttribute("aria-label", named(slider));
  new MutationObserver(say).observe(handle, { attributes: true, attributeFilter: ["aria-valuetext"] });
  new MutationObserver(say).observe(readout, { childList: true, characterData: true, subtree: true });
  say();
};

function render({ model, el }) {
  let late = 0;
  const answered = () => {
    clearTimeout(late);
    late = 0;
    el.textContent = "";
  };
  const ask = () => {
    if (late) return;
    late = setTimeout(() => (el.textContent = SILENT), LATE);
    model.send({});
  };
  const attach = () => {
    const panel = el.closest(".primkit-panel");
    const handles = panel?.querySelectorAll(".noUi-handle") ?? [];
    if (!panel || handles.length < model.get("sliders")) return requestAnimationFrame(attach); // not there yet
    // Whatever has the focus: some shortcuts ask the target alone.
    panel.addEventListener("focusin", ({ target }) => (target.dataset.lmSuppressShortcuts = "true"));
    panel.querySelectorAll(".widget-hslider").forEach(tell);
    for (const choice of panel.querySelectorAll(".widget-toggle-buttons")) {
      choice.setAttribute("role", "group");
      choice.setAttribute("aria-label", named(choice));
    }
    for (const move of ["keydown", "pointerup"]) panel.addEventListener(move, ask);
  };
  el.setAttribute("role", "alert");
  model.on("msg:custom", answered);
  attach();
}

export default { render };
