// A WebGL 2 context for drawing into 32-bit floats, and the few calls that the ports need.

export class Device {
    constructor() {
        const canvas = document.createElement("canvas");
        this.gl = canvas.getContext("webgl2", {antialias: false, depth: false});
        if (!this.gl) throw new Error("no WebGL 2");
        for (const name of ["EXT_color_buffer_float", "OES_texture_float_linear"])
            if (!this.gl.getExtension(name)) throw new Error(`WebGL 2 without ${name}`);
        this.programs = new Map();
        this.volumes = new Set();
    }

    /** Vendor and renderer. */
    get words() {
        const info = this.gl.getExtension("WEBGL_debug_renderer_info");
        return this.gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : this.gl.RENDERER);
    }

    /** The linked program of two files, "FILE, NAME in FILE" where one includes another, with #defines; varyings: what transform feedback hands back, nothing is drawn. */
    async program(defines, vertex, fragment, varyings = []) {
        const key = [defines, vertex, fragment, ...varyings].join("|");
        if (!this.programs.has(key)) this.programs.set(key, await this.#linked(defines, vertex, fragment, varyings));
        return this.programs.get(key);
    }

    async #linked(defines, vertex, fragment, varyings) {
        const {gl} = this;
        const program = gl.createProgram();
        for (const [type, file] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
            const text = file === null ? "void main() {}" : await source(file);
            const shader = gl.createShader(type);
            gl.shaderSource(shader, HEAD + defines + embedded(text, type === gl.VERTEX_SHADER));
            gl.compileShader(shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`${file}: ${gl.getShaderInfoLog(shader)}`);
            gl.attachShader(program, shader);
        }
        if (varyings.length) gl.transformFeedbackVaryings(program, varyings, gl.INTERLEAVED_ATTRIBS);
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
        return program;
    }

    /** Set a uniform where the program has it: a matrix by rows (4 x 4), numbers, or [sampler's unit]. */
    uniform(program, name, value, kind) {
        const {gl} = this;
        const at = gl.getUniformLocation(program, name);
        if (at === null) return;
        if (kind === "matrix") gl.uniformMatrix4fv(at, false, columns(value));
        else if (kind === "int") gl.uniform1i(at, value);
        else gl[`uniform${value.length}fv`](at, value);
    }

    /** Bind textures to units 0, 1, ... and tell the program's samplers. */
    bind(program, textures) {
        const {gl} = this;
        Object.entries(textures).forEach(([name, texture], unit) => {
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(this.volumes.has(texture) ? gl.TEXTURE_3D : gl.TEXTURE_2D, texture);
            this.uniform(program, name, unit, "int");
        });
    }

    /** A texture of {shape: [rows, columns(, channels)], data}; floats; two and three channels are padded to four. */
    upload({shape, data}, {filtered = true, repeat = false} = {}) {
        const {gl} = this;
        const [height, width, channels = 1] = shape;
        const texture = this.texture(width, height, channels === 1 ? "R32F" : "RGBA32F", {filtered, repeat});
        const padded = channels === 2 || channels === 3;
        const texels = padded ? new Float32Array(4 * width * height) : Float32Array.from(data);
        for (let i = 0; padded && i < width * height; i++)
            texels.set(data.subarray(channels * i, channels * (i + 1)), 4 * i);
        const format = channels === 1 ? gl.RED : gl.RGBA;
        gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, format, gl.FLOAT, texels);
        return texture;
    }

    /** A filtered texture of three dimensions, {shape: [layers, rows, columns], data}; clamped between the layers. */
    uploadVolume({shape, data}, {repeat = false} = {}) {
        const {gl} = this;
        const [depth, height, width] = shape;
        const texture = gl.createTexture();
        this.volumes.add(texture);
        gl.bindTexture(gl.TEXTURE_3D, texture);
        gl.texStorage3D(gl.TEXTURE_3D, 1, gl.R32F, width, height, depth);
        const wrap = repeat ? gl.REPEAT : gl.CLAMP_TO_EDGE;
        const kinds = {MIN_FILTER: gl.LINEAR, MAG_FILTER: gl.LINEAR, WRAP_S: wrap, WRAP_T: wrap, WRAP_R: gl.CLAMP_TO_EDGE};
        for (const [name, kind] of Object.entries(kinds)) gl.texParameteri(gl.TEXTURE_3D, gl["TEXTURE_" + name], kind);
        gl.texSubImage3D(gl.TEXTURE_3D, 0, 0, 0, 0, width, height, depth, gl.RED, gl.FLOAT, Float32Array.from(data));
        return texture;
    }

    /** An empty texture, bound. */
    texture(width, height, kind, {filtered = false, repeat = false} = {}) {
        const {gl} = this;
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl[kind], width, height);
        const [filter, wrap] = [filtered ? gl.LINEAR : gl.NEAREST, repeat ? gl.REPEAT : gl.CLAMP_TO_EDGE];
        for (const name of ["MIN_FILTER", "MAG_FILTER"]) gl.texParameteri(gl.TEXTURE_2D, gl["TEXTURE_" + name], filter);
        for (const name of ["WRAP_S", "WRAP_T"]) gl.texParameteri(gl.TEXTURE_2D, gl["TEXTURE_" + name], wrap);
        return texture;
    }

    /** A frame buffer: attachments {name: kind} in the order of the shader's locations, and a 32-bit float depth buffer. */
    target(width, height, attachments, depth = true) {
        return new Target(this.gl, width, height, Object.entries(attachments).map(
            ([name, kind]) => ({name, kind, texture: this.texture(width, height, kind)})), depth);
    }

    /** A buffer with that in it. */
    buffer(data, kind = this.gl.ARRAY_BUFFER) {
        const buffer = this.gl.createBuffer();
        this.gl.bindBuffer(kind, buffer);
        this.gl.bufferData(kind, data, this.gl.STATIC_DRAW);
        return buffer;
    }

    /** Numbers (count times width) that the program's varyings are for count points; the arrays are bound already. */
    captured(program, count, width) {
        const {gl} = this;
        if (!count) return new Float32Array(0);
        const result = gl.createBuffer();
        gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, result);
        gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, 4 * count * width, gl.STREAM_READ);
        gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, result);
        gl.enable(gl.RASTERIZER_DISCARD);
        gl.beginTransformFeedback(gl.POINTS);
        gl.drawArrays(gl.POINTS, 0, count);
        gl.endTransformFeedback();
        gl.disable(gl.RASTERIZER_DISCARD);
        const numbers = new Float32Array(count * width);
        gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, numbers);
        gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
        return numbers;
    }

    /** Attributes of interleaved 32-bit numbers: [location, count, offset, integer?] each. */
    attributes(stride, each) {
        const {gl} = this;
        for (const [location, count, offset, integer] of each) {
            gl.enableVertexAttribArray(location);
            if (integer) gl.vertexAttribIPointer(location, count, integer === "u" ? gl.UNSIGNED_INT : gl.INT, stride, offset);
            else gl.vertexAttribPointer(location, count, gl.FLOAT, false, stride, offset);
        }
    }

    /** A uniform block of std140: matrices (by rows) and vectors, then four integers. */
    block(program, name, matrices, vectors, integers) {
        const {gl} = this;
        const floats = new Float32Array(16 * matrices.length + 4 * vectors.length + 4);
        matrices.forEach((matrix, i) => floats.set(columns(matrix), 16 * i));
        vectors.forEach((vector, i) => floats.set(vector, 16 * matrices.length + 4 * i));
        new Int32Array(floats.buffer, floats.byteLength - 16).set(integers);
        gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, this.buffer(floats, gl.UNIFORM_BUFFER));
        gl.uniformBlockBinding(program, gl.getUniformBlockIndex(program, name), 0);
    }
}

