// Protruded displacement mapping in WebGL 2, and the searches below the polygon, by the shaders of the OpenGL port.

import {channels} from "./gl.js";

const FACES = [
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]],
    [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]], [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
    [[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]], [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
];
const ATTACHMENTS = {color: "RGBA32F", index: "RGBA32I", patch: "RGBA32F", hit: "RGBA32F", albedo: "RGBA32F", normal: "RGBA32F"};
const BELOW = ["relief", "welsh", "mcguire", "tatarchuk", "cone", "relaxed_cone", "donnelly", "maximum_mipmap"];
const UNUSED = {shape: [1, 1, 3], data: new Float64Array(3)};

/** All arrays of a frame, {data, shape} by name. Throws for what is not ported. */
export async function draw(device, {scene, params}) {
    const below = BELOW.includes(params.method);
    if (!below && params.method !== "protruded")
        throw new Error(`method = '${params.method}': the port allows protruded, ${BELOW.join(", ")}`);
    const {gl} = device;
    const {width, height} = scene.camera;
    const nothing = [NaN, NaN, NaN, 0];
    const target = device.target(width, height, ATTACHMENTS);
    target.begin({color: [...scene.background, 0], index: [-1, -1, -1, -1], patch: [NaN, NaN, NaN, 1],
        hit: nothing, albedo: nothing, normal: nothing});
    const clips = [], points = [];
    for (const [number, polygon] of scene.polygons.entries()) {
        const faces = facesOf(polygon.patch_space.eye, below ? {...params, faces: "base"} : params);
        if (!faces.length) continue;
        const defines = definesOf(scene, params, polygon);
        const captured = await corners(device, scene, polygon, number, faces);
        for (let i = 0; i < captured.length; i += 7) {
            clips.push(...captured.subarray(i, i + 4));
            points.push(...captured.subarray(i + 4, i + 7));
        }
        const search = `displacement_${below ? "below" : "protruded"}.frag`;
        const program = await device.program(defines, "displacement.vert", `displacement.frag, SEARCH in ${search}`);
        gl.useProgram(program);
        uniforms(device, program, scene, polygon, number);
        const repeat = polygon.domain === "repeat";
        const maps = {height_map: polygon.height_map, color_map: polygon.color_map, normal_map: polygon.normal_map ?? UNUSED};
        const textures = Object.entries(maps).map(([name, map]) => [name, device.upload(map, {repeat})]);
        textures.push(["facade_map", device.upload(polygon.facade_map ?? UNUSED, {repeat: true})]);
        if (polygon.cone_map) textures.push(["cone_map", device.upload(polygon.cone_map, {repeat})]);
        if (polygon.distance_map) textures.push(["distance_map", device.uploadVolume(polygon.distance_map, {repeat})]);
        if (polygon.quadtree) textures.push(["quadtree", device.upload(belowOneAnother(polygon.quadtree), {filtered: false})]);
        device.bind(program, Object.fromEntries(textures));
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LESS);
        bindFaces(device, faces);
        const quads = faces.flatMap((_, i) => [0, 1, 2, 0, 2, 3].map(k => 4 * i + k));
        device.buffer(new Uint32Array(quads), gl.ELEMENT_ARRAY_BUFFER);
        gl.drawElements(gl.TRIANGLES, quads.length, gl.UNSIGNED_INT, 0);
    }
    return arrays(target, clips, points);
}

/** Levels of a quadtree in one picture, as wide as the first. */
function belowOneAnother(levels) {
    const width = levels[0].shape[1], height = levels.reduce((sum, {shape}) => sum + shape[0], 0);
    const data = new Float64Array(width * height);
    let row = 0;
    for (const level of levels)
        for (let i = 0; i < level.shape[0]; i++, row++)
            data.set(level.data.subarray(i * level.shape[1], (i + 1) * level.shape[1]), row * width);
    return {shape: [height, width], data};
}

/** Numbers and corners of the faces that turn away from the eye. */
function facesOf([u, v, h, w], params) {
    const turned = [h > 0, u > 0, u < w, v > 0, v < w, params.interval === "volume" && h < w];
    if (params.faces === "extended") return [{number: 0, corners: extended([u, v, h], w)}];
    const numbers = turned.flatMap((away, number) => away ? [number] : []);
    const drawn = params.faces === "auxiliary" ? numbers : numbers.filter(number => number === 0);
    return drawn.map(number => ({number, corners: FACES[number]}));
}

/** The rectangle of the base's plane that covers all of the volume, as the eye sees it. */
function extended(eye, w) {
    const shadows = FACES[5].map(corner => {
        const way = corner.map((c, k) => eye[k] - w * c);
        return [0, 1].map(k => corner[k] - way[k] / way[2]);
    });
    const [u0, v0] = [0, 1].map(k => Math.min(0, ...shadows.map(s => s[k])));
    const [u1, v1] = [0, 1].map(k => Math.max(1, ...shadows.map(s => s[k])));
    return [[u0, v0, 0], [u1, v0, 0], [u1, v1, 0], [u0, v1, 0]];
}

