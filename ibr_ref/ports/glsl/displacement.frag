// Displacement mapping, fragment stage: a search, steep walls, shading, depth of the hit. The search, `Hit march(vec3 c)`, is
// in a file of its own, which displacement.py puts in below.
// `#version` and the #defines are put in front by displacement.py:
//   LINEAR_STEPS, BINARY_STEPS, SHADOW_STEPS, SHADOW_BIAS, STEEP_THRESHOLD, EXPONENT      constants of the loops and tests
//   HAS_NORMAL_MAP, HAS_FACADE_MAP, HAS_SPECULAR, PACKED_HEIGHTS, POLYGON_DEPTH, STAGES   defined or not
//   REPEAT, VOLUME      maps that go on beyond the polygon; the ray's own stretch inside the volume
//   FLOOR      h of the volume's bottom
//
// Written for speed on a CPU driver that runs 8 pixels in a SIMD wave: the ray is cut to the unit square once, so that what
// lies outside is neither fetched nor tested; nothing is tracked that is not needed: the height before the hit is fetched
// afterwards, and only where something depends on it. Measured on llvmpipe and not faster: constant loop bounds with a
// break (the same; +40 to +90 % without the cut), two steps a round, textureGather or texelFetch with the mix written out
// (the same; +90 %), 8-bit heights (+10 %).

layout(std140, binding = 0) uniform Polygon {
    mat4 clip_from_view;
    mat4 view_from_world;
    mat4 clip_from_patch;
    vec4 corner;
    vec4 edge_u;
    vec4 edge_v;
    vec4 edge_h;        // s n: from h = 0 to h = 1
    vec4 reciprocal_u;
    vec4 reciprocal_v;
    vec4 unit_normal;
    vec4 eye_patch;     // homogeneous: w = 0 for a direction
    vec4 light_patch;
    vec4 eye_world;
    vec4 light_world;   // w = 0: a unit direction towards the light
    vec4 lighting;      // ambient, diffuse, specular
    vec4 background;
    vec4 sizes;         // |U|, |V|, facade tile width and height
    vec4 search;        // height scale s
    ivec4 identity;     // patch id
};

layout(binding = 0) uniform sampler2D height_map;
layout(binding = 1) uniform sampler2D color_map;
layout(binding = 2) uniform sampler2D normal_map;
layout(binding = 3) uniform sampler2D facade_map;

layout(location = 0) in vec3 patch_position;
layout(location = 1) flat in int face;

layout(location = 0) out vec4 out_color;
#ifdef STAGES
layout(location = 1) out ivec4 out_index;   // face, patch id, linear index, hit index
layout(location = 2) out vec4 out_patch;    // C, depth: WebGL reads no depth buffer
layout(location = 3) out vec4 out_hit;      // hit, height before
layout(location = 4) out vec4 out_albedo;   // albedo, lit
layout(location = 5) out vec4 out_normal;   // normal, steep
#endif

const float FINE = float(1 << BINARY_STEPS);               // lattice steps in one linear step
const float LATTICE = float(LINEAR_STEPS) * FINE;          // K
const float STEP = 1.0 / float(LINEAR_STEPS);
const float FLAT = 1.0 / 65536.0;                          // a difference of heights below this is none
const float MISS_DEPTH = 0.99999994;                       // 1 - 2^-24: the first miss stays, any hit replaces it

#if defined(HAS_FACADE_MAP) || defined(STAGES)
#define NEEDS_STEEP
#endif

#ifdef PACKED_HEIGHTS
/** Texel (j, i) of the packed map holds the four texels around the corner between (j - 1, i - 1) and (j, i). */
vec2 height_size() {
    return vec2(textureSize(height_map, 0)) - 1.0;
}

float height(vec2 uv) {
    vec2 size = height_size();
    vec2 corner = clamp(uv * size + 0.5, vec2(0.0), size);
    vec4 texels = texelFetch(height_map, ivec2(corner), 0);
    vec2 weight = fract(corner);
    vec2 rows = mix(texels.xz, texels.yw, weight.x);
    return mix(rows.x, rows.y, weight.y);
}
#else
vec2 height_size() {
    return vec2(textureSize(height_map, 0));
}

float height(vec2 uv) {
    return textureLod(height_map, uv, 0.0).r;
}
#endif

vec3 unit(vec3 a) {
    float square = dot(a, a);
    return square > 0.0 ? a * inversesqrt(square) : a;
}

/** The search's answer; index -1: the polygon itself was hit, or nothing. */
struct Hit {
    bool found;
    vec3 position;      // (u, v, h)
    float linear_index; // i
    float hit_index;    // k
    float before;       // a
    bool steep;
};

#include SEARCH

/** Slope of the height field in u and v by central differences one texel apart. */
vec2 gradient(vec2 uv) {
    vec2 size = height_size();
    vec2 texel = 1.0 / size;
    vec2 difference = vec2(
        height(vec2(uv.x + texel.x, uv.y)) - height(vec2(uv.x - texel.x, uv.y)),
        height(vec2(uv.x, uv.y + texel.y)) - height(vec2(uv.x, uv.y - texel.y)));
    difference = mix(difference, vec2(0.0), lessThan(abs(difference), vec2(FLAT)));
    return difference * size * 0.5;
}

