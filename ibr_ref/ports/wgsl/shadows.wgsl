// Shadows by image warping: every pass of a frame. Constants are put in front by shadows.py: DEPTH, PCF, QUANTIZE, NEAREST.
// What a pass hands on are the bits of 32-bit floats.

struct Pass {
    clip_from_view: mat4x4f,
    view_from_world: mat4x4f,
    offset: vec4f,          // of the caster; the bias
    eye: vec4f,             // w = 0: the direction towards it
    light: vec4f,           // the centre; 1/N
    shares: vec4f,          // of the next map in the row, or in the upper and the lower row, of the lower row; this pass' own
    background: vec4f,      // and the ambient share
    planes: vec4f,          // of method "pcss": near and far of the map, the caster's nearest distance
    samples: vec4i,         // k, of k x k samples a texel
}

@group(0) @binding(0) var<uniform> p: Pass;
@group(0) @binding(1) var first: texture_2d<u32>;
@group(0) @binding(2) var second: texture_2d<u32>;
@group(0) @binding(3) var third: texture_2d<f32>;

fn to_clip(world: vec3f) -> vec4f {
    return p.clip_from_view * (p.view_from_world * vec4f(world, 1.0));
}

@vertex
fn screen(@builtin(vertex_index) number: u32) -> @builtin(position) vec4f {
    return vec4f(select(-1.0, 3.0, number == 1u), select(-1.0, 3.0, number == 2u), 0.0, 1.0);
}

// --- Receivers and caster as the camera sees them ------------------------------------------------------------------------

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) color: vec3f,
    @location(2) @interpolate(flat) normal: vec3f,
    @location(3) @interpolate(flat) caster: f32,
}

@vertex
fn seen(@location(0) at: vec3f, @location(1) normal: vec3f, @location(2) color: vec3f, @location(3) caster: f32) -> Seen {
    let world = at + caster * p.offset.xyz;
    return Seen(to_clip(world), world, color, normal, caster);
}

struct Surface {
    @location(0) place: vec4u,      // world position, 1 on receivers, 2 on the caster
    @location(1) surface: vec4u,    // colour, max(0, n . l)
}

@fragment
fn surface(s: Seen) -> Surface {
    let to_light = normalize(p.light.xyz - s.world);
    let side = select(1.0, -1.0, dot(s.normal, p.eye.xyz - p.eye.w * s.world) < 0.0);
    let lit = max(0.0, side * dot(s.normal, to_light));
    return Surface(bitcast<vec4u>(vec4f(s.world, 1.0 + s.caster)), bitcast<vec4u>(vec4f(s.color, lit)));
}

// --- Maps of the caster alone --------------------------------------------------------------------------------------------

@vertex
fn caster(@location(0) at: vec3f) -> @builtin(position) vec4f {
    return to_clip(at + p.offset.xyz);
}

@fragment
fn map(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return vec4u(bitcast<u32>(select(1.0, at.z, DEPTH)));
}

/// The share of covered samples, of a mask with k x k times as many texels.
@fragment
fn count(@builtin(position) at: vec4f) -> @location(0) vec4u {
    var covered = 0.0;
    for (var row = 0; row < p.samples.x; row++) {
        for (var column = 0; column < p.samples.x; column++) {
            covered += texel(first, p.samples.x * vec2i(at.xy) + vec2i(column, row));
        }
    }
    return vec4u(bitcast<u32>(covered / f32(p.samples.x * p.samples.x)));
}

// --- Warps ---------------------------------------------------------------------------------------------------------------

struct Warp {
    @builtin(position) position: vec4f,
    @location(0) uv_first: vec2f,
    @location(1) uv_second: vec2f,
}

fn lerp(a: vec2f, b: vec2f, f: f32) -> vec2f {
    return a * (1.0 - f) + b * f;
}

/// A control mesh between two; v grows with the rows in memory.
fn mesh(a: vec2f, b: vec2f) -> Warp {
    let point = lerp(a, b, p.shares.w);
    return Warp(vec4f(2.0 * point.x - 1.0, 1.0 - 2.0 * point.y, 0.0, 1.0), a, b);
}

/// Two neighbouring maps of a row.
@vertex
fn row(@location(0) a: vec2f, @location(1) b: vec2f) -> Warp {
    return mesh(a, b);
}

/// Two rows, each between two maps.
@vertex
fn column(@location(0) a: vec2f, @location(1) b: vec2f, @location(2) c: vec2f, @location(3) d: vec2f) -> Warp {
    return mesh(lerp(a, b, p.shares.x), lerp(c, d, p.shares.y));
}

fn texel(image: texture_2d<u32>, at: vec2i) -> f32 {
    let last = vec2i(textureDimensions(image)) - 1;
    return bitcast<f32>(textureLoad(image, clamp(at, vec2i(0), last), 0).x);
}

