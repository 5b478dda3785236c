// Splatting of depth images, vertex stage: one vertex a valid pixel of a reference image (Lee & Park 2006, section 3.2).
// `#version` and the #defines are put in front by splatting.py:
//   LIT, HAS_SPECULAR, EXPONENT               Phong's lighting, or the stored colours
//   COLOR_TEXTURE                             colours that are no bytes
//   QUADS, DISC, STAGES, CAPTURE              the primitive, its shape, and what is handed on
//   ELLIPSE                                   elliptical Gaussians for squares (Zwicker et al. 2001, section 4)
//   ZERO_TO_ONE                               the clip volume is 0 ≤ z ≤ w
//
// Written for speed on a CPU driver, whose vertex stage runs on one thread: all of a pixel is one texel and one fetch, what
// is the same for all vertices is a uniform, and a varying that the fragment stage does not need is not there. Measured on
// llvmpipe and no faster: the pixel from gl_VertexID instead of an attribute, the colour packed into one integer varying,
// depth and colour as floats, fewer driver threads. A vertex stage that does next to nothing takes two thirds
// of the time of this one.

layout(std140, binding = 0) uniform Splats {
    mat4 world_from_view;   // T_R→W, of the reference camera
    mat4 view_from_world;   // T_W→C
    mat4 clip_from_view;    // T_P
    vec4 pinhole;           // of the reference camera: c_x, c_y, 1/f_x, 1/f_y
    vec4 lens;              // its skew, 1 if it is perspective, 1 if the view camera is
    vec4 eye;               // homogeneous: w = 0 for a direction
    vec4 light;             // w = 0: a unit direction towards the light
    vec4 lighting;          // ambient, diffuse, specular
    vec4 law;               // alpha, beta, gamma, delta
    vec4 limits;            // least and largest width, pixels
    vec4 picture;           // columns, rows, and what part of the viewport's they are
    vec4 filters;           // footprint, low_pass, cutoff, depth_tolerance
    ivec4 identity;         // number of the image's first vertex
};

layout(binding = 0) uniform usampler2D texels;  // depth as a 32-bit float, colour, normal: the latter four bytes each
#ifdef COLOR_TEXTURE
layout(binding = 1) uniform sampler2D colors;   // as floats
#endif

layout(location = 0) in uvec2 pixel;            // column, row

#ifdef CAPTURE
out vec2 window;
out float depth;
out float width;
out vec3 color;
#ifdef ELLIPSE
out vec3 covariance;
out float amplitude;
out float along;
#endif
#else
layout(location = 0) flat out vec3 color;
#ifdef STAGES
layout(location = 1) flat out int splat;
#endif
#ifdef DISC
layout(location = 2) flat out vec3 disc;        // centre in the window, quarter of the squared width
#endif
#ifdef ELLIPSE
layout(location = 3) flat out vec4 gaussian;    // centre in the window, weight there, distance along the view axis
layout(location = 4) flat out vec3 conic;       // inverse of the covariance: xx, xy, yy
layout(location = 5) flat out vec2 ends;        // cutoff², 1 + depth_tolerance
#endif
#endif

vec3 bytes(uint word) {
    return vec3(uvec3(word, word >> 8, word >> 16) & 255u);
}

vec3 unit(vec3 a) {
    float square = dot(a, a);
    return square > 0.0 ? a * inversesqrt(square) : a;
}

/** The centre of the pixel at depth 1, y downwards. */
vec2 image_plane() {
    vec2 centre = vec2(pixel) + 0.5;
    float y = (centre.y - pinhole.y) * pinhole.w;
    return vec2((centre.x - pinhole.x - lens.x * y) * pinhole.z, y);
}

/** The centre of the pixel in the reference camera's view space. */
vec3 unproject(float along_axis) {
    float stretch = lens.y != 0.0 ? along_axis : 1.0;
    vec2 plane = image_plane() * stretch;
    return vec3(plane.x, -plane.y, -along_axis);
}

/** The rational law, of the distance from the eye; orthographic: from the plane of the camera. */
float splat_width(vec3 world, vec3 view) {
    float d = lens.z != 0.0 ? distance(world, eye.xyz) : -view.z;
    return clamp(law.x / (law.y * (d * d) + law.z * d + law.w), limits.x, limits.y);
}

#ifdef ELLIPSE
const float LEAST_COSINE = 0.5, LEAST_AMPLITUDE = 1.0 / 1048576.0;

/** A step in the reference image, taken on the tangent plane, in pixels of the window. */
vec2 window_step(vec3 step, vec3 sight, vec3 normal, float facing, vec4 clip) {
    step -= sight * (dot(normal, step) / facing);
    vec4 moved = clip_from_view * vec4(mat3(view_from_world) * step, 0.0);
    return (moved.xy - clip.xy / clip.w * moved.w) / clip.w * vec2(0.5, -0.5) * picture.xy;
}

