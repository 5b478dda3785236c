// An exported case: case.json, with the arrays of the files that it names in their places.

import {decode} from "./npy.js";

/** {name, method, scene, params, expected} of the folder at an address; arrays are {shape, data}. */
export async function readCase(address) {
    const document = await (await fetch(address + "case.json")).json();
    const part = async value => {
        if (Array.isArray(value)) return Promise.all(value.map(part));
        if (value === null || typeof value !== "object") return value;
        if ("file" in value) return stored(address, value);
        const fields = Object.entries(value).map(async ([key, each]) => [key, await part(each)]);
        return Object.fromEntries(await Promise.all(fields));
    };
    const [scene, params] = await Promise.all([part(document.scene), part(document.params)]);
    return {name: document.name, method: document.method, scene, params, expected: document.expected.map(e => e.name)};
}

async function stored(address, value) {
    const array = decode(await (await fetch(address + value.file)).arrayBuffer());
    if (value.values === "k / 255") array.data = Float64Array.from(array.data, k => k / 255);
    return array;
}
