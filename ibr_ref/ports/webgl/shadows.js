// Shadows by image warping in WebGL 2, by the shaders of the OpenGL port: see ../glsl/shadows.py for the passes of a frame.

import {channels} from "./gl.js";

/** All arrays of a frame, {data, shape} by name. Throws for what is not ported. */
export async function draw(device, {scene, params}) {
    if (!["warp", "direct", "grid", "pcss"].includes(params.method))
        throw new Error(`method = '${params.method}': the port allows warp, direct, grid, pcss`);
    if (params.accumulation === "float" && !device.gl.getExtension("EXT_float_blend"))
        throw new Error("WebGL 2 without EXT_float_blend");
    return new Drawing(device, scene, params).frame();
}

class Drawing {
    constructor(device, scene, params) {
        Object.assign(this, {device, scene, params, gl: device.gl});
        this.depths = params.content === "depth";
        this.size = params.map_size;
        this.flags = ["EXACT", ...(this.depths ? ["DEPTH"] : []), ...(params.pcf ? ["PCF"] : []),
            ...(params.quantize !== null ? ["QUANTIZE"] : []), ...(params.policy === "nearest" ? ["NEAREST"] : [])];
        this.stages = {};
        if (params.method === "warp") this.images = this.#uploaded();
        this.soft = params.method === "pcss" ? scene.soft : null;
        this.points = this.soft ? {search: this.#points(this.soft.search), spread: this.#points(this.soft.filter)} : {};
    }

    /** The nine maps as textures, the one for x_i, y_j at 3 j + i. */
    #uploaded() {
        const {maps} = this.scene;
        const texels = maps.texels.shape[2] * maps.texels.shape[3];
        const scale = maps.content === "mask" ? 1 / maps.samples ** 2 : 1;
        return Array.from({length: 9}, (_, n) => this.device.upload({
            shape: maps.texels.shape.slice(2),
            data: Float32Array.from(maps.texels.data.subarray(n * texels, (n + 1) * texels), x => x * scale),
        }, {filtered: false}));
    }

