// Splatting of depth images: one instance of a quad for each valid pixel of a reference image. Constants are put in front by
// splatting.py: LIT, EXPONENT, DISC, ELLIPSE.

struct Splats {
    world_from_view: mat4x4f,   // of the reference camera
    view_from_world: mat4x4f,
    clip_from_view: mat4x4f,
    pinhole: vec4f,             // of the reference camera: c_x, c_y, 1/f_x, 1/f_y
    lens: vec4f,                // its skew, 1 if it is perspective, 1 if the view camera is
    eye: vec4f,                 // homogeneous: w = 0 for a direction
    light: vec4f,               // w = 0: a unit direction towards the light
    lighting: vec4f,            // ambient, diffuse, specular
    law: vec4f,                 // alpha, beta, gamma, delta
    limits: vec4f,              // least and largest width, pixels
    picture: vec4f,             // columns, rows
    filters: vec4f,             // of ellipses: footprint, low_pass, cutoff, depth_tolerance
    identity: vec4i,            // number of the image's first vertex
}

@group(0) @binding(0) var<uniform> s: Splats;
@group(0) @binding(1) var depths: texture_2d<f32>;
@group(0) @binding(2) var colors: texture_2d<f32>;
@group(0) @binding(3) var normals: texture_2d<f32>;     // bytes, as they are

struct Splat {
    window: vec2f,
    depth: f32,
    width: f32,                 // -1: beside the clip volume; the law may make 0
    color: vec3f,
    distance: f32,              // along the view axis
    shape: vec4f,               // of ellipses: covariance xx, xy, yy, weight at the centre
}

/// The centre of the pixel at depth 1, y downwards.
fn image_plane(pixel: vec2u) -> vec2f {
    let centre = vec2f(pixel) + 0.5;
    let y = (centre.y - s.pinhole.y) * s.pinhole.w;
    return vec2f((centre.x - s.pinhole.x - s.lens.x * y) * s.pinhole.z, y);
}

/// The centre of the pixel in the reference camera's view space.
fn unproject(pixel: vec2u, along_axis: f32) -> vec3f {
    let plane = image_plane(pixel) * select(1.0, along_axis, s.lens.y != 0.0);
    return vec3f(plane.x, -plane.y, -along_axis);
}

fn linear(m: mat4x4f) -> mat3x3f {
    return mat3x3f(m[0].xyz, m[1].xyz, m[2].xyz);
}

/// A step in the reference image, taken on the tangent plane, in pixels of the window.
fn window_step(step: vec3f, sight: vec3f, normal: vec3f, facing: f32, clip: vec4f) -> vec2f {
    let along = step - sight * (dot(normal, step) / facing);
    let moved = s.clip_from_view * vec4f(linear(s.view_from_world) * along, 0.0);
    return (moved.xy - clip.xy / clip.w * moved.w) / clip.w * vec2f(0.5, -0.5) * s.picture.xy;
}

const LEAST_COSINE = 0.5;
const LEAST_AMPLITUDE = 1.0 / 1048576.0;

/// xx, xy, yy of the splat's covariance, square pixels, and its weight at the centre (Zwicker et al. 2001, section 4).
fn footprint(pixel: vec2u, normal: vec3f, along_axis: f32, clip: vec4f) -> vec4f {
    let plane = image_plane(pixel);
    let turn = linear(s.world_from_view);
    let perspective = s.lens.y != 0.0;
    let scale = select(1.0, along_axis, perspective);
    let sight = turn * select(vec3f(0.0, 0.0, -1.0), vec3f(plane.x, -plane.y, -1.0), perspective);
    let facing = min(dot(normal, sight), -LEAST_COSINE * length(sight));
    let across = turn * vec3f(scale * s.pinhole.z, 0.0, 0.0);
    let down = turn * vec3f(-scale * s.lens.x * s.pinhole.z * s.pinhole.w, -scale * s.pinhole.w, 0.0);
    let u = window_step(across, sight, normal, facing, clip);
    let v = window_step(down, sight, normal, facing, clip);
    let f = s.filters.x * s.filters.x;
    let h = s.filters.y * s.filters.y;
    let squares = vec3f(u.x * u.x + v.x * v.x, u.x * u.y + v.x * v.y, u.y * u.y + v.y * v.y);
    let area = f * abs(u.x * v.y - v.x * u.y);
    let weight = area / sqrt(area * area + f * h * (squares.x + squares.z) + h * h);
    let side = s.limits.y / (2.0 * s.filters.z);
    let shrink = min(1.0, (side * side - h) / (f * max(squares.x, squares.z)));
    return f * shrink * vec4f(squares, 0.0) + vec4f(h, 0.0, h, clamp(weight, LEAST_AMPLITUDE, 1.0));
}

/// Squared radius of a pixel's centre in an ellipse around a snapped centre.
fn radius(at: vec2f, centre: vec2f, covariance: vec3f) -> f32 {
    let d = at - centre;
    let determinant = covariance.x * covariance.z - covariance.y * covariance.y;
    return (covariance.z * d.x * d.x - 2.0 * covariance.y * d.x * d.y + covariance.x * d.y * d.y) / determinant;
}

/// The rational law, of the distance from the eye; orthographic: from the plane of the camera.
fn splat_width(world: vec3f, view: vec3f) -> f32 {
    let d = select(-view.z, distance(world, s.eye.xyz), s.lens.z != 0.0);
    return clamp(s.law.x / (s.law.y * (d * d) + s.law.z * d + s.law.w), s.limits.x, s.limits.y);
}