/** The text of a file, with those of "NAME in FILE" in the place of its `#include NAME`. */
async function source(words) {
    const [file, ...parts] = words.split(", ");
    let text = await (await fetch("glsl/" + file)).text();
    for (const part of parts) {
        const [name, inside] = part.split(" in ");
        text = text.replace("#include " + name, await (await fetch("glsl/" + inside)).text());
    }
    return text;
}

const HEAD = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp sampler3D;\nprecision highp usampler2D;\n";

/** GLSL 4.50 as these ports have it in GLSL ES 3.00: no bindings, no locations between the stages, no noperspective (w is 1). */
function embedded(source, vertex) {
    const between = vertex ? /layout\(location = \d+\) (?=(flat )?out )/g : /layout\(location = \d+\) (?=(flat )?in )/g;
    return source
        .replace(between, "")
        .replace(/layout\(std140, binding = \d+\)/g, "layout(std140)")
        .replace(/layout\(binding = \d+\) /g, "")
        .replace(/noperspective /g, "");
}

/** Column by column. */
function columns(matrix) {
    return [0, 1, 2, 3].flatMap(c => matrix.map(row => row[c]));
}

class Target {
    constructor(gl, width, height, attachments, depth) {
        Object.assign(this, {gl, width, height, attachments});
        this.frame = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
        attachments.forEach(({texture}, i) =>
            gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0));
        gl.drawBuffers(attachments.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
        if (depth) {
            gl.bindRenderbuffer(gl.RENDERBUFFER, gl.createRenderbuffer());
            gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, width, height);
            gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER,
                gl.getParameter(gl.RENDERBUFFER_BINDING));
        }
        const state = gl.checkFramebufferStatus(gl.FRAMEBUFFER);
        if (state !== gl.FRAMEBUFFER_COMPLETE) throw new Error(`frame buffer: ${state}`);
    }

    /** Bind, and clear every attachment to its own value (0), depth to 1. */
    begin(clears = {}) {
        const {gl} = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
        gl.viewport(0, 0, this.width, this.height);
        this.attachments.forEach(({name, kind}, i) => {
            const value = clears[name] ?? [0, 0, 0, 0];
            if (kind.endsWith("I")) gl.clearBufferiv(gl.COLOR, i, new Int32Array(value));
            else gl.clearBufferfv(gl.COLOR, i, new Float32Array(value));
        });
        gl.clearBufferfv(gl.DEPTH, 0, new Float32Array([1]));
    }

    get(name) {
        return this.attachments.find(each => each.name === name).texture;
    }

    /** (rows, columns, 4) of one attachment; row 0 is the first in memory: the top, as the ports negate clip y. */
    read(name) {
        const {gl, width, height} = this;
        const index = this.attachments.findIndex(each => each.name === name);
        const integers = this.attachments[index].kind.endsWith("I");
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
        gl.readBuffer(gl.COLOR_ATTACHMENT0 + index);
        const data = integers ? new Int32Array(4 * width * height) : new Float32Array(4 * width * height);
        const bytes = this.attachments[index].kind.endsWith("8");
        if (bytes) {
            const found = new Uint8Array(4 * width * height);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, found);
            return Float32Array.from(found, k => k / 255);
        }
        gl.readPixels(0, 0, width, height, integers ? gl.RGBA_INTEGER : gl.RGBA, integers ? gl.INT : gl.FLOAT, data);
        return data;
    }
}

/** Some channels of (n, 4); nothing: what stands where kept (n) is false. */
export function channels(data, which, kept = null, nothing = NaN) {
    const result = new data.constructor(data.length / 4 * which.length);
    for (let i = 0; i < data.length / 4; i++)
        which.forEach((c, k) => { result[i * which.length + k] = kept && !kept[i] ? nothing : data[4 * i + c]; });
    return result;
}