fn fetch(image: texture_2d<u32>, uv: vec2f) -> f32 {
    let at = uv * vec2f(textureDimensions(image)) - 0.5;
    let corner = floor(at);
    let f = at - corner;
    let low = vec2i(corner);
    let top = mix(texel(image, low), texel(image, low + vec2i(1, 0)), f.x);
    let bottom = mix(texel(image, low + vec2i(0, 1)), texel(image, low + vec2i(1, 1)), f.x);
    return mix(top, bottom, f.y);
}

@fragment
fn warped(w: Warp) -> @location(0) vec4u {
    let a = fetch(first, w.uv_first);
    let b = fetch(second, w.uv_second);
    let mixed = select(mix(a, b, p.shares.w), select(b, a, p.shares.w < 0.5), NEAREST);
    return vec4u(bitcast<u32>(mixed));
}

/// Of method "grid": two maps, mixed where they are.
@fragment
fn mixed(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return vec4u(bitcast<u32>(mix(texel(first, vec2i(at.xy)), texel(second, vec2i(at.xy)), p.shares.w)));
}

// --- The map as a projective texture: first are the places, second is the map --------------------------------------------

fn rounded(x: f32) -> f32 {
    return select(x, floor(255.0 * x + 0.5), QUANTIZE);
}

/// What a texel says of a fragment at depth r.
fn value(at: vec2i, r: f32) -> f32 {
    let found = texel(second, at);
    return select(found, select(0.0, 1.0, rounded(r - p.offset.w) > rounded(found)), DEPTH);
}

fn shadow_of(coord: vec3f) -> f32 {
    let size = vec2f(textureDimensions(second));
    if (DEPTH && !PCF) { return value(vec2i(floor(coord.xy * size)), coord.z); }
    let at = coord.xy * size - 0.5;
    let corner = floor(at);
    let f = at - corner;
    let low = vec2i(corner);
    let top = mix(value(low, coord.z), value(low + vec2i(1, 0), coord.z), f.x);
    let bottom = mix(value(low + vec2i(0, 1), coord.z), value(low + vec2i(1, 1), coord.z), f.x);
    return mix(top, bottom, f.y);
}

/// Coordinates and shadow; nothing where nothing is seen.
fn projection(pixel: vec2i) -> vec4f {
    let place = bitcast<vec4f>(textureLoad(first, pixel, 0));
    if (place.w < 0.5) { return vec4f(0.0); }
    let q = to_clip(place.xyz);
    var coord = vec3f(0.5 * q.x + 0.5 * q.w, 0.5 * q.w - 0.5 * q.y, q.z) / q.w;
    coord.z = clamp(coord.z, 0.0, 1.0);
    let inside = q.w > 0.0 && all(coord.xy >= vec2f(0.0)) && all(coord.xy <= vec2f(1.0));
    let receives = DEPTH || place.w < 1.5;      // a mask knows nothing of what is in front of the caster
    var shadow = 0.0;
    if (inside && receives) { shadow = shadow_of(coord); }
    return vec4f(coord, shadow);
}

@fragment
fn projected(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return bitcast<vec4u>(projection(vec2i(at.xy)));
}

/// Into bytes: blended with (source alpha, one).
@fragment
fn blended(@builtin(position) at: vec4f) -> @location(0) vec4f {
    return vec4f(projection(vec2i(at.xy)).w, 0.0, 0.0, p.light.w);
}

/// Floats are not blended everywhere: first are the projections of this sample, second is the sum so far.
@fragment
fn added(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let shadow = bitcast<vec4f>(textureLoad(first, vec2i(at.xy), 0)).w;
    return vec4u(bitcast<u32>(texel(second, vec2i(at.xy)) + p.light.w * shadow));
}

/// First are the places, second the surfaces, third is the sum as floats.
@fragment
fn resolved(@builtin(position) at: vec4f) -> @location(0) vec4u {
    let pixel = vec2i(at.xy);
    let surface = bitcast<vec4f>(textureLoad(second, pixel, 0));
    let shadow = min(textureLoad(third, pixel, 0).x, 1.0);
    let light = p.background.w + (1.0 - p.background.w) * (1.0 - shadow) * surface.w;
    let seen = bitcast<vec4f>(textureLoad(first, pixel, 0)).w > 0.5;
    return bitcast<vec4u>(vec4f(select(p.background.rgb, surface.rgb * light, seen), 1.0));
}

// --- Control meshes, to be read ------------------------------------------------------------------------------------------

@group(0) @binding(4) var<storage, read> points: array<vec4f>;         // two for each: a, b; c, d
@group(0) @binding(5) var<storage, read_write> made: array<vec4f>;     // the row's between a and b, between c and d; the column's

@compute @workgroup_size(64)
fn grids(@builtin(global_invocation_id) id: vec3u) {
    if (2u * id.x >= arrayLength(&points)) { return; }
    let upper = lerp(points[2u * id.x].xy, points[2u * id.x].zw, p.shares.x);
    let lower = lerp(points[2u * id.x + 1u].xy, points[2u * id.x + 1u].zw, p.shares.y);
    made[2u * id.x] = vec4f(upper, lower);
    made[2u * id.x + 1u] = vec4f(lerp(upper, lower, p.shares.z), 0.0, 0.0);
}
