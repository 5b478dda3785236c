// Protruded displacement mapping: vertex stage, march, shading, depth of the hit. Constants are put in front by displacement.py:
//   LINEAR_STEPS, BINARY_STEPS, SHADOW_STEPS, SHADOW_BIAS, STEEP_THRESHOLD, EXPONENT
//   HAS_NORMAL_MAP, HAS_FACADE_MAP, POLYGON_DEPTH, REPEAT, VOLUME
//   SEARCH, and the numbers of the searches: PROTRUDED, and those of displacement_below.wgsl; FLOOR, h of the volume's bottom
// One picture is drawn by three passes of the same computation, which differ in what they hand on.

struct Polygon {
    clip_from_view: mat4x4f,
    view_from_world: mat4x4f,
    clip_from_patch: mat4x4f,
    corner: vec4f,
    edge_u: vec4f,
    edge_v: vec4f,
    edge_h: vec4f,          // s n: from h = 0 to h = 1
    reciprocal_u: vec4f,
    reciprocal_v: vec4f,
    unit_normal: vec4f,
    eye_patch: vec4f,       // homogeneous: w = 0 for a direction
    light_patch: vec4f,
    eye_world: vec4f,
    light_world: vec4f,     // w = 0: a unit direction towards the light
    lighting: vec4f,        // ambient, diffuse, specular
    background: vec4f,
    sizes: vec4f,           // |U|, |V|, facade tile width and height
    search: vec4f,          // height scale s
    identity: vec4i,        // patch id
}

@group(0) @binding(0) var<uniform> p: Polygon;
@group(0) @binding(1) var height_map: texture_2d<f32>;
@group(0) @binding(2) var color_map: texture_2d<f32>;
@group(0) @binding(3) var normal_map: texture_2d<f32>;
@group(0) @binding(4) var facade_map: texture_2d<f32>;

const FINE: f32 = f32(1 << u32(BINARY_STEPS));      // lattice steps in one linear step
const LATTICE: f32 = f32(LINEAR_STEPS) * FINE;      // K
const FLAT: f32 = 1.0 / 65536.0;                    // a difference of heights below this is none
const MISS_DEPTH: f32 = 0.99999994;                 // 1 - 2^-24: the first miss stays, any hit replaces it

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) point: vec3f,
    @location(1) @interpolate(flat) face: i32,
}

@vertex
fn vertex(@location(0) point: vec3f, @location(1) face: i32) -> Corner {
    return Corner(to_clip(point), point, face);
}

fn to_world(point: vec3f) -> vec3f {
    return p.corner.xyz + point.x * p.edge_u.xyz + point.y * p.edge_v.xyz + point.z * p.edge_h.xyz;
}

fn to_clip(point: vec3f) -> vec4f {
    return p.clip_from_view * (p.view_from_world * vec4f(to_world(point), 1.0));
}

// --- Fetches: 32-bit floats need no filter of the device ----------------------------------------------------------------

fn wrapped(at: i32, size: i32, repeat: bool) -> i32 {
    if (!repeat) { return clamp(at, 0, size - 1); }
    return at - size * i32(floor(f32(at) / f32(size)));    // not %, which some drivers take for that of unsigned numbers
}

fn fetch(map: texture_2d<f32>, uv: vec2f, repeat: bool) -> vec4f {
    let size = vec2i(textureDimensions(map));
    let at = uv * vec2f(size) - 0.5;
    let corner = floor(at);
    let f = at - corner;
    let low = vec2i(clamp(corner, vec2f(-1e6), vec2f(1e6)));
    let x = vec2i(wrapped(low.x, size.x, repeat), wrapped(low.x + 1, size.x, repeat));
    let y = vec2i(wrapped(low.y, size.y, repeat), wrapped(low.y + 1, size.y, repeat));
    let top = mix(textureLoad(map, vec2i(x.x, y.x), 0), textureLoad(map, vec2i(x.y, y.x), 0), f.x);
    let bottom = mix(textureLoad(map, vec2i(x.x, y.y), 0), textureLoad(map, vec2i(x.y, y.y), 0), f.x);
    return mix(top, bottom, f.y);
}

fn height(uv: vec2f) -> f32 {
    return fetch(height_map, uv, REPEAT).x;
}

// --- March --------------------------------------------------------------------------------------------------------------

struct Hit {
    found: bool,
    position: vec3f,        // (u, v, h)
    linear_index: f32,      // i
    hit_index: f32,         // k
    before: f32,            // a
    steep: bool,
}

/// The first and the last t at which origin + direction t is in the unit square.
fn inside_square(origin: vec2f, direction: vec2f) -> vec2f {
    let moving = select(direction, vec2f(1e-30), abs(direction) < vec2f(1e-30));
    let t0 = -origin / moving;
    let t1 = (1.0 - origin) / moving;
    let enter = min(t0, t1);
    let leave = max(t0, t1);
    return vec2f(max(enter.x, enter.y), min(leave.x, leave.y));
}

