// The other side of `ibr-ref hunt --page`: a page hands over what it draws of one case after another.
//
//   import { port } from "ADDRESS/port.js";
//   await port(async (read, files) => ({ "color.npy": bytes }));
//
// read("case.json") is a promise of an ArrayBuffer, of any of the case's files; what is returned are files by name, as
// ArrayBuffers, typed arrays or Blobs. It ends with the hunt.
const base = new URL(".", import.meta.url);
const at = async (place, options) => {
  const answer = await fetch(new URL(place, base), options);
  if (!answer.ok) throw new Error(`${place}: ${answer.status}`);
  return answer;
};

export const port = async (draw) => {
  for (;;) {
    const { number, files, over } = await at("next").then((answer) => answer.json()).catch(() => ({ over: true }));
    if (over) return;
    if (number === null) continue;
    let said = "ok";
    try {
      const drawn = await draw(async (name) => (await at(`case/${name}`)).arrayBuffer(), files);
      for (const [name, body] of Object.entries(drawn)) await at(`drawn/${number}/${name}`, { method: "POST", body });
    } catch (error) { said = String(error).slice(0, 200); }
    await at(`done/${number}`, { method: "POST", body: said }).catch(() => {}); // it took too long: there is another one
  }
};