/** xx, xy, yy of the splat's covariance, square pixels, and its weight at the centre. */
vec4 footprint(vec3 normal, float along_axis, vec4 clip) {
    vec2 plane = image_plane();
    mat3 turn = mat3(world_from_view);
    float scale = lens.y != 0.0 ? along_axis : 1.0;
    vec3 sight = turn * (lens.y != 0.0 ? vec3(plane.x, -plane.y, -1.0) : vec3(0.0, 0.0, -1.0));
    float facing = min(dot(normal, sight), -LEAST_COSINE * length(sight));
    vec3 across = turn * vec3(scale * pinhole.z, 0.0, 0.0);
    vec3 down = turn * vec3(-scale * lens.x * pinhole.z * pinhole.w, -scale * pinhole.w, 0.0);
    vec2 u = window_step(across, sight, normal, facing, clip), v = window_step(down, sight, normal, facing, clip);
    float s = filters.x * filters.x, h = filters.y * filters.y;
    vec3 squares = vec3(u.x * u.x + v.x * v.x, u.x * u.y + v.x * v.y, u.y * u.y + v.y * v.y);
    float area = s * abs(u.x * v.y - v.x * u.y);
    float weight = area / sqrt(area * area + s * h * (squares.x + squares.z) + h * h);
    float side = limits.y / (2.0 * filters.z);
    squares *= s;
    squares *= min(1.0, (side * side - h) / max(squares.x, squares.z));
    return vec4(squares.x + h, squares.y, squares.z + h, clamp(weight, LEAST_AMPLITUDE, 1.0));
}
#endif

#ifdef LIT
/** base to the power EXPONENT by repeated squaring. */
float power(float base) {
    float result = 1.0;
    for (int e = EXPONENT; e > 0; e >>= 1) {
        if ((e & 1) == 1) result *= base;
        base *= base;
    }
    return result;
}

vec3 shade(vec3 world, vec3 normal, vec3 albedo) {
    vec3 towards = unit(light.xyz - light.w * world);
    float facing = dot(normal, towards);
    vec3 lit = albedo * (lighting.x + lighting.y * max(facing, 0.0));
#ifdef HAS_SPECULAR
    vec3 view = unit(eye.xyz - eye.w * world);
    vec3 reflected = 2.0 * facing * normal - towards;
    if (facing > 0.0) lit += lighting.z * power(max(dot(reflected, view), 0.0));
#endif
    return clamp(lit, 0.0, 1.0);
}
#endif

void main() {
    uvec4 texel = texelFetch(texels, ivec2(pixel), 0);
    vec3 world = (world_from_view * vec4(unproject(uintBitsToFloat(texel.x)), 1.0)).xyz;
    vec3 view = (view_from_world * vec4(world, 1.0)).xyz;
    vec4 clip = clip_from_view * vec4(view, 1.0);
#ifdef ELLIPSE
    vec4 shape = footprint(unit(bytes(texel.z) - 128.0), uintBitsToFloat(texel.x), clip);
    vec2 sides = 2.0 * filters.z * sqrt(shape.xz);
    float size = max(sides.x, sides.y);
#else
    float size = splat_width(world, view);
#endif
#ifdef COLOR_TEXTURE
    color = texelFetch(colors, ivec2(pixel), 0).rgb;
#else
    color = bytes(texel.y) / 255.0;
#endif
#ifdef LIT
    color = shade(world, unit(bytes(texel.z) - 128.0), color);
#endif

#if defined(CAPTURE) || defined(QUADS) || defined(DISC)
    bool kept = clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w;
    vec3 ndc = clip.xyz / clip.w;
    vec2 centre = vec2(ndc.x + 1.0, 1.0 - ndc.y) * 0.5 * picture.xy;
    vec2 snapped = roundEven(256.0 * centre) / 256.0;
#endif

#ifdef CAPTURE
    window = centre;
    depth = ndc.z;
    width = kept ? size : -1.0;  // the law may make splats of no width, which are not dropped
#ifdef ELLIPSE
    covariance = shape.xyz;
    amplitude = shape.w;
    along = -view.z;
#endif
#else
#ifdef QUADS
    int number = gl_VertexID >> 2;              // four vertices a splat
#ifdef ELLIPSE
    vec2 box = sides + 1.0;                     // the fragment stage cuts the ellipse out, wherever corners are snapped to
#else
    vec2 box = vec2(size);
#endif
    vec2 corner = snapped + (vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) - 0.5) * box;
    vec4 position = kept ? vec4(2.0 * corner / picture.xy - 1.0, ndc.z, 1.0) : vec4(0.0, 0.0, 2.0, 1.0);
#else
    int number = gl_VertexID;
    vec4 position = clip * vec4(picture.z, -picture.w, 1.0, 1.0);
    gl_PointSize = size;
#endif
    // Either way rows grow downwards in the window and in memory: y is negated, nothing is flipped on read-back.
#ifndef ZERO_TO_ONE
    position.z = 2.0 * position.z - position.w;
#endif
    gl_Position = position;
#ifdef STAGES
    splat = identity.x + number;
#endif
#ifdef DISC
    disc = vec3(snapped, 0.25 * size * size);
#endif
#ifdef ELLIPSE
    gaussian = vec4(snapped, shape.w, -view.z);
    conic = shape.zyx / (shape.x * shape.z - shape.y * shape.y) * vec3(1.0, -1.0, 1.0);
    ends = vec2(filters.z * filters.z, 1.0 + filters.w);
#endif
#endif
}