/// Where the way to c enters the volume; the eye itself, if that is inside.
fn entry(c: vec3f) -> vec3f {
    let eye = p.eye_patch.xyz;
    if (p.eye_patch.w == 1.0 && all(eye == clamp(eye, vec3f(0.0), vec3f(1.0)))) { return eye; }
    let towards = eye - p.eye_patch.w * c;
    let border = select(vec3f(0.0), vec3f(1.0), towards > vec3f(0.0));
    let still = towards == vec3f(0.0);
    let t = select((border - c) / select(towards, vec3f(1.0), still), vec3f(1e30), still);
    let nearest = min(min(t.x, t.y), t.z);
    var place = c + towards * nearest;
    if (t.x == nearest) { place.x = border.x; }
    else if (t.y == nearest) { place.y = border.y; }
    else { place.z = border.z; }
    return place;
}

fn march(c: vec3f) -> Hit {
    let v = p.eye_patch.xyz - p.eye_patch.w * c;
    var bottom = c.xy;
    var start: vec3f;
    var way: vec3f;
    var searched = true;
    if (VOLUME) {
        start = entry(c);
        way = c - start;
    } else {
        searched = v.z > 0.0;
        let rise = select(1.0, v.z, searched);
        bottom = c.xy - v.xy * (c.z / rise);                        // A, at h = 0
        start = vec3f(c.xy + v.xy * ((1.0 - c.z) / rise), 1.0);     // B, at h = 1
        way = vec3f(bottom - start.xy, -1.0);
    }
    var domain = vec2f(0.0, 1.0);
    if (!VOLUME && !REPEAT) { domain = inside_square(start.xy, way.xy); }
    let first = max(ceil(domain.x * f32(LINEAR_STEPS)), 0.0);
    let last = min(floor(domain.y * f32(LINEAR_STEPS)), f32(LINEAR_STEPS));
    var i = first;
    if (!VOLUME) { i = max(first, 1.0); }                           // never at i = 0: h = 1
    var stopped = false;
    while (i <= last) {
        let at = start + way * (i / f32(LINEAR_STEPS));
        if (at.z < height(at.xy)) {
            stopped = true;
            break;
        }
        i += 1.0;
    }
    var k = i * FINE;
    var half_bracket = 0.5 * FINE;                                  // the bracket is (k - 2 half_bracket, k]
    while (stopped && half_bracket >= 1.0) {
        let middle = (k - half_bracket) / LATTICE;
        let at = start + way * middle;
        if (middle >= domain.x && at.z < height(at.xy)) { k -= half_bracket; }
        half_bracket *= 0.5;
    }
    let above = stopped && k < LATTICE;                             // a hit at k = K is the polygon itself
    let ground = c.z == 0.0 && all(c.xy >= vec2f(0.0)) && all(c.xy <= vec2f(1.0));
    var hit = Hit(searched && (above || ground), vec3f(bottom, 0.0), -1.0, LATTICE, 0.0, false);
    if (above) {
        hit.position = start + way * (k / LATTICE);
        hit.linear_index = i;
        hit.hit_index = k;
        if (i - 1.0 >= first) { hit.before = height((start + way * ((i - 1.0) / f32(LINEAR_STEPS))).xy); }
        hit.steep = hit.position.z - hit.before > STEEP_THRESHOLD;
    }
    return hit;
}

// --- Shading ------------------------------------------------------------------------------------------------------------

/// Slope of the height field in u and v by central differences one texel apart.
fn gradient(uv: vec2f) -> vec2f {
    let size = vec2f(textureDimensions(height_map));
    let texel = 1.0 / size;
    var difference = vec2f(
        height(vec2f(uv.x + texel.x, uv.y)) - height(vec2f(uv.x - texel.x, uv.y)),
        height(vec2f(uv.x, uv.y + texel.y)) - height(vec2f(uv.x, uv.y - texel.y)));
    difference = select(difference, vec2f(0.0), abs(difference) < vec2f(FLAT));
    return difference * size * 0.5;
}

struct Surface {
    normal: vec3f,
    albedo: vec3f,
}

fn surface(hit: Hit) -> Surface {
    let uv = hit.position.xy;
    var albedo = fetch(color_map, uv, REPEAT).rgb;
    let slope = gradient(uv);
    let uphill = slope.x * p.reciprocal_u.xyz + slope.y * p.reciprocal_v.xyz;
    var normal = unit(p.unit_normal.xyz - p.search.x * uphill);
    if (HAS_NORMAL_MAP) {
        let code = 2.0 * fetch(normal_map, uv, REPEAT).rgb - 1.0;
        let x = p.edge_u.xyz / p.sizes.x;
        normal = unit(code.x * x + code.y * cross(p.unit_normal.xyz, x) + code.z * p.unit_normal.xyz);
        if (all(code == vec3f(0.0))) { normal = p.unit_normal.xyz; }
    }
    if (HAS_FACADE_MAP && hit.steep) {
        let view = p.eye_patch.xy - p.eye_patch.w * uv;
        let level = all(slope == vec2f(0.0));
        let side = select(abs(slope) / p.sizes.xy, abs(view) * p.sizes.xy, level);
        normal = unit(select(-uphill, view.x * p.edge_u.xyz + view.y * p.edge_v.xyz, level));
        if (all(normal == vec3f(0.0))) { normal = p.unit_normal.xyz; }
        let along = select(uv.x * p.sizes.x, uv.y * p.sizes.y, side.x >= side.y);
        albedo = fetch(facade_map, vec2f(along, -hit.position.z * p.search.x) / p.sizes.zw, true).rgb;
    }
    return Surface(normal, albedo);
}

