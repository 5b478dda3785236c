"use strict";
(async () => {
  const viewer = document.getElementById("viewer");
  const width = Number(viewer.dataset.width), height = Number(viewer.dataset.height);
  const slider = document.getElementById("slider"), seam = document.getElementById("seam");
  const cross = document.getElementById("cross");
  const layer = (name) => document.getElementById("layer-" + name);

  // Layers: one on top; "port" is shown right of the seam, over the reference.
  const show = (name) => {
    for (const image of viewer.querySelectorAll("img")) image.classList.remove("shown");
    layer("reference").classList.add("shown");
    layer(name).classList.add("shown");
    const split = name === "port" && slider !== null;
    seam.hidden = !split;
    const percent = slider === null ? 0 : Number(slider.value);
    layer(name).style.clipPath = split ? `inset(0 0 0 ${percent}%)` : "none";
    seam.style.left = percent + "%";
    for (const button of document.querySelectorAll("button[data-layer]"))
      button.setAttribute("aria-pressed", String(button.dataset.layer === name));
  };
  for (const button of document.querySelectorAll("button[data-layer]"))
    button.addEventListener("click", () => show(button.dataset.layer));
  if (slider !== null) slider.addEventListener("input", () => show("port"));
  show(slider !== null ? "port" : "reference");

  // Numbers: deflated little-endian arrays.
  const unpack = async (packed) => {
    if (packed === null) return null;
    const bytes = Uint8Array.from(atob(packed.data), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const buffer = await new Response(stream).arrayBuffer();
    const numbers = packed.kind === "int" ? new Int32Array(buffer) : new Float32Array(buffer);
    return { numbers, channels: packed.channels, integers: packed.kind === "int" };
  };
  const data = JSON.parse(document.getElementById("data").textContent);
  const status = await unpack(data.status);
  const arrays = await Promise.all(data.arrays.map(async (a) => (
    { name: a.name, reference: await unpack(a.reference), port: await unpack(a.port), wrong: await unpack(a.wrong) })));

  const shown = (plane, pixel) => {
    if (plane === null) return "";
    const values = Array.from(plane.numbers.subarray(pixel * plane.channels, (pixel + 1) * plane.channels));
    return values.map((v) => (plane.integers ? String(v) : Number.isFinite(v) ? String(+v.toPrecision(7)) : String(v))).join(", ");
  };
  const inspect = (x, y) => {
    const pixel = y * width + x;
    document.getElementById("place").textContent = `${x}, ${y}`;
    const state = status === null ? "" : ["right", "undecided", "wrong", "wrong"][status.numbers[pixel]];
    document.getElementById("status").textContent = state;
    const body = document.getElementById("values");
    body.textContent = "";
    for (const { name, reference, port, wrong } of arrays) {
      const row = body.insertRow();
      for (const text of [name, shown(reference, pixel), shown(port, pixel)]) row.insertCell().textContent = text;
      row.classList.toggle("wrong", wrong !== null && wrong.numbers[pixel] !== 0);
    }
    const size = viewer.clientWidth / width;
    Object.assign(cross.style, { left: x * size + "px", top: y * size + "px", width: size + "px", height: size + "px" });
  };

  let held = false;
  const at = (event) => {
    const box = viewer.getBoundingClientRect();
    const x = Math.floor(((event.clientX - box.left) / box.width) * width);
    const y = Math.floor(((event.clientY - box.top) / box.height) * height);
    return [Math.min(Math.max(x, 0), width - 1), Math.min(Math.max(y, 0), height - 1)];
  };
  viewer.addEventListener("mousemove", (event) => { if (!held) inspect(...at(event)); });
  viewer.addEventListener("click", (event) => { held = !held; inspect(...at(event)); });

  // "#x,y" or "#x,y,percent" opens the page on a pixel, with the seam there.
  const wanted = location.hash.slice(1).split(",").map(Number);
  const valid = wanted.length >= 2 && wanted.every(Number.isFinite);
  if (valid && wanted.length > 2 && slider !== null) { slider.value = String(wanted[2]); show("port"); }
  const [x, y] = valid ? wanted : [Number(viewer.dataset.x), Number(viewer.dataset.y)];
  inspect(Math.min(Math.max(x, 0), width - 1), Math.min(Math.max(y, 0), height - 1));
  document.body.dataset.ready = "yes";
})();
