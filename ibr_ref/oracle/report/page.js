"use strict";
(async () => {
  const viewer = document.getElementById("viewer"), canvas = document.getElementById("picture");
  const width = Number(viewer.dataset.width), height = Number(viewer.dataset.height);
  const slider = document.getElementById("slider"), gain = document.getElementById("gain"), seam = document.getElementById("seam");
  const cross = document.getElementById("cross");
  const data = JSON.parse(document.getElementById("data").textContent);

  // Pictures.
  const pixels = async (source) => {
    if (source === null) return null;
    const image = Object.assign(new Image(), { src: source });
    await image.decode();
    const context = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d", { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, width, height).data;
  };
  const [reference, added, status, shift] = await Promise.all(["reference", "port", "status", "shift"].map((name) => pixels(data[name])));
  const port = added === null ? null : added.map((value, i) => (i % 4 === 3 ? 255 : reference[i] + value) & 255);
  const STATES = ["right", "undecided", "wrong", "wrong"];
  const layers = {
    reference: () => reference,
    port: () => reference.map((value, i) => ((i >> 2) % width >= (Number(slider.value) / 100) * width ? port[i] : value)),
    difference: () => reference.map((value, i) => (i % 4 === 3 ? 255 : Number(gain.value) * Math.abs(port[i] - value))),
    marks: () => reference.map((value, i) => {
      if (i % 4 === 3) return 255;
      const at = i - (i % 4), state = STATES[status[at]];
      if (state === "right") return 16 + 0.15 * (reference[at] + reference[at + 1] + reference[at + 2]);
      return (state === "wrong" ? [255, 32, 64] : [255, 176, 0])[i % 4];
    }),
    shift: () => shift,
  };
  let layer = "reference";
  const show = (name) => {
    layer = name;
    const context = canvas.getContext("2d");
    context.putImageData(new ImageData(new Uint8ClampedArray(layers[name]()), width, height), 0, 0);
    seam.hidden = name !== "port";
    if (slider !== null) seam.style.left = slider.value + "%";
    for (const button of document.querySelectorAll("button[data-layer]"))
      button.setAttribute("aria-pressed", String(button.dataset.layer === name));
    if (gain !== null) document.getElementById("times").textContent = `${gain.value} times`;
  };
  for (const button of document.querySelectorAll("button[data-layer]"))
    button.addEventListener("click", () => show(button.dataset.layer));
  if (slider !== null) slider.addEventListener("input", () => show("port"));
  if (gain !== null) {
    let largest = 1;
    reference.forEach((value, i) => { if (i % 4 !== 3) largest = Math.max(largest, Math.abs(port[i] - value)); });
    gain.value = String(Math.max(1, Math.floor(255 / largest)));
    gain.addEventListener("input", () => show("difference"));
  }

  // Numbers: unpacked when a pixel is first looked at. Bytes of equal weight stand together.
  const places = new Map(data.kept.map((tile, i) => [tile, i])), across = Math.ceil(width / data.tile);
  const unpack = async (packed) => {
    if (packed === null || packed === "") return null;
    const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const planes = new Uint8Array(await new Response(stream).arrayBuffer()), count = planes.length / 4;
    const found = new Uint32Array(count);
    for (let i = 0; i < count; i++)
      found[i] = planes[i] | (planes[count + i] << 8) | (planes[2 * count + i] << 16) | (planes[3 * count + i] << 24);
    return found;
  };
  let unpacked = null;
  const arrays = () => (unpacked ??= Promise.all(data.arrays.map(async (a) => {
    const [ours, off, wrong] = await Promise.all([a.reference, a.port, a.wrong].map(unpack));
    const as = (bits) => (a.kind === "int" ? new Int32Array(bits.buffer) : new Float32Array(bits.buffer));
    const theirs = a.port === null ? null : as(off === null ? ours : ours.map((value, i) => (value ^ off[i]) >>> 0));
    return { ...a, reference: as(ours), port: theirs, wrong };
  })));
  const shown = (array, numbers, place) => {
    if (numbers === null) return "";
    const values = Array.from(numbers.subarray(place * array.channels, (place + 1) * array.channels));
    return values.map((v) => (array.kind === "int" ? String(v) : Number.isFinite(v) ? String(+v.toPrecision(7)) : String(v))).join(", ");
  };
  let asked = "";
  const inspect = async (x, y) => {
    const me = (asked = `${x}, ${y}`);
    const size = viewer.clientWidth / width;
    Object.assign(cross.style, { left: x * size + "px", top: y * size + "px", width: size + "px", height: size + "px" });
    document.getElementById("place").textContent = me;
    document.getElementById("status").textContent = status === null ? "" : STATES[status[4 * (y * width + x)]];
    const found = await arrays();
    if (asked !== me) return;
    const tile = Math.floor(y / data.tile) * across + Math.floor(x / data.tile), body = document.getElementById("values");
    body.textContent = "";
    document.getElementById("left-out").hidden = places.has(tile);
    if (!places.has(tile)) return;
    const place = places.get(tile) * data.tile ** 2 + (y % data.tile) * data.tile + (x % data.tile);
    for (const array of found) {
      const row = body.insertRow();
      for (const text of [array.name, shown(array, array.reference, place), shown(array, array.port, place)]) row.insertCell().textContent = text;
      row.classList.toggle("wrong", array.wrong !== null && array.wrong[place] !== 0);
    }
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
  for (const rows of document.querySelectorAll("tbody.folded"))
    rows.querySelector("button").addEventListener("click", () => rows.classList.toggle("open"));

  // "#x,y" or "#x,y,percent" opens the page on a pixel, with the seam there.
  const wanted = location.hash.slice(1).split(",").map(Number);
  const valid = wanted.length >= 2 && wanted.every(Number.isFinite);
  if (valid && wanted.length > 2 && slider !== null) slider.value = String(wanted[2]);
  show(slider !== null ? "port" : "reference");
  const [x, y] = valid ? wanted : [Number(viewer.dataset.x), Number(viewer.dataset.y)];
  await inspect(Math.min(Math.max(x, 0), width - 1), Math.min(Math.max(y, 0), height - 1));
  document.body.dataset.ready = "yes";
})();
