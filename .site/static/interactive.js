// What moves in a lesson's page without Python: sliders among stored pictures, predictions that are kept and come back
// beside the answer, and quizzes that count the first try. Nothing is asked from anywhere; guesses stay in this browser.
"use strict";
const made = (tag, parent, about = {}) => parent.appendChild(Object.assign(document.createElement(tag), about));

// --- sliders: the nearest of the stored pictures -------------------------------------------------------------

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return JSON.parse(await new Response(stream).text());
}

function slider(root, number) {
  const about = JSON.parse(root.dataset.about);
  const picture = root.querySelector(".picture");
  const panel = made("div", root, { className: "controls" });
  const buttons = made("div", root, { className: "settings" });
  const says = made("p", root, { className: "says" });
  const snapped = made("p", root, { className: "snapped" });
  root.prepend(panel, buttons);
  for (const line of [says, snapped]) line.setAttribute("aria-live", "polite");
  let values = [...about.start];
  let states;
  const stored = () => (states ??= unpacked(root.querySelector("script").textContent));
  const tell = () => (says.textContent = [...picture.querySelectorAll("desc")].map((one) => one.textContent).join(" "));
  const shows = about.controls.map((control, place) => knob(control, place));
  const far = (state, wanted) =>
    about.controls.reduce((sum, { choice, values: all }, k) => {
      const apart = choice ? Number(state[k] !== wanted[k]) : Math.abs(state[k] - wanted[k]) / (all.at(-1) - all[0] || 1);
      return sum + apart;
    }, 0);

  async function show(wanted, held) {
    const all = await stored();
    const possible = all.filter((state) => held === undefined || state[held] === wanted[held]);
    const nearest = possible.reduce((best, state) => (far(state, wanted) < far(best, wanted) ? state : best));
    values = nearest.slice(0, -1);
    const moved = about.controls.filter((_, k) => values[k] !== wanted[k]).map(({ label }) => label);
    picture.querySelector(".primkit-picture").innerHTML = nearest.at(-1);
    shows.forEach((put, k) => put(values[k]));
    snapped.textContent = moved.length
      ? `This page holds no picture of that; this is the nearest one: ${moved.join(", ")} moved along. The lesson itself draws them all.`
      : "";
    tell();
  }

  function knob(control, place) {
    const id = `primkit-${number}-${place}`;
    const move = (value) => show(Object.assign([...values], { [place]: value }), place);
    if (control.choice) {
      made("span", panel, { id, textContent: control.label });
      const group = made("div", panel, { className: "choice" });
      group.setAttribute("role", "radiogroup");
      group.setAttribute("aria-labelledby", id);
      const options = control.values.map((value) => {
        const label = made("label", group);
        const option = made("input", label, { type: "radio", name: id, checked: value === about.start[place] });
        label.append(` ${value}`);
        option.addEventListener("change", () => move(value));
        return option;
      });
      return (value) => options.forEach((option, k) => (option.checked = control.values[k] === value));
    }
    made("label", panel, { htmlFor: id, textContent: control.label });
    const range = made("input", panel, { id, type: "range", min: 0, max: control.values.length - 1, step: 1 });
    const out = made("output", panel);
    const put = (value) => {
      range.value = control.values.indexOf(value);
      out.textContent = String(value);
      range.setAttribute("aria-valuetext", String(value));
    };
    range.addEventListener("input", () => move(control.values[range.value]));
    put(about.start[place]);
    return put;
  }

  for (const [name, setting] of Object.entries(about.settings)) {
    made("button", buttons, { type: "button", textContent: name }).addEventListener("click", () => show(setting));
  }
  tell();
}

// --- predictions: kept until the answer ----------------------------------------------------------------------

const KEPT_IN = "primkit-guesses";
const kept = () => {
  try {
    return JSON.parse(localStorage.getItem(KEPT_IN)) ?? {};
  } catch {
    return {};
  }
};
const words = (value, unit) => (typeof value === "string" ? value : `${value} ${unit}`.trim());

function keep(name, guess) {
  try {
    localStorage.setItem(KEPT_IN, JSON.stringify({ ...kept(), [name]: guess }));
  } catch {
    // a browser that keeps nothing: the guess stays in the page
  }
  for (const line of document.querySelectorAll(`.primkit-guess[data-name="${name}"]`)) line.textContent = `Your guess: ${guess}.`;
}

function prediction(root) {
  for (const question of JSON.parse(root.dataset.asked)) {
    const group = made("fieldset", root);
    made("legend", group, { textContent: question.ask });
    const said = () => (note.textContent = "kept until the answer");
    if (question.options.length) {
      for (const { says } of question.options) {
        const label = made("label", group);
        const option = made("input", label, { type: "radio", name: `predict-${question.name}` });
        option.checked = kept()[question.name] === says;
        label.append(` ${says}`);
        option.addEventListener("change", () => (keep(question.name, says), said()));
      }
    } else {
      const label = made("label", group);
      const { low: min, high: max, step } = question;
      const range = made("input", label, { type: "range", min, max, step, value: parseFloat(kept()[question.name]) || min });
      range.setAttribute("aria-label", question.ask);
      const out = made("output", label, { textContent: words(Number(range.value), question.unit) });
      range.addEventListener("input", () => (out.textContent = words(Number(range.value), question.unit)));
      range.addEventListener("change", () => (keep(question.name, out.textContent), said()));
    }
    const note = made("p", group, { className: "kept" });
    note.setAttribute("aria-live", "polite");
    if (kept()[question.name] !== undefined) said();
  }
}

// --- quizzes: which options are right stands in the page, what they say in the text ----------------------------

function quiz(script) {
  const all = [...document.querySelectorAll("details")].filter(
    (one) => script.compareDocumentPosition(one) & Node.DOCUMENT_POSITION_FOLLOWING,
  );
  let at = 0;
  for (const rights of JSON.parse(script.textContent)) {
    const options = all.slice(at, (at += rights.length));
    options.forEach((option, k) => {
      option.classList.add("primkit-option", rights[k] ? "right" : "wrong");
      option.addEventListener("toggle", () => {
        if (option.open) options.filter((other) => other !== option).forEach((other) => (other.open = false));
      });
    });
  }
}

// The theme calls its search field "Search" for who cannot see it, and shows its keys as well.
for (const field of document.querySelectorAll(".search-button-field")) field.setAttribute("aria-label", field.textContent.trim());
// What is printed in columns keeps them, and is scrolled where it is too wide; sentences are wrapped.
for (const text of document.querySelectorAll(".cell_output pre")) text.classList.toggle("columns", /\S {2,}\S/.test(text.textContent));
document.querySelectorAll(".primkit-states").forEach(slider);
document.querySelectorAll(".primkit-predict").forEach(prediction);
document.querySelectorAll("script.primkit-quiz").forEach(quiz);
for (const line of document.querySelectorAll(".primkit-guess")) {
  const guess = kept()[line.dataset.name];
  line.textContent = guess === undefined ? "You made no guess: the question stands near the top." : `Your guess: ${guess}.`;
}
