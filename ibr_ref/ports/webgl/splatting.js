// Splatting of depth images in WebGL 2, by the shaders of the OpenGL port: two triangles a splat.

import {channels} from "./gl.js";

const ATTACHMENTS = {color: "RGBA32F", splat: "R32I", depth: "R32F"};
const NEAREST = {splat: "R32I", distance: "R32F", depth: "R32F"};
const SUMS = {sums: "RGBA32F", count: "R32F"};
const VARYINGS = ["window", "depth", "width", "color"];
const OF_ELLIPSES = [...VARYINGS, "covariance", "amplitude", "along"];

/** All arrays of a frame, {data, shape} by name. Throws for what is not ported. */
export async function draw(device, {scene, params}) {
    const shapes = ["square", "disc", "ellipse"];
    if (!shapes.includes(params.shape)) throw new Error(`shape = '${params.shape}': the port allows ${shapes.join(", ")}`);
    const elliptic = params.shape === "ellipse";
    const captured = [], source = [], images = [];
    let first = 0;
    for (const [number, image] of scene.images.entries()) {
        const pixels = valid(image);
        const textures = upload(device, image, scene.light !== null || elliptic);
        images.push({image, pixels, textures, first});
        captured.push(await corners(device, scene, params, image, textures, pixels, first));
        for (let i = 0; i < pixels.length / 2; i++) source.push(number, pixels[2 * i + 1], pixels[2 * i]);
        first += pixels.length / 2;
    }
    const shown = await (elliptic ? averaged : nearest)(device, scene, params, images);
    return {...vertices(captured, source, elliptic), ...shown};
}

/** The splats of all images into the bound frame buffer; more: textures besides an image's own. */
async function splats(device, scene, params, images, flags, fragment, more = {}) {
    const {gl} = device;
    const bound = gl.getParameter(gl.FRAMEBUFFER_BINDING);
    for (const {image, pixels, textures, first} of images) {
        const count = pixels.length / 2;
        const program = await device.program(definesOf(scene, image, ["QUADS", "STAGES", ...flags]), "splatting.vert", fragment);
        use(device, program, scene, params, image, {...textures, ...more}, first);
        gl.bindFramebuffer(gl.FRAMEBUFFER, bound);
        bindPixels(device, pixels, 4);
        const quads = new Uint32Array(6 * count);
        for (let i = 0; i < count; i++) [0, 1, 2, 2, 1, 3].forEach((k, at) => { quads[6 * i + at] = 4 * i + k; });
        device.buffer(quads, gl.ELEMENT_ARRAY_BUFFER);
        gl.drawElements(gl.TRIANGLES, quads.length, gl.UNSIGNED_INT, 0);
    }
}

/** The nearest splat's colour: squares and discs. */
async function nearest(device, scene, params, images) {
    const {gl} = device;
    const {width, height} = scene.camera;
    const target = device.target(width, height, ATTACHMENTS);
    target.begin({color: [...scene.background, 0], splat: [-1, 0, 0, 0], depth: [1, 0, 0, 0]});
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    const flags = ["DEPTH_TOO", ...(params.shape === "disc" ? ["DISC"] : [])];
    await splats(device, scene, params, images, flags, "splatting.frag");
    return picture(target, target);
}

/** Ellipses: the nearest, sums over those of its surface, averages. */
async function averaged(device, scene, params, images) {
    const {gl} = device;
    if (!gl.getExtension("EXT_float_blend")) throw new Error("WebGL 2 without EXT_float_blend");
    const {width, height} = scene.camera;
    const near = device.target(width, height, NEAREST);
    near.begin({splat: [-1, 0, 0, 0], depth: [1, 0, 0, 0]});
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    await splats(device, scene, params, images, ["ELLIPSE", "NEAREST"], "splatting_ellipse.frag");
    const sums = device.target(width, height, SUMS, false);
    sums.begin();
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    await splats(device, scene, params, images, ["ELLIPSE"], "splatting_ellipse.frag", {nearest: near.get("distance")});
    gl.disable(gl.BLEND);
    const target = device.target(width, height, {color: "RGBA32F"}, false);
    target.begin();
    const program = await device.program("", "shadows_screen.vert", "splatting_average.frag");
    gl.useProgram(program);
    device.uniform(program, "background", [...scene.background, 0]);
    device.bind(program, {sums: sums.get("sums")});
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    return {
        ...picture(target, near),
        "raster.weight": {data: channels(sums.read("sums"), [3]), shape: [height, width]},
        "raster.blended": {data: Int32Array.from(channels(sums.read("count"), [0])), shape: [height, width]},
    };
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
        [camera.width, camera.height, 1, 1], [params.footprint, params.low_pass, params.cutoff, params.depth_tolerance],
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
    const elliptic = params.shape === "ellipse";
    const defines = definesOf(scene, image, elliptic ? ["CAPTURE", "ELLIPSE"] : ["CAPTURE"]);
    const program = await device.program(defines, "splatting.vert", null, elliptic ? OF_ELLIPSES : VARYINGS);
    use(device, program, scene, params, image, textures, first);
    bindPixels(device, pixels, 1);
    return device.captured(program, pixels.length / 2, elliptic ? 12 : 7);
}

/** The stages "vertex.*". */
function vertices(captured, source, elliptic) {
    const rows = captured.flatMap(each => [...each]), numbers = elliptic ? 12 : 7;
    const count = rows.length / numbers;
    const dropped = i => rows[numbers * i + 3] < 0;
    const column = (which, blank) => Float32Array.from({length: count * which.length}, (_, at) => {
        const i = Math.floor(at / which.length);
        return blank && dropped(i) ? NaN : rows[numbers * i + which[at % which.length]];
    });
    return {
        "vertex.window": {data: column([0, 1], true), shape: [count, 2]},
        "vertex.depth": {data: column([2], true), shape: [count]},
        "vertex.width": {data: column([3], false).map(width => Math.max(width, 0)), shape: [count]},
        "vertex.color": {data: column([4, 5, 6], false), shape: [count, 3]},
        "vertex.source": {data: Int32Array.from(source), shape: [count, 3]},
        ...(elliptic ? {
            "vertex.covariance": {data: column([7, 8, 9], true), shape: [count, 3]},
            "vertex.amplitude": {data: column([10], true), shape: [count]},
            "vertex.distance": {data: column([11], true), shape: [count]},
        } : {}),
    };
}

/** Colour, and the nearest splats with their depth, of another target. */
function picture(target, near) {
    const {width, height} = target;
    const depth = {data: channels(near.read("depth"), [0]), shape: [height, width]};
    return {
        "raster.splat": {data: channels(near.read("splat"), [0]), shape: [height, width]},
        "raster.depth": depth,
        color: {data: channels(target.read("color"), [0, 1, 2]), shape: [height, width, 3]},
        depth,
    };
}
