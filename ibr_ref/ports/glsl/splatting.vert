// Splatting of depth images, vertex stage: one vertex a valid pixel of a reference image (Lee & Park 2006, section 3.2).
// `#version` and the #defines are put in front by splatting.py:
//   LIT, HAS_SPECULAR, EXPONENT               Phong's lighting, or the stored colours
//   COLOR_TEXTURE                             colours that are no bytes
//   QUADS, DISC, STAGES, CAPTURE              the primitive, its shape, and what is handed on
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
#else
layout(location = 0) flat out vec3 color;
#ifdef STAGES
layout(location = 1) flat out int splat;
#endif
#ifdef DISC
layout(location = 2) flat out vec3 disc;        // centre in the window, quarter of the squared width
#endif
#endif

vec3 bytes(uint word) {
    return vec3(uvec3(word, word >> 8, word >> 16) & 255u);
}

vec3 unit(vec3 a) {
    float square = dot(a, a);
    return square > 0.0 ? a * inversesqrt(square) : a;
}

/** The centre of the pixel in the reference camera's view space. */
vec3 unproject(float along_axis) {
    vec2 centre = vec2(pixel) + 0.5;
    float y = (centre.y - pinhole.y) * pinhole.w;
    float x = (centre.x - pinhole.x - lens.x * y) * pinhole.z;
    float stretch = lens.y != 0.0 ? along_axis : 1.0;
    return vec3(x * stretch, -(y * stretch), -along_axis);
}

/** The rational law, of the distance from the eye; orthographic: from the plane of the camera. */
float splat_width(vec3 world, vec3 view) {
    float d = lens.z != 0.0 ? distance(world, eye.xyz) : -view.z;
    return clamp(law.x / (law.y * (d * d) + law.z * d + law.w), limits.x, limits.y);
}

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
    float size = splat_width(world, view);
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
#else
#ifdef QUADS
    int number = gl_VertexID >> 2;              // four vertices a splat
    vec2 corner = snapped + (vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) - 0.5) * size;
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
#endif
}