function definesOf(scene, params, polygon) {
    const float = x => `float(${x})`;
    const below = BELOW.includes(params.method);
    const values = {
        LINEAR_STEPS: params.linear_steps, BINARY_STEPS: params.binary_steps, SHADOW_STEPS: params.shadow_steps,
        SHADOW_BIAS: float(params.shadow_bias), STEEP_THRESHOLD: float(params.steep_threshold), EXPONENT: scene.light.exponent,
        STAGES: 1, MIN_STEPS: params.min_steps, MAX_STEPS: params.max_steps,
        FLOOR: below && params.method !== "welsh" ? "-1.0" : "0.0",
    };
    const flags = {
        HAS_NORMAL_MAP: polygon.normal_map, HAS_FACADE_MAP: polygon.facade_map && !below, HAS_SPECULAR: scene.light.specular !== 0,
        POLYGON_DEPTH: params.depth === "polygon" || params.method === "welsh", REPEAT: polygon.domain === "repeat", VOLUME: params.interval === "volume",
        [params.method.toUpperCase()]: below,
    };
    for (const [name, present] of Object.entries(flags)) if (present) values[name] = 1;
    return Object.entries(values).map(([name, value]) => `#define ${name} ${value}\n`).join("");
}

/** Clip (4) and patch coordinates (3) of all corners, as the vertex shader makes them. */
async function corners(device, scene, polygon, number, faces) {
    const varyings = ["clip", "patch_position"];
    const program = await device.program("#define CAPTURE 1\n#define ZERO_TO_ONE 1\n", "displacement.vert", null, varyings);
    device.gl.useProgram(program);
    uniforms(device, program, scene, polygon, number);
    bindFaces(device, faces);
    return device.captured(program, 4 * faces.length, 7);
}

function bindFaces(device, faces) {
    const rows = new Float32Array(16 * faces.length);
    const numbers = new Int32Array(rows.buffer);
    faces.forEach((face, i) => face.corners.forEach((corner, k) => {
        rows.set(corner, 16 * i + 4 * k);
        numbers[16 * i + 4 * k + 3] = face.number;
    }));
    device.buffer(rows);
    device.attributes(16, [[0, 3, 0], [1, 1, 12, "i"]]);
}

function uniforms(device, program, scene, polygon, number) {
    const {camera, light} = scene;
    const {eye, light: lightPatch, axes, rows, frame} = polygon.patch_space;
    const worldFromPatch = [0, 1, 2].map(i => [axes[0][i], axes[1][i], axes[2][i], polygon.corner[i]]).concat([[0, 0, 0, 1]]);
    const length = a => Math.hypot(...a);
    const [u, v] = [polygon.edge_u, polygon.edge_v];
    const clipFromPatch = product(camera.clip_from_world, worldFromPatch);
    device.block(program, "Polygon", [camera.clip_from_view, camera.view_from_world, clipFromPatch], [
        polygon.corner, u, v, axes[2], rows[0], rows[1], frame[2], eye, lightPatch, camera.eye, light.homogeneous,
        [light.ambient, light.diffuse, light.specular], scene.background, [length(u), length(v), ...polygon.facade_tile],
        [polygon.height_scale],
    ], [number, 0, 0, 0]);
}

function product(a, b) {
    return a.map(row => [0, 1, 2, 3].map(j => row.reduce((sum, x, k) => sum + x * b[k][j], 0)));
}

/** The attachments under the specification's names, with its values of "nothing here". */
function arrays(target, clips, points) {
    const {width, height} = target;
    const [index, patch, hit, albedo, normal] = ["index", "patch", "hit", "albedo", "normal"].map(n => target.read(n));
    const covered = channels(index, [0]).map(x => x >= 0), kept = channels(index, [3]).map(x => x >= 0);
    const picture = (data, ...more) => ({data, shape: [height, width, ...more]});
    const truth = data => picture(Uint8Array.from(channels(data, [3]), (x, i) => kept[i] && x > 0.5 ? 1 : 0));
    return {
        "vertex.clip": {data: Float32Array.from(clips), shape: [clips.length / 4, 4]},
        "vertex.patch": {data: Float32Array.from(points), shape: [points.length / 3, 3]},
        "raster.face": picture(channels(index, [0])),
        "raster.patch_id": picture(channels(index, [1])),
        "raster.patch": picture(channels(patch, [0, 1, 2], covered), 3),
        "march.linear_index": picture(channels(index, [2])),
        "march.hit_index": picture(channels(index, [3])),
        "march.hit": picture(channels(hit, [0, 1, 2], kept), 3),
        "march.height_before": picture(channels(hit, [3], covered)),
        "march.steep": truth(normal),
        "shade.albedo": picture(channels(albedo, [0, 1, 2], kept), 3),
        "shade.normal": picture(channels(normal, [0, 1, 2], kept), 3),
        "shade.lit": truth(albedo),
        color: picture(channels(target.read("color"), [0, 1, 2]), 3),
        depth: picture(channels(patch, [3], kept, 1)),
    };
}
