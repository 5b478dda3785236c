// Shadows by image warping, stages 4 and 5: the map as a projective texture, as a source for blending.
// DEPTH, PCF, QUANTIZE: the comparison of depths; otherwise a mask. COORD: the coordinates and the shadow as numbers.

layout(binding = 0) uniform sampler2D places;
layout(binding = 1) uniform sampler2D map;
uniform mat4 clip_from_view;
uniform mat4 view_from_world;
uniform float bias;
uniform float alpha;

layout(location = 0) out vec4 result;

float texel_at(ivec2 column_row) {
    return texelFetch(map, clamp(column_row, ivec2(0), textureSize(map, 0) - 1), 0).r;
}

float rounded(float x) {
#ifdef QUANTIZE
    return floor(255.0 * x + 0.5);
#else
    return x;
#endif
}

// What a texel says of a fragment at depth r.
float value(ivec2 column_row, float r) {
#ifdef DEPTH
    return rounded(r - bias) > rounded(texel_at(column_row)) ? 1.0 : 0.0;
#else
    return texel_at(column_row);
#endif
}

float bilinear(vec2 st, float r) {
    vec2 at = st * vec2(textureSize(map, 0)) - 0.5;
    vec2 corner = floor(at);
    vec2 f = at - corner;
    ivec2 low = ivec2(corner);
    float top = mix(value(low, r), value(low + ivec2(1, 0), r), f.x);
    float bottom = mix(value(low + ivec2(0, 1), r), value(low + ivec2(1, 1), r), f.x);
    return mix(top, bottom, f.y);
}

float shadow_of(vec3 coord) {
#if defined(DEPTH) && !defined(PCF)
    return value(ivec2(floor(coord.xy * vec2(textureSize(map, 0)))), coord.z);
#elif defined(DEPTH) || defined(EXACT)
    return bilinear(coord.xy, coord.z);
#else
    return textureLod(map, coord.xy, 0.0).r;
#endif
}

void main() {
    vec4 place = texelFetch(places, ivec2(gl_FragCoord.xy), 0);
    vec4 q = clip_from_view * (view_from_world * vec4(place.xyz, 1.0));
    vec3 coord = vec3(0.5 * q.x + 0.5 * q.w, 0.5 * q.w - 0.5 * q.y, q.z) / q.w;
    coord.z = clamp(coord.z, 0.0, 1.0);
    bool inside = q.w > 0.0 && all(greaterThanEqual(coord.xy, vec2(0.0))) && all(lessThanEqual(coord.xy, vec2(1.0)));
#ifdef DEPTH
    bool receives = place.w > 0.5;
#else
    bool receives = place.w > 0.5 && place.w < 1.5;  // a mask knows nothing of what is in front of the caster
#endif
    float shadow = inside && receives ? shadow_of(coord) : 0.0;
#ifdef COORD
    result = place.w > 0.5 ? vec4(coord, shadow) : vec4(0.0);
#else
    result = vec4(shadow, 0.0, 0.0, alpha);
#endif
}
