// Splatting of depth images: one instance of a quad for each valid pixel of a reference image. Constants are put in front by
// splatting.py: LIT, EXPONENT, DISC.

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
}

/// The centre of the pixel in the reference camera's view space.
fn unproject(pixel: vec2u, along_axis: f32) -> vec3f {
    let centre = vec2f(pixel) + 0.5;
    let y = (centre.y - s.pinhole.y) * s.pinhole.w;
    let x = (centre.x - s.pinhole.x - s.lens.x * y) * s.pinhole.z;
    let stretch = select(1.0, along_axis, s.lens.y != 0.0);
    return vec3f(x * stretch, -(y * stretch), -along_axis);
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
    if (LIT) { color = shade(world, unit(textureLoad(normals, vec2i(pixel), 0).xyz - 128.0), color); }
    let kept = clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w;
    let ndc = clip.xyz / select(1.0, clip.w, clip.w > 0.0);
    let centre = vec2f(ndc.x + 1.0, 1.0 - ndc.y) * 0.5 * s.picture.xy;
    return Splat(centre, ndc.z, select(-1.0, splat_width(world, view), kept), color);
}

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) color: vec3f,
    @location(1) @interpolate(flat) number: i32,
    @location(2) @interpolate(flat) disc: vec3f,        // centre in the window, quarter of the squared width
}

@vertex
fn vertex(@location(0) pixel: vec2u, @builtin(vertex_index) corner: u32, @builtin(instance_index) number: u32) -> Corner {
    let splat = splat_of(pixel);
    let snapped = round(256.0 * splat.window) / 256.0;
    let at = vec2u((0x1au >> corner) & 1u, (0x2cu >> corner) & 1u);     // 00 10 01, 01 10 11
    let place = snapped + (vec2f(at) - 0.5) * splat.width;
    var position = vec4f(0.0, 0.0, 2.0, 1.0);
    if (splat.width > 0.0) {
        position = vec4f(2.0 * place.x / s.picture.x - 1.0, 1.0 - 2.0 * place.y / s.picture.y, splat.depth, 1.0);
    }
    return Corner(position, splat.color, s.identity.x + i32(number), vec3f(snapped, 0.25 * splat.width * splat.width));
}

struct Pixel {
    @location(0) color: vec4u,      // bits of floats
    @location(1) splat: i32,
}

@fragment
fn fragment(corner: Corner) -> Pixel {
    let off = corner.position.xy - corner.disc.xy;
    if (DISC && off.x * off.x + off.y * off.y > corner.disc.z) { discard; }
    return Pixel(bitcast<vec4u>(vec4f(corner.color, 1.0)), corner.number);
}

// --- The vertex stage once more, to be read ------------------------------------------------------------------------------

@group(0) @binding(4) var<storage, read> pixels: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> made: array<vec4f>;     // two for each: window, depth, width; colour

@compute @workgroup_size(64)
fn vertices(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&pixels)) { return; }
    let splat = splat_of(pixels[id.x]);
    made[2u * id.x] = vec4f(splat.window, splat.depth, splat.width);
    made[2u * id.x + 1u] = vec4f(splat.color, 1.0);
}