fn shade(world: vec3f, normal: vec3f, albedo: vec3f) -> vec3f {
    let towards = unit(s.light.xyz - s.light.w * world);
    let facing = dot(normal, towards);
    var lit = albedo * (s.lighting.x + s.lighting.y * max(facing, 0.0));
    let view = unit(s.eye.xyz - s.eye.w * world);
    let reflected = 2.0 * facing * normal - towards;
    if (facing > 0.0) { lit += s.lighting.z * power(max(dot(reflected, view), 0.0)); }
    return clamp(lit, vec3f(0.0), vec3f(1.0));
}

fn splat_of(pixel: vec2u) -> Splat {
    let along_axis = textureLoad(depths, vec2i(pixel), 0).x;
    let world = (s.world_from_view * vec4f(unproject(pixel, along_axis), 1.0)).xyz;
    let view = (s.view_from_world * vec4f(world, 1.0)).xyz;
    let clip = s.clip_from_view * vec4f(view, 1.0);
    var color = textureLoad(colors, vec2i(pixel), 0).rgb;
    let normal = unit(textureLoad(normals, vec2i(pixel), 0).xyz - 128.0);
    if (LIT) { color = shade(world, normal, color); }
    let kept = clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w;
    let ndc = clip.xyz / select(1.0, clip.w, clip.w > 0.0);
    let centre = vec2f(ndc.x + 1.0, 1.0 - ndc.y) * 0.5 * s.picture.xy;
    var shape = vec4f(1.0);
    var width = 0.0;
    if (ELLIPSE) {
        shape = footprint(pixel, normal, along_axis, clip);
        width = 2.0 * s.filters.z * sqrt(max(shape.x, shape.z));
    } else {
        width = splat_width(world, view);
    }
    return Splat(centre, ndc.z, select(-1.0, width, kept), color, -view.z, shape);
}

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) color: vec3f,
    @location(1) @interpolate(flat) number: i32,
    @location(2) @interpolate(flat) disc: vec3f,        // centre in the window, quarter of the squared width
    @location(3) @interpolate(flat) ellipse: vec4f,     // covariance, distance along the view axis
}

@vertex
fn vertex(@location(0) pixel: vec2u, @builtin(vertex_index) corner: u32, @builtin(instance_index) number: u32) -> Corner {
    let splat = splat_of(pixel);
    let snapped = round(256.0 * splat.window) / 256.0;
    let at = vec2u((0x1au >> corner) & 1u, (0x2cu >> corner) & 1u);     // 00 10 01, 01 10 11
    var box = vec2f(splat.width);
    if (ELLIPSE) { box = 2.0 * s.filters.z * sqrt(splat.shape.xz) + 1.0; }      // the fragment stage cuts it out
    let place = snapped + (vec2f(at) - 0.5) * box;
    var position = vec4f(0.0, 0.0, 2.0, 1.0);
    if (splat.width > 0.0) {
        position = vec4f(2.0 * place.x / s.picture.x - 1.0, 1.0 - 2.0 * place.y / s.picture.y, splat.depth, 1.0);
    }
    let disc = vec3f(snapped, 0.25 * splat.width * splat.width);
    return Corner(position, splat.color, s.identity.x + i32(number), disc, vec4f(splat.shape.xyz, splat.distance));
}

struct Pixel {
    @location(0) color: vec4u,      // bits of floats
    @location(1) splat: i32,
}

@fragment
fn fragment(corner: Corner) -> Pixel {
    let off = corner.position.xy - corner.disc.xy;
    if (DISC && off.x * off.x + off.y * off.y > corner.disc.z) { discard; }
    var handed = vec4f(corner.color, 1.0);
    if (ELLIPSE) {
        let q = radius(corner.position.xy, corner.disc.xy, corner.ellipse.xyz);
        if (q > s.filters.z * s.filters.z) { discard; }
        handed = vec4f(corner.ellipse.w);       // what the second pass asks for
    }
    return Pixel(bitcast<vec4u>(handed), corner.number);
}

// --- Ellipses: those of the nearest one's surface, averaged. WebGPU need not blend 32-bit floats: each pixel goes through all. --

@group(0) @binding(6) var<storage, read> splats: array<vec4f>;          // three for each, as `vertices` makes them
@group(0) @binding(7) var nearest: texture_2d<u32>;

struct Average {
    @location(0) color: vec4u,      // bits of floats
    @location(1) sums: vec4u,       // bits of the weight, how many
}

@fragment
fn averaged(@builtin(position) at: vec4f) -> Average {
    let reach = (1.0 + s.filters.w) * bitcast<f32>(textureLoad(nearest, vec2i(at.xy), 0).x);
    var color = vec3f(0.0);
    var weight = 0.0;
    var count = 0u;
    for (var i = 0u; i < arrayLength(&splats); i += 3u) {
        let place = splats[i];
        let lit = splats[i + 1u];
        let shape = splats[i + 2u];
        if (place.w <= 0.0 || lit.w > reach) { continue; }
        let q = radius(at.xy, round(256.0 * place.xy) / 256.0, shape.xyz);
        if (q > s.filters.z * s.filters.z) { continue; }
        let w = shape.w * exp(-0.5 * q);
        color += w * lit.rgb;
        weight += w;
        count += 1u;
    }
    if (count == 0u) { discard; }
    return Average(bitcast<vec4u>(vec4f(min(color / weight, vec3f(1.0)), 1.0)), vec4u(bitcast<u32>(weight), count, 0u, 0u));
}

// --- The vertex stage once more, to be read ------------------------------------------------------------------------------

@group(0) @binding(4) var<storage, read> pixels: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> made: array<vec4f>;     // three for each: see below

@compute @workgroup_size(64)
fn vertices(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&pixels)) { return; }
    let splat = splat_of(pixels[id.x]);
    made[3u * id.x] = vec4f(splat.window, splat.depth, splat.width);
    made[3u * id.x + 1u] = vec4f(splat.color, splat.distance);
    made[3u * id.x + 2u] = splat.shape;
}
