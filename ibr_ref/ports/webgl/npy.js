// NumPy's .npy files, versions 1 to 3, little-endian, C order: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html

const KINDS = {
    "|b1": Uint8Array, "|u1": Uint8Array, "|i1": Int8Array, "<u2": Uint16Array, "<i2": Int16Array, "<u4": Uint32Array,
    "<i4": Int32Array, "<f4": Float32Array, "<f8": Float64Array, "<i8": BigInt64Array,
};

/** {shape, data} of a file's bytes (ArrayBuffer): numbers in a typed array; 64-bit integers as Float64Array. */
export function decode(buffer) {
    const bytes = new Uint8Array(buffer);
    const view = new DataView(buffer);
    if (String.fromCharCode(...bytes.subarray(0, 6)) !== "\x93NUMPY") throw new Error("is no .npy file");
    const long = bytes[6] >= 2;
    const start = long ? 12 : 10;
    const length = long ? view.getUint32(8, true) : view.getUint16(8, true);
    const header = new TextDecoder().decode(bytes.subarray(start, start + length));
    const kind = /'descr':\s*'([^']*)'/.exec(header)?.[1];
    const shape = /'shape':\s*\(([^)]*)\)/.exec(header)?.[1].split(",").filter(x => x.trim()).map(Number);
    if (!KINDS[kind] || !shape || /'fortran_order':\s*True/.test(header)) throw new Error(`not read: ${header}`);
    const count = shape.reduce((a, b) => a * b, 1);
    const body = buffer.slice(start + length);                  // aligned for any type
    const data = new KINDS[kind](body, 0, count);
    return {shape, data: kind === "<i8" ? Float64Array.from(data, Number) : data};
}

/** The bytes of a file: data is an Int32Array, Float32Array, Float64Array, or a Uint8Array of truths. */
export function encode(data, shape) {
    const kinds = {Int32Array: "<i4", Float32Array: "<f4", Float64Array: "<f8", Uint8Array: "|b1"};
    const tuple = shape.length === 1 ? `(${shape[0]},)` : `(${shape.join(", ")})`;
    let header = `{'descr': '${kinds[data.constructor.name]}', 'fortran_order': False, 'shape': ${tuple}, }`;
    header += " ".repeat(63 - (10 + header.length) % 64) + "\n";
    const bytes = new Uint8Array(10 + header.length + data.byteLength);
    bytes.set([0x93, ...[..."NUMPY"].map(c => c.charCodeAt(0)), 1, 0, header.length & 255, header.length >> 8]);
    bytes.set(new TextEncoder().encode(header), 10);
    bytes.set(new Uint8Array(data.buffer, data.byteOffset, data.byteLength), 10 + header.length);
    return bytes;
}