    /** Points of the light as a row of texels. */
    #points({shape, data}) {
        return this.device.upload({shape: [1, ...shape], data}, {filtered: false});
    }

    async frame() {
        const {device, gl, scene, params} = this;
        const {width, height} = scene.camera;
        const seen = await this.#surface();
        const accumulated = device.target(width, height, {sum: params.accumulation === "float" ? "R32F" : "R8"}, false);
        accumulated.begin();
        for (const sample of scene.light_samples) {
            const map = await this.#map(sample);
            this.#keep("warp.image", {data: channels(map.read("texel"), [0]), shape: [this.size, this.size]});
            const textures = {places: seen.get("place"), map: map.get("texel"), ...this.points};
            const alpha = 1 / scene.light_samples.length;
            const kinds = {result: "RGBA32F", ...(this.soft ? {softness: "RGBA32F"} : {})};
            const projected = device.target(width, height, kinds, false);
            await this.#project(projected, sample, textures, alpha, ["COORD"]);
            this.#keepProjected(projected);
            gl.enable(gl.BLEND);
            gl.blendFunc(gl.SRC_ALPHA, gl.ONE);
            await this.#project(accumulated, sample, textures, alpha, []);
            gl.disable(gl.BLEND);
        }
        const picture = device.target(width, height, {color: "RGBA32F"}, false);
        const textures = {places: seen.get("place"), surfaces: seen.get("surface"), shadows: accumulated.get("sum")};
        await this.#screen(picture, "resolve", [], textures, {ambient: [scene.ambient], background: scene.background});
        const sum = channels(accumulated.read("sum"), [0]).map(x => Math.min(x, 1));
        return {
            ...this.#joined(),
            "accumulate.shadow": {data: sum, shape: [height, width]},
            color: {data: channels(picture.read("color"), [0, 1, 2]), shape: [height, width, 3]},
            depth: {data: channels(seen.read("depth"), [0]), shape: [height, width]},
        };
    }

    #keepProjected(projected) {
        const {width, height} = projected;
        const [found, softness] = projected.attachments.map(({name}) => projected.read(name));
        this.#keep("project.coord", {data: channels(found, [0, 1, 2]), shape: [height, width, 3]});
        this.#keep("project.shadow", {data: channels(found, [3]), shape: [height, width]});
        if (!softness) return;
        for (const [channel, name] of ["blocker", "penumbra"].entries())
            this.#keep(`project.${name}`, {data: channels(softness, [channel]), shape: [height, width]});
    }

    /** Receivers and caster as the camera sees them: place, surface, depth. */
    async #surface() {
        const {device, gl, scene} = this;
        const {width, height} = scene.camera;
        const target = device.target(width, height, {place: "RGBA32F", surface: "RGBA32F", depth: "R32F"});
        target.begin({depth: [1, 0, 0, 0]});
        const program = await device.program("#define DEPTH_TOO\n", "shadows_surface.vert", "shadows_surface.frag");
        gl.useProgram(program);
        this.#camera(program, scene.camera, scene.offset);
        device.uniform(program, "eye", scene.camera.eye);
        device.uniform(program, "light", scene.light.position);
        const rows = vertices(scene);
        device.buffer(rows);
        device.attributes(40, [[0, 3, 0], [1, 3, 12], [2, 3, 24], [3, 1, 36]]);
        this.#depthTest(() => gl.drawArrays(gl.TRIANGLES, 0, rows.length / 10));
        disable(gl, 4);
        return target;
    }

    /** The map of a sample: warped, rendered, the one of the whole light, or between four of a grid. */
    async #map(sample) {
        const {device, scene, params} = this;
        if (params.method === "warp") return this.#warped(sample);
        if (params.method === "direct") return this.#rendered(sample.camera, scene.offset);
        if (this.soft) return this.#rendered(this.soft, scene.offset);
        const {offsets, fraction} = placeInGrid(scene, params.grid_size, sample.seen_offset);
        const maps = {};
        for (const [i, name] of ["m00", "m10", "m01", "m11"].entries())
            maps[name] = (await this.#rendered(scene.light.camera, offsets[i])).get("texel");
        const result = device.target(this.size, this.size, {texel: "R32F"}, false);
        await this.#screen(result, "mix", [], maps, {fraction}, {mixed: params.grid_mix ? 1 : 0});
        return result;
    }

    /** The map of the caster at an offset: masks of k x k samples a texel are rendered as large and counted. */
    async #rendered(camera, offset) {
        const {device, gl, scene, params} = this;
        const k = this.depths ? 1 : params.map_samples;
        const target = device.target(k * this.size, k * this.size, {texel: "R32F"});
        target.begin({texel: [this.depths ? 1 : 0, 0, 0, 0]});
        const defines = this.depths ? "#define DEPTH\n" : "";
        const program = await device.program(defines, "shadows_map.vert", "shadows_map.frag");
        gl.useProgram(program);
        this.#camera(program, camera, offset);
        device.buffer(Float32Array.from(scene.caster.vertices.data));
        device.attributes(12, [[0, 3, 0]]);
        const indices = Uint32Array.from(scene.caster.triangles.data);
        device.buffer(indices, gl.ELEMENT_ARRAY_BUFFER);
        const drawn = () => gl.drawElements(gl.TRIANGLES, indices.length, gl.UNSIGNED_INT, 0);
        if (this.depths) this.#depthTest(drawn);
        else drawn();
        disable(gl, 1);
        if (k === 1) return target;
        const counted = device.target(this.size, this.size, {texel: "R32F"}, false);
        await this.#screen(counted, "count", [], {mask: target.get("texel")}, {}, {samples: k});
        return counted;
    }

    /** The map of a sample from nine: the rows between two maps each, then the result between the rows. */
    async #warped(sample) {
        const {maps} = this.scene;
        const {cell, fraction} = placeInCell(maps.positions.data, sample.seen_offset);
        const shares = sharesInCell(maps.depths ? maps.depths.data : null, cell, fraction);
        const n = 3 * cell[1] + cell[0];
        const rows = [];
        for (const [first, share] of [[n, shares[0]], [n + 3, shares[1]]]) {
            const pair = [first, first + 1];
            rows.push(await this.#warp([], pair, pair.map(i => this.images[i]), [share, share, shares[2]], share));
        }
        const four = [n, n + 1, n + 3, n + 4];
        const result = await this.#warp(["COLUMN"], four, rows.map(row => row.get("texel")), shares, shares[2]);
        const grids = [
            await this.#grid([], [n, n + 1], [shares[0], shares[0], shares[2]]),
            await this.#grid([], [n + 3, n + 4], [shares[1], shares[1], shares[2]]),
        ];
        const shape = maps.controls.shape.slice(2);
        const images = rows.flatMap(row => [...channels(row.read("texel"), [0])]);
        this.#keep("warp.cell", {data: Int32Array.from(cell), shape: [2]});
        this.#keep("warp.fraction", {data: Float64Array.from(fraction), shape: [2]});
        this.#keep("warp.row_grids", {data: Float32Array.from(grids.flatMap(grid => [...grid])), shape: [2, ...shape]});
        this.#keep("warp.rows", {data: Float32Array.from(images), shape: [2, this.size, this.size]});
        this.#keep("warp.grid", {data: await this.#grid(["COLUMN"], four, shares), shape});
        if (maps.depths) this.#keep("warp.shares", {data: Float64Array.from(shares), shape: [3]});
        return result;
    }

    async #warp(flags, numbers, [first, second], shares, share) {
        const {device, gl, params} = this;
        const program = await device.program(this.#defines(flags), "shadows_warp.vert", "shadows_warp.frag");
        const target = device.target(this.size, this.size, {texel: "R32F"}, false);
        target.begin({texel: [this.depths ? 1 : 0, 0, 0, 0]});
        gl.useProgram(program);
        device.uniform(program, "shares", shares);
        device.uniform(program, "share", [share]);
        device.bind(program, params.policy === "nearest" ? {first: share < 0.5 ? first : second} : {first, second});
        this.#controls(numbers);
        const indices = meshIndices(...this.scene.maps.controls.shape.slice(2, 4));
        device.buffer(indices, gl.ELEMENT_ARRAY_BUFFER);
        gl.drawElements(gl.TRIANGLES, indices.length, gl.UNSIGNED_INT, 0);
        disable(gl, 4);
        return target;
    }

    /** A mesh as the vertex shader makes it. */
    async #grid(flags, numbers, shares) {
        const {device, gl} = this;
        const defines = ["CAPTURE", ...flags].map(name => `#define ${name}\n`).join("");
        const program = await device.program(defines, "shadows_warp.vert", null, ["place"]);
        gl.useProgram(program);
        device.uniform(program, "shares", shares);
        this.#controls(numbers);
        const [, , rows, columns] = this.scene.maps.controls.shape;
        const points = device.captured(program, rows * columns, 2);
        disable(gl, 4);
        return points;
    }

    /** The points of two or four control meshes as attributes. */
    #controls(numbers) {
        const {data, shape: [, , rows, columns]} = this.scene.maps.controls;
        const count = rows * columns;
        const packed = new Float32Array(2 * count * numbers.length);
        numbers.forEach((n, k) => {
            for (let i = 0; i < count; i++)
                packed.set(data.subarray(2 * (n * count + i), 2 * (n * count + i) + 2), 2 * (i * numbers.length + k));
        });
        this.device.buffer(packed);
        this.device.attributes(8 * numbers.length, numbers.map((_, k) => [k, 2, 8 * k]));
    }

    async #project(target, sample, textures, alpha, flags) {
        const {params, soft} = this;
        const {clip_from_view, view_from_world} = soft ?? sample.camera;
        const planes = soft ? {planes: [soft.near, soft.far, soft.nearest]} : {};
        const numbers = {bias: [params.bias], alpha: [alpha], ...planes};
        const file = soft ? "soft" : "project";
        await this.#screen(target, file, [...this.flags, ...flags], textures, numbers, {}, {clip_from_view, view_from_world});
    }

    /** One triangle over all of a target. */
    async #screen(target, fragment, flags, textures, numbers, integers = {}, matrices = {}) {
        const {device, gl} = this;
        const defines = flags.map(name => `#define ${name}\n`).join("");
        const program = await device.program(defines, "shadows_screen.vert", `shadows_${fragment}.frag`);
        gl.useProgram(program);
        for (const [name, value] of Object.entries(matrices)) device.uniform(program, name, value, "matrix");
        for (const [name, value] of Object.entries(numbers)) device.uniform(program, name, value);
        for (const [name, value] of Object.entries(integers)) device.uniform(program, name, value, "int");
        device.bind(program, textures);
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
        gl.viewport(0, 0, target.width, target.height);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    #camera(program, camera, offset) {
        const {device, scene} = this;
        device.uniform(program, "clip_from_view", camera.clip_from_view, "matrix");
        device.uniform(program, "view_from_world", camera.view_from_world, "matrix");
        const [a, b] = scene.offset_axes;
        device.uniform(program, "offset", [0, 1, 2].map(k => offset[0] * a[k] + offset[1] * b[k]));
    }

    #defines(flags) {
        return [...this.flags, ...flags].map(name => `#define ${name}\n`).join("");
    }

    #depthTest(drawn) {
        const {gl} = this;
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LESS);
        drawn();
        gl.disable(gl.DEPTH_TEST);
    }

    #keep(name, array) {
        (this.stages[name] ??= []).push(array);
    }

    /** One array a sample, behind one another where there are several. */
    #joined() {
        return Object.fromEntries(Object.entries(this.stages).map(([name, arrays]) => {
            if (arrays.length === 1) return [name, arrays[0]];
            const {data, shape} = arrays[0];
            const all = new data.constructor(data.length * arrays.length);
            arrays.forEach((each, i) => all.set(each.data, i * data.length));
            return [name, {data: all, shape: [arrays.length, ...shape]}];
        }));
    }
}

