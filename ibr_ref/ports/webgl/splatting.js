// Splatting of depth images in WebGL 2, by the shaders of the OpenGL port: two triangles a splat.

import {channels} from "./gl.js";

const ATTACHMENTS = {color: "RGBA32F", splat: "R32I", depth: "R32F"};
const VARYINGS = ["window", "depth", "width", "color"];

/** All arrays of a frame, {data, shape} by name. Throws for what is not ported. */
export async function draw(device, {scene, params}) {
    if (!["square", "disc"].includes(params.shape)) throw new Error(`shape = '${params.shape}': the port allows square, disc`);
    const {gl} = device;
    const {width, height} = scene.camera;
    const target = device.target(width, height, ATTACHMENTS);
    target.begin({color: [...scene.background, 0], splat: [-1, 0, 0, 0], depth: [1, 0, 0, 0]});
    const captured = [], source = [];
    let first = 0;
    for (const [number, image] of scene.images.entries()) {
        const pixels = valid(image);
        const count = pixels.length / 2;
        const textures = upload(device, image, scene.light !== null);
        captured.push(await corners(device, scene, params, image, textures, pixels, first));
        for (let i = 0; i < count; i++) source.push(number, pixels[2 * i + 1], pixels[2 * i]);
        const flags = ["QUADS", "STAGES", "DEPTH_TOO", ...(params.shape === "disc" ? ["DISC"] : [])];
        const program = await device.program(definesOf(scene, image, flags), "splatting.vert", "splatting.frag");
        use(device, program, scene, params, image, textures, first);
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LESS);
        bindPixels(device, pixels, 4);
        const quads = new Uint32Array(6 * count);
        for (let i = 0; i < count; i++) [0, 1, 2, 2, 1, 3].forEach((k, at) => { quads[6 * i + at] = 4 * i + k; });
        device.buffer(quads, gl.ELEMENT_ARRAY_BUFFER);
        gl.drawElements(gl.TRIANGLES, quads.length, gl.UNSIGNED_INT, 0);
        first += count;
    }
    return arrays(target, captured, source);
}

/** Column and row of the valid pixels, row by row. */
function valid({mask: {shape: [rows, columns], data}}) {
    const found = [];
    for (let row = 0; row < rows; row++)
        for (let column = 0; column < columns; column++)
            if (data[row * columns + column]) found.push(column, row);
    return found;
}

function inBytes(image) {
    return image.color.data.every(c => Math.abs(255 * c - Math.round(255 * c)) <= 1e-6);
}

/** The bits of the depth, the bytes of the colour, those of the normal; colours that are no bytes as floats. */
function upload(device, image, lit) {
    const {gl} = device;
    const [height, width] = image.depth.shape;
    const texels = new Uint32Array(4 * width * height);
    const floats = new Float32Array(texels.buffer);
    const word = (data, i, scale) => [0, 1, 2].reduce((sum, k) => sum + (Math.round(scale * data[3 * i + k]) << 8 * k), 0);
    for (let i = 0; i < width * height; i++) {
        floats[4 * i] = image.depth.data[i];
        texels[4 * i + 1] = word(image.color.data, i, 255);
        if (lit) texels[4 * i + 2] = word(image.normals.data, i, 1);
    }
    const texture = device.texture(width, height, "RGBA32UI");
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, texels);
    return inBytes(image) ? {texels: texture} : {texels: texture, colors: device.upload(image.color, {filtered: false})};
}

function definesOf(scene, image, flags) {
    const {light} = scene;
    const names = [...flags];
    if (light) names.push("LIT", `EXPONENT ${light.exponent}`);
    if (light && light.specular > 0) names.push("HAS_SPECULAR");
    if (!inBytes(image)) names.push("COLOR_TEXTURE");
    return names.map(name => `#define ${name}\n`).join("");
}

function use(device, program, scene, params, image, textures, first) {
    device.gl.useProgram(program);
    const {camera, light} = scene;
    const [[fx, skew, cx], [, fy, cy]] = image.camera.intrinsics;
    const perspective = each => each.projection === "perspective" ? 1 : 0;
    device.block(program, "Splats", [image.camera.world_from_view, camera.view_from_world, camera.clip_from_view], [
        [cx, cy, 1 / fx, 1 / fy], [skew, perspective(image.camera), perspective(camera)], camera.eye,
        light ? light.homogeneous : [], light ? [light.ambient, light.diffuse, light.specular] : [],
        [params.alpha, params.beta, params.gamma, params.delta], [params.min_width, params.max_width],
        [camera.width, camera.height, 1, 1],
    ], [first, 0, 0, 0]);
    device.bind(program, textures);
}

function bindPixels(device, pixels, times) {
    const repeated = new Uint32Array(pixels.length * times);
    for (let i = 0; i < pixels.length / 2; i++)
        for (let k = 0; k < times; k++) repeated.set([pixels[2 * i], pixels[2 * i + 1]], 2 * (times * i + k));
    device.buffer(repeated);
    device.attributes(8, [[0, 2, 0, "u"]]);
}

async function corners(device, scene, params, image, textures, pixels, first) {
    const program = await device.program(definesOf(scene, image, ["CAPTURE"]), "splatting.vert", null, VARYINGS);
    use(device, program, scene, params, image, textures, first);
    bindPixels(device, pixels, 1);
    return device.captured(program, pixels.length / 2, 7);
}

function arrays(target, captured, source) {
    const {width, height} = target;
    const rows = captured.flatMap(each => [...each]);
    const count = rows.length / 7;
    const dropped = i => rows[7 * i + 3] < 0;
    const column = (which, blank) => Float32Array.from({length: count * which.length}, (_, at) => {
        const i = Math.floor(at / which.length);
        return blank && dropped(i) ? NaN : rows[7 * i + which[at % which.length]];
    });
    const depth = {data: channels(target.read("depth"), [0]), shape: [height, width]};
    return {
        "vertex.window": {data: column([0, 1], true), shape: [count, 2]},
        "vertex.depth": {data: column([2], true), shape: [count]},
        "vertex.width": {data: column([3], false).map(width => Math.max(width, 0)), shape: [count]},
        "vertex.color": {data: column([4, 5, 6], false), shape: [count, 3]},
        "vertex.source": {data: Int32Array.from(source), shape: [count, 3]},
        "raster.splat": {data: channels(target.read("splat"), [0]), shape: [height, width]},
        "raster.depth": depth,
        color: {data: channels(target.read("color"), [0, 1, 2]), shape: [height, width, 3]},
        depth,
    };
}
