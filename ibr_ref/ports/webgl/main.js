// Draws the cases that the server has, one after the other.

import {readCase} from "./case.js";
import {Device} from "./gl.js";
import {encode} from "./npy.js";

const METHODS = ["displacement", "splatting", "shadows"];

const log = text => { document.getElementById("log").textContent += "\n" + text; };
const post = (address, body) => fetch(address, {method: "POST", body});

async function drawn(device) {
    const given = await readCase("case/");
    if (!METHODS.includes(given.method)) throw new Error(`${given.method} has no port in WebGL`);
    const port = await import(`./${given.method}.js`);
    const arrays = await port.draw(device, given);
    const error = device.gl.getError();
    if (error) throw new Error(`WebGL error ${error}`);
    for (const [name, {data, shape}] of Object.entries(arrays))
        if (given.expected.includes(name)) await post("drawn/" + name, encode(data, shape));
    log(given.name);
}

try {
    const device = new Device();
    const bits = device.gl.getParameter(device.gl.SUBPIXEL_BITS);
    await post("device", JSON.stringify({words: device.words, subpixel_bits: bits}));
    while (await (await fetch("next")).json()) {
        try {
            await drawn(device);
            await post("done", "");
        } catch (error) {
            await post("done", String(error.message ?? error));
        }
    }
} catch (error) {
    await post("device", JSON.stringify({error: String(error.message ?? error)}));
}