function disable(gl, count) {
    for (let location = 0; location < count; location++) gl.disableVertexAttribArray(location);
}

/** Position, flat normal, colour, 1 on the caster: ten floats a corner; receivers in order, then the caster. */
function vertices(scene) {
    const rows = [];
    const at = (array, i) => [0, 1, 2].map(k => array.data[3 * i + k]);
    for (const mesh of [...scene.receivers, scene.caster]) {
        const {vertices: places, triangles, color} = mesh;
        const painted = i => Array.isArray(color) ? color : color.shape.length === 2 ? at(color, i) : [...color.data];
        for (let t = 0; t < triangles.shape[0]; t++) {
            const corners = at(triangles, t);
            const [a, b, c] = corners.map(i => at(places, i));
            const [u, v] = [b, c].map(p => p.map((x, k) => x - a[k]));
            const cross = [0, 1, 2].map(k => u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
            const length = Math.max(Math.hypot(...cross), Number.MIN_VALUE);
            const normal = cross.map(x => x / length);
            for (const i of corners) rows.push(...at(places, i), ...normal, ...painted(i), mesh === scene.caster ? 1 : 0);
        }
    }
    return Float32Array.from(rows);
}

/** The cell of the 3 x 3 maps that holds an offset, and its fractions in it, x first; positions (3, 3, 2). */
function placeInCell(positions, offset) {
    const lines = [[0, 1, 2].map(i => positions[2 * i]), [0, 1, 2].map(j => positions[6 * j + 1])];
    const cell = lines.map((line, k) => offset[k] >= line[1] ? 1 : 0);
    const fraction = lines.map((line, k) => (offset[k] - line[cell[k]]) / (line[cell[k] + 1] - line[cell[k]]));
    return {cell, fraction};
}

/** Of n x n maps the four around an offset: the object's offsets in them (00, 10, 01, 11), and the fractions s and t. */
function placeInGrid(scene, n, offset) {
    const lines = [0, 1].map(k => {
        const widening = Math.max(...scene.light_samples.map(sample => Math.abs(sample.displacement[k])));
        const [low, high] = [scene.offset_range[k][0] - widening, scene.offset_range[k][1] + widening];
        const place = (offset[k] - low) / (high - low) * (n - 1);
        const cell = Math.min(Math.max(Math.floor(place), 0), n - 2);
        const at = i => low * (1 - i / (n - 1)) + high * i / (n - 1);
        return {ends: [at(cell), at(cell + 1)], fraction: place - cell};
    });
    const offsets = [[0, 0], [1, 0], [0, 1], [1, 1]].map(([i, j]) => [lines[0].ends[i], lines[1].ends[j]]);
    return {offsets, fraction: lines.map(line => line.fraction)};
}

/** The shares of the next map in the upper row and in the lower one, and of the lower row; depths (3, 3) or null: s, s, t. */
function sharesInCell(depths, [i, j], [s, t]) {
    if (depths === null) return [s, s, t];
    const share = (f, w0, w1) => f * w1 / ((1 - f) * w0 + f * w1);
    const w = (row, column) => depths[3 * (j + row) + i + column];
    const between = row => (1 - s) * w(row, 0) + s * w(row, 1);
    return [share(s, w(0, 0), w(0, 1)), share(s, w(1, 0), w(1, 1)), share(t, between(0), between(1))];
}

/** Cells row by row, each (r, c), (r, c+1), (r+1, c+1) and (r, c), (r+1, c+1), (r+1, c). */
function meshIndices(rows, columns) {
    const found = [];
    for (let r = 0; r < rows - 1; r++)
        for (let c = 0; c < columns - 1; c++)
            found.push(...[0, 1, columns + 1, 0, columns + 1, columns].map(k => r * columns + c + k));
    return Uint32Array.from(found);
}
