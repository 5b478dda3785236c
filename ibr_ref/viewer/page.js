import { controls } from "./controls.js";
import { nearer, orbited, panned } from "./orbit.js";

const part = (id) => document.getElementById(id);
const RESTS = 250; // milliseconds without a change
const QUICK = 40; // milliseconds: what is compared is drawn along while the view moves
const IN_FLIGHT = 2; // pictures asked for at once: one is drawn while another one is on its way

const ask = async (name, question) => {
  const answer = await fetch(name, { method: "POST", body: JSON.stringify(question) });
  if (!answer.ok) throw new Error((await answer.json()).error);
  return answer;
};

const start = await (await ask("start", {})).json();
const opened = () => ({ params: {}, scene: {}, camera: null, show: "color", other: start.others.includes("port") ? "port" : start.truth ?? "", seam: 0.7 });
let state = opened();
const view = part("view"), seam = part("seam");

// --- The address: it holds all that was changed. ---

const fragment = () => "#" + encodeURIComponent(JSON.stringify(state));
const restored = () => {
  try {
    const found = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    return { ...opened(), ...found };
  } catch { return opened(); }
};

// --- Pictures ---

let asked = 0, painted = 0, flying = 0, dirty = false, otherTook = Infinity, otherOf = "", resting = 0;
const times = [];

const say = (id, text) => { part(id).textContent = text; };
const paint = (id, answer, bytes) => {
  const [width, height] = answer.headers.get("X-Size").split(" ").map(Number), canvas = part(id);
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(bytes), width, height), 0, 0);
};
const seen = () => JSON.stringify([state.params, state.scene, state.camera, state.show, state.other]);
const atStart = () => state.camera === null && !Object.keys(state.params).length && !Object.keys(state.scene).length;
const hasOther = () => state.other !== "" && (state.other !== "port" || (atStart() && start.drawn.includes(state.show)));

const showSeam = () => {
  const percent = 100 * (hasOther() ? state.seam : 1);
  part("right").style.clipPath = `inset(0 0 0 ${percent}%)`;
  part("right").style.visibility = otherOf === seen() || (hasOther() && otherTook < QUICK) ? "visible" : "hidden";
  seam.style.left = percent + "%";
  seam.hidden = !hasOther();
  const system = state.params[start.chooser] ?? start.knobs.params.find((knob) => knob.name === start.chooser)?.value;
  say("left-name", hasOther() ? (state.other === "port" ? "reference" : system) : "");
  say("right-name", hasOther() ? state.other.replace(/^.*=/, "") + (part("right").style.visibility === "hidden" ? " (at rest)" : "") : "");
};

const drawOther = async () => {
  if (!hasOther()) return;
  const what = seen();
  const answer = await ask("frame", { ...state, right: true });
  const bytes = await answer.arrayBuffer();
  otherTook = Number(answer.headers.get("X-Milliseconds"));
  paint("right", answer, bytes);
  otherOf = what;
  showSeam();
};

const pump = async () => {
  if (!dirty || flying >= IN_FLIGHT) return;
  dirty = false;
  flying++;
  const number = ++asked;
  try {
    const answer = await ask("frame", state);
    const bytes = await answer.arrayBuffer();
    if (number > painted) {
      painted = number;
      paint("left", answer, bytes);
      times.push(performance.now());
      while (times.length > 1 && times[0] < times.at(-1) - 1000) times.shift();
      document.body.dataset.frames = String(painted);
      const rate = times.length > 2 ? `, ${((1000 * (times.length - 1)) / (times.at(-1) - times[0])).toFixed(0)} frames a second` : "";
      say("status", `${answer.headers.get("X-Milliseconds")} ms to render${rate}. ${answer.headers.get("X-Legend")}`);
      say("error", "");
    }
    if (otherTook < QUICK && hasOther() && state.other !== "port") await drawOther();
  } catch (error) { say("error", error.message); }
  flying--;
  pump();
};

const rest = async () => {
  if (flying || dirty) { resting = setTimeout(rest, RESTS); return; }
  history.replaceState(null, "", fragment());
  const what = seen();
  try {
    await drawOther();
    await numbers();
    if (start.truth !== null && state.show === "color") {
      const share = await (await ask("difference", state)).json();
      if (what === seen()) part("status").append(` ${(100 * share).toFixed(2)} % of the pixels visibly differ from ${start.truth.replace(/^.*=/, "")}.`);
    }
  } catch (error) { say("error", error.message); }
  document.body.dataset.rested = what === seen() ? "yes" : "no";
};

const changed = () => {
  dirty = true;
  document.body.dataset.rested = "no";
  clearTimeout(resting);
  resting = setTimeout(rest, RESTS);
  showSeam();
  pump();
};

// --- Numbers of the pixel under the mouse ---

