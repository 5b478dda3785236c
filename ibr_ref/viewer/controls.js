// Sliders, boxes and lists of what may be turned.
const STEPS = 1000;
const WIDE = 300; // of a longer range the upper part is run through faster and faster

const element = (name, fields = {}, ...children) => {
  const made = Object.assign(document.createElement(name), fields);
  made.append(...children);
  return made;
};

// How a slider runs: from its position, 0 to STEPS, to a value and back.
const scale = (knob) => {
  const whole = knob.kind === "whole", at = Number(knob.value);
  let low = knob.low, high = knob.high;
  if (whole && high - low <= WIDE) return { of: (v) => v, to: (p) => p, min: low, max: high, step: 1 };
  if (!whole && low !== null && high !== null && high - low <= WIDE)
    return { of: (v) => (STEPS * (v - low)) / (high - low), to: (p) => low + (p / STEPS) * (high - low), min: 0, max: STEPS, step: 1 };
  if (whole) [low, high] = [Math.max(low, 1), Math.min(high, Math.max(1000, 20 * at))];
  else if (at !== 0) [low, high] = [Math.abs(at) / 1000, Math.abs(at) * 100];
  else [low, high] = [1e-6, 1];
  const span = Math.log(high / low), sign = at < 0 ? -1 : 1, zero = whole ? knob.low === 0 : true;
  return {
    of: (v) => (v * sign <= 0 ? 0 : 1 + ((STEPS - 1) * Math.log(Math.max(low, v * sign) / low)) / span),
    to: (p) => {
      if (p <= 0 && zero) return 0;
      const value = sign * low * Math.exp((span * Math.max(0, p - 1)) / (STEPS - 1));
      return whole ? Math.round(value) : Number(value.toPrecision(4));
    },
    min: 0, max: STEPS, step: 1,
  };
};

const inputs = (knob, turn) => {
  if (knob.kind === "flag") {
    const box = element("input", { type: "checkbox" });
    box.addEventListener("input", () => turn(box.checked));
    return { parts: [box], set: (value) => { box.checked = value; } };
  }
  if (knob.kind === "choice") {
    const list = element("select", {}, ...knob.values.map((v, i) => new Option(String(v ?? "none"), String(i))));
    list.addEventListener("input", () => turn(knob.values[Number(list.value)]));
    return { parts: [list], set: (value) => { list.value = String(knob.values.indexOf(value)); } };
  }
  const run = scale(knob);
  const slider = element("input", { type: "range", min: run.min, max: run.max, step: run.step });
  const box = element("input", { type: "number", step: knob.kind === "whole" ? 1 : "any" });
  const tell = (value) => { box.value = String(Number(value.toPrecision(6))); };
  slider.addEventListener("input", () => { const value = run.to(Number(slider.value)); tell(value); turn(value); });
  box.addEventListener("change", () => { slider.value = String(run.of(Number(box.value))); turn(Number(box.value)); });
  return { parts: [slider, box], set: (value) => { tell(value); slider.value = String(run.of(value)); } };
};

// Fill `place`; turn(part, name, value) is called for each that is turned. Returns what shows a state's values.
export const controls = (place, start, turn) => {
  const rows = [];
  for (const [part, title] of [["params", "Parameters"], ["scene", "Scene"]]) {
    const knobs = start.knobs[part];
    if (knobs.length) place.append(element("h2", { textContent: title }));
    for (const knob of knobs) {
      const { parts, set } = inputs(knob, (value) => turn(part, knob.name, value));
      const row = element("label", { className: "row", title: knob.says }, element("span", { textContent: knob.name.replaceAll("_", " ") }), ...parts);
      row.dataset.knob = knob.name;
      parts[0].setAttribute("aria-label", knob.name);
      place.append(row);
      rows.push({ part, knob, row, set });
    }
  }
  const chooser = start.knobs.params.find((knob) => knob.name === start.chooser);
  return (state) => {
    const system = state.params[start.chooser] ?? chooser?.value;
    for (const { part, knob, row, set } of rows) {
      const value = state[part][knob.name] ?? knob.value;
      set(value);
      row.classList.toggle("changed", value !== knob.value);
      row.classList.toggle("unread", knob.readers.length > 0 && !knob.readers.includes(system));
    }
  };
};
