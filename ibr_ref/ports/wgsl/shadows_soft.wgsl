// Percentage-closer soft shadows: one map parallel to the light is asked for blockers, and then as wide as the penumbra.
// After shadows.wgsl; first are the places, second is the map.

@group(0) @binding(6) var search: texture_2d<f32>;      // points of the light, as displacements on the map at distance 1
@group(0) @binding(7) var spread: texture_2d<f32>;      // those of the filter

struct Softened {
    coord: vec3f,
    shadow: f32,
    blocker: f32,
    penumbra: f32,
}

fn distance_of(depth: f32) -> f32 {
    return p.planes.x * p.planes.y / (p.planes.y - depth * (p.planes.y - p.planes.x));
}

fn nearer(depth: f32, here: f32) -> bool {
    return depth < 1.0 && distance_of(depth) < here;
}

fn asked(at: vec2i, here: f32) -> f32 {
    return select(0.0, 1.0, nearer(texel(second, at), here));
}

fn on_map(st: vec2f) -> bool {
    return all(st >= vec2f(0.0)) && all(st <= vec2f(1.0));
}

/// The mean distance of what blocks, 0 without any.
fn blocker(st: vec2f, scale: f32, here: f32) -> f32 {
    var total = 0.0;
    var count = 0.0;
    for (var i = 0u; i < textureDimensions(search).x; i++) {
        let at = st + textureLoad(search, vec2u(i, 0u), 0).xy * scale;
        let depth = texel(second, vec2i(floor(at * vec2f(textureDimensions(second)))));
        if (on_map(at) && nearer(depth, here)) {
            total += distance_of(depth);
            count += 1.0;
        }
    }
    if (count == 0.0) { return 0.0; }
    return total / count;
}

/// The mean of the comparisons, each the mix of four.
fn percentage(st: vec2f, scale: f32, here: f32) -> f32 {
    var total = 0.0;
    let count = textureDimensions(spread).x;
    for (var i = 0u; i < count; i++) {
        let place = st + textureLoad(spread, vec2u(i, 0u), 0).xy * scale;
        let at = place * vec2f(textureDimensions(second)) - 0.5;
        let corner = floor(at);
        let f = at - corner;
        let low = vec2i(corner);
        let top = mix(asked(low, here), asked(low + vec2i(1, 0), here), f.x);
        let bottom = mix(asked(low + vec2i(0, 1), here), asked(low + vec2i(1, 1), here), f.x);
        if (on_map(place)) { total += mix(top, bottom, f.y); }
    }
    return total / f32(count);
}

/// All that is said of a pixel; nothing where nothing is seen.
fn softened(pixel: vec2i) -> Softened {
    var result: Softened;
    let place = bitcast<vec4f>(textureLoad(first, pixel, 0));
    if (place.w < 0.5) { return result; }
    let q = to_clip(place.xyz);
    result.coord = vec3f(vec2f(0.5 * q.x + 0.5 * q.w, 0.5 * q.w - 0.5 * q.y) / q.w, q.w);
    let st = result.coord.xy;
    if (place.w > 1.5 || q.w <= p.planes.z || !on_map(st)) { return result; }
    let here = q.w - p.offset.w;
    result.blocker = blocker(st, 1.0 / p.planes.z - 1.0 / q.w, here);
    if (result.blocker == 0.0) { return result; }
    result.penumbra = 1.0 / result.blocker - 1.0 / q.w;
    result.shadow = percentage(st, result.penumbra, here);
    return result;
}

struct Stages {
    @location(0) projected: vec4u,      // coordinates and shadow
    @location(1) softness: vec4u,       // blocker, penumbra
}

@fragment
fn softly_projected(@builtin(position) at: vec4f) -> Stages {
    let found = softened(vec2i(at.xy));
    let softness = vec4f(found.blocker, found.penumbra, 0.0, 0.0);
    return Stages(bitcast<vec4u>(vec4f(found.coord, found.shadow)), bitcast<vec4u>(softness));
}

/// Into bytes: blended with (source alpha, one).
@fragment
fn softly_blended(@builtin(position) at: vec4f) -> @location(0) vec4f {
    return vec4f(softened(vec2i(at.xy)).shadow, 0.0, 0.0, p.light.w);
}