let pixel = null, asking = false;
const place = (event) => {
  const canvas = part("left"), box = view.getBoundingClientRect(), [width, height] = start.size;
  const size = Math.min(box.width / width, box.height / height);
  const x = Math.floor((event.clientX - box.left - (box.width - width * size) / 2) / size);
  const y = Math.floor((event.clientY - box.top - (box.height - height * size) / 2) / size);
  return canvas.width === width && canvas.height === height && x >= 0 && y >= 0 && x < width && y < height ? [x, y] : null;
};
const shown = (values) => (values ?? []).map((v) => (typeof v === "number" && !Number.isInteger(v) ? String(+v.toPrecision(9)) : String(v))).join(", ");
const row = (kind, texts) => {
  const made = document.createElement("tr");
  for (const text of texts) { const cell = document.createElement(kind); cell.textContent = text; made.append(cell); }
  return made;
};
const numbers = async () => {
  const table = part("numbers");
  part("cross").hidden = pixel === null;
  if (pixel === null || asking) return;
  asking = true;
  const [x, y] = pixel;
  try {
    const found = await (await ask("pixel", { ...state, other: hasOther() ? state.other : "", x, y })).json();
    const columns = ["array", "here", "right of the bar", "port"].filter((_, i) => i < 2 || found.some((line) => line[i] !== null));
    const kept = [0, 1, 2, 3].filter((i) => i < 2 || found.some((line) => line[i] !== null));
    table.caption.textContent = `Pixel (${x}, ${y}): column, row from the top`;
    table.tHead.replaceChildren(row("th", columns));
    table.tBodies[0].replaceChildren(...found.map((line) => {
      const made = row("td", kept.map((i) => (i ? shown(line[i]) : line[0])));
      made.classList.toggle("differs", kept.length > 2 && kept.slice(2).some((i) => line[i] !== null && shown(line[i]) !== shown(line[1])));
      return made;
    }));
    const size = view.clientWidth / start.size[0];
    Object.assign(part("cross").style, { left: x * size + "px", top: y * size + "px", width: Math.max(size, 1) + "px", height: Math.max(size, 1) + "px" });
  } catch (error) { say("error", error.message); }
  asking = false;
  if (pixel !== null && (pixel[0] !== x || pixel[1] !== y)) numbers();
};

// --- Mouse ---

let held = null;
const pose = () => state.camera ?? start.camera;
view.addEventListener("contextmenu", (event) => event.preventDefault());
view.addEventListener("pointerdown", (event) => {
  held = event.target === seam ? "seam" : event.shiftKey || event.button !== 0 ? "pan" : "orbit";
  view.setPointerCapture(event.pointerId);
});
view.addEventListener("pointerup", () => { held = null; });
view.addEventListener("pointercancel", () => { held = null; });
view.addEventListener("pointerleave", () => { pixel = null; part("cross").hidden = true; });
view.addEventListener("pointermove", (event) => {
  const box = view.getBoundingClientRect(), across = event.movementX / box.height, down = event.movementY / box.height;
  if (held === "seam") {
    state.seam = Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
    showSeam();
  } else if (held !== null) {
    state.camera = held === "pan" ? panned(pose(), across, down) : orbited(pose(), 4 * across, 4 * down);
    changed();
  } else {
    pixel = place(event);
    if (document.body.dataset.rested === "yes") numbers();
  }
});
view.addEventListener("wheel", (event) => {
  event.preventDefault();
  state.camera = nearer(pose(), Math.exp(-0.001 * event.deltaY), start.perspective);
  changed();
}, { passive: false });

// --- Controls ---

const list = (id, values, name) => {
  const select = part(id);
  for (const [value, text] of values) select.add(new Option(text, value));
  select.addEventListener("input", () => { state[name] = select.value; refresh(); });
};
list("show", start.shows.map((name) => [name, name === "color" ? "the picture" : name]), "show");
list("other", [["", "nothing"], ...start.others.map((name) => [name, { port: "the port's drawing", opened: "as the page opened" }[name] ?? name])], "other");
const showControls = controls(part("knobs"), start, (group, name, value) => {
  state[group] = { ...state[group], [name]: value };
  if (start.knobs[group].find((knob) => knob.name === name).value === value) delete state[group][name];
  showControls(state);
  changed();
});
const refresh = () => {
  part("show").value = state.show;
  part("other").value = state.other;
  otherTook = Infinity;
  showControls(state);
  changed();
};
part("reset").addEventListener("click", () => { state = opened(); refresh(); });
const saved = (blob, name) => {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
for (const [id, name] of [["png", "picture.png"], ["case", "case.zip"]])
  part(id).addEventListener("click", async () => {
    part(id).disabled = true;
    try { saved(await (await ask(name, state)).blob(), name); say("error", ""); } catch (error) { say("error", error.message); }
    part(id).disabled = false;
  });
part("link").addEventListener("click", async () => {
  history.replaceState(null, "", fragment());
  try { await navigator.clipboard.writeText(location.href); say("error", ""); } catch { say("error", "The address above is the link."); }
});
window.addEventListener("hashchange", () => { state = restored(); refresh(); });

say("title", start.title);
document.title = start.title;
view.style.setProperty("--ratio", String(start.size[0] / start.size[1]));
state = restored();
refresh();
document.body.dataset.ready = "yes";