/** Normal and albedo of a hit. */
void surface(Hit hit, out vec3 normal, out vec3 albedo) {
    vec2 uv = hit.position.xy;
    albedo = textureLod(color_map, uv, 0.0).rgb;
#if !defined(HAS_NORMAL_MAP) || defined(HAS_FACADE_MAP)
    vec2 slope = gradient(uv);
    vec3 uphill = slope.x * reciprocal_u.xyz + slope.y * reciprocal_v.xyz;
#endif
#ifdef HAS_NORMAL_MAP
    vec3 code = 2.0 * textureLod(normal_map, uv, 0.0).rgb - 1.0;
    vec3 x = edge_u.xyz / sizes.x;
    normal = unit(code.x * x + code.y * cross(unit_normal.xyz, x) + code.z * unit_normal.xyz);
    if (code == vec3(0.0)) normal = unit_normal.xyz;
#else
    normal = unit(unit_normal.xyz - search.x * uphill);
#endif
#ifdef HAS_FACADE_MAP
    vec2 view = eye_patch.xy - eye_patch.w * uv;
    bool level = slope == vec2(0.0);
    vec2 side = level ? abs(view) * sizes.xy : abs(slope) / sizes.xy;
    vec3 wall = level ? unit(view.x * edge_u.xyz + view.y * edge_v.xyz) : unit(-uphill);
    if (wall == vec3(0.0)) wall = unit_normal.xyz;
    float along = side.x >= side.y ? uv.y * sizes.y : uv.x * sizes.x;
    vec2 tile = vec2(along, -hit.position.z * search.x) / sizes.zw;
    vec3 facade = textureLod(facade_map, tile, 0.0).rgb;
    albedo = hit.steep ? facade : albedo;
    normal = hit.steep ? wall : normal;
#endif
}

/** False where the height field stands between the hit and the light. */
bool is_lit(vec3 hit) {
#if SHADOW_STEPS > 0
    if (light_patch.z <= 0.0) return false;             // below the polygon's horizon
    vec3 towards = light_patch.xyz - light_patch.w * hit;
    vec3 raised = hit - vec3(0.0, 0.0, FLOOR);
    vec3 moving = mix(towards, vec3(1e-30), lessThan(abs(towards), vec3(1e-30)));
    vec3 leave = max(-raised / moving, (1.0 - raised) / moving);
#ifdef REPEAT
    float stretch = leave.z;
#else
    float stretch = min(min(leave.x, leave.y), leave.z);
#endif
    if (light_patch.w != 0.0) stretch = min(stretch, 1.0);
    if (!(stretch > 0.0)) return true;
    vec3 path = towards * stretch;
    for (int j = 1; j <= SHADOW_STEPS; ++j) {
        vec3 point = raised + path * (float(j) / float(SHADOW_STEPS + 1));
        if (point.z + SHADOW_BIAS < height(point.xy)) return false;
    }
#endif
    return true;
}

/** base to the power EXPONENT by repeated squaring. */
float power(float base) {
    float result = 1.0;
    for (int e = EXPONENT; e > 0; e >>= 1) {
        if ((e & 1) == 1) result *= base;
        base *= base;
    }
    return result;
}

vec3 shade(vec3 world, vec3 normal, vec3 albedo, float lit) {
    vec3 light = unit(light_world.xyz - light_world.w * world);
    float facing = dot(normal, light);
    vec3 color = albedo * (lighting.x + lighting.y * lit * max(facing, 0.0));
#ifdef HAS_SPECULAR
    vec3 view = unit(eye_world.xyz - eye_world.w * world);
    vec3 reflected = 2.0 * facing * normal - light;
    if (facing > 0.0) color += lighting.z * lit * power(max(dot(reflected, view), 0.0));
#endif
    return clamp(color, 0.0, 1.0);
}

void main() {
    Hit hit = march(patch_position);
    vec4 position = vec4(hit.position, 1.0);
    float z = dot(vec4(clip_from_patch[0].z, clip_from_patch[1].z, clip_from_patch[2].z, clip_from_patch[3].z), position);
    float w = dot(vec4(clip_from_patch[0].w, clip_from_patch[1].w, clip_from_patch[2].w, clip_from_patch[3].w), position);
    bool kept = hit.found && z >= 0.0;
#ifndef STAGES
    if (!kept) discard;
#endif

    vec3 normal, albedo;
    surface(hit, normal, albedo);
    bool lit = is_lit(hit.position);
    vec3 world = corner.xyz + hit.position.x * edge_u.xyz + hit.position.y * edge_v.xyz + hit.position.z * edge_h.xyz;
    out_color = vec4(shade(world, normal, albedo, lit ? 1.0 : 0.0), 1.0);
#ifdef POLYGON_DEPTH
    float depth = gl_FragCoord.z;
#else
    float depth = z / w;
#endif
#ifndef STAGES
    gl_FragDepth = depth;
#else
    float written = kept ? depth : MISS_DEPTH;
    gl_FragDepth = written;
    out_color = kept ? out_color : vec4(background.rgb, 0.0);
    out_index = ivec4(face, identity.x, kept ? int(hit.linear_index) : -1, kept ? int(hit.hit_index) : -1);
    out_patch = vec4(patch_position, written);
    out_hit = vec4(hit.position, kept ? hit.before : 0.0);
    out_albedo = vec4(albedo, lit ? 1.0 : 0.0);
    out_normal = vec4(normal, kept && hit.steep ? 1.0 : 0.0);
#endif
}