/// False where the height field stands between the hit and the light.
fn is_lit(hit: vec3f) -> bool {
    if (SHADOW_STEPS == 0) { return true; }
    if (p.light_patch.z <= 0.0) { return false; }       // below the polygon's horizon
    let towards = p.light_patch.xyz - p.light_patch.w * hit;
    let moving = select(towards, vec3f(1e-30), abs(towards) < vec3f(1e-30));
    let raised = hit - vec3f(0.0, 0.0, FLOOR);
    let leave = max(-raised / moving, (1.0 - raised) / moving);
    var stretch = leave.z;
    if (!REPEAT) { stretch = min(min(leave.x, leave.y), leave.z); }
    if (p.light_patch.w != 0.0) { stretch = min(stretch, 1.0); }
    if (!(stretch > 0.0)) { return true; }
    let path = towards * stretch;
    for (var j = 1; j <= SHADOW_STEPS; j++) {
        let point = raised + path * (f32(j) / f32(SHADOW_STEPS + 1));
        if (point.z + SHADOW_BIAS < height(point.xy)) { return false; }
    }
    return true;
}

fn shade(world: vec3f, made: Surface, lit: f32) -> vec3f {
    let light = unit(p.light_world.xyz - p.light_world.w * world);
    let facing = dot(made.normal, light);
    var color = made.albedo * (p.lighting.x + p.lighting.y * lit * max(facing, 0.0));
    let view = unit(p.eye_world.xyz - p.eye_world.w * world);
    let reflected = 2.0 * facing * made.normal - light;
    if (facing > 0.0) { color += p.lighting.z * lit * power(max(dot(reflected, view), 0.0)); }
    return clamp(color, vec3f(0.0), vec3f(1.0));
}

// --- What the passes hand on --------------------------------------------------------------------------------------------

struct Fragment {
    hit: Hit,
    made: Surface,
    kept: bool,
    lit: bool,
    depth: f32,
}

fn fragment(corner: Corner) -> Fragment {
    var hit: Hit;
    if (SEARCH == PROTRUDED) { hit = march(corner.point); } else { hit = march_below(corner.point); }
    let clip = p.clip_from_patch * vec4f(hit.position, 1.0);
    let kept = hit.found && clip.z >= 0.0;
    var depth = MISS_DEPTH;
    if (kept) { depth = select(clip.z / clip.w, corner.position.z, POLYGON_DEPTH); }
    return Fragment(hit, surface(hit), kept, is_lit(hit.position), depth);
}

struct Pair {
    @location(0) first: vec4u,      // bits of floats
    @location(1) second: vec4u,
    @builtin(frag_depth) depth: f32,
}

struct Picture {
    @location(0) color: vec4u,
    @location(1) index: vec4i,      // face, patch id, linear index, hit index
    @builtin(frag_depth) depth: f32,
}

@fragment
fn picture(corner: Corner) -> Picture {
    let f = fragment(corner);
    var color = p.background.rgb;
    var index = vec2i(-1);
    if (f.kept) {
        color = shade(to_world(f.hit.position), f.made, select(0.0, 1.0, f.lit));
        index = vec2i(i32(f.hit.linear_index), i32(f.hit.hit_index));
    }
    return Picture(bitcast<vec4u>(vec4f(color, 1.0)), vec4i(corner.face, p.identity.x, index), f.depth);
}

/// C; the hit, and the height before.
@fragment
fn hits(corner: Corner) -> Pair {
    let f = fragment(corner);
    let hit = vec4f(f.hit.position, select(0.0, f.hit.before, f.kept));
    return Pair(bitcast<vec4u>(vec4f(corner.point, 1.0)), bitcast<vec4u>(hit), f.depth);
}

/// Albedo and whether it is lit; normal and whether it is steep.
@fragment
fn looks(corner: Corner) -> Pair {
    let f = fragment(corner);
    let albedo = vec4f(f.made.albedo, select(0.0, 1.0, f.lit));
    let normal = vec4f(f.made.normal, select(0.0, 1.0, f.kept && f.hit.steep));
    return Pair(bitcast<vec4u>(albedo), bitcast<vec4u>(normal), f.depth);
}

// --- The vertex stage once more, to be read ------------------------------------------------------------------------------

@group(0) @binding(5) var<storage, read> points: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> clips: array<vec4f>;

@compute @workgroup_size(64)
fn vertices(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&points)) { clips[id.x] = to_clip(points[id.x].xyz); }
}
