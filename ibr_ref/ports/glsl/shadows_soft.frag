// Percentage-closer soft shadows: one map parallel to the light is asked for blockers, and then as wide as the penumbra.
// COORD: coordinates, blocker, penumbra and shadow as numbers; otherwise the shadow as a source for blending.

layout(binding = 0) uniform sampler2D places;
layout(binding = 1) uniform sampler2D map;
layout(binding = 2) uniform sampler2D search;   // points of the light, as displacements on the map at distance 1
layout(binding = 3) uniform sampler2D spread;   // those of the filter
uniform mat4 clip_from_view;
uniform mat4 view_from_world;
uniform vec3 planes;  // near and far of the map, the caster's nearest distance
uniform float bias;
uniform float alpha;

layout(location = 0) out vec4 result;
#ifdef COORD
layout(location = 1) out vec4 softness;
#endif

float depth_at(ivec2 column_row) {
    return texelFetch(map, clamp(column_row, ivec2(0), textureSize(map, 0) - 1), 0).r;
}

float distance_of(float depth) {
    return planes.x * planes.y / (planes.y - depth * (planes.y - planes.x));
}

bool nearer(float depth, float here) {
    return depth < 1.0 && distance_of(depth) < here;
}

float asked(ivec2 column_row, float here) {
    return nearer(depth_at(column_row), here) ? 1.0 : 0.0;
}

bool on_map(vec2 st) {
    return all(greaterThanEqual(st, vec2(0.0))) && all(lessThanEqual(st, vec2(1.0)));
}

// The mean distance of what blocks, 0 without any.
float blocker(vec2 st, float scale, float here) {
    float total = 0.0;
    float count = 0.0;
    for (int i = 0; i < textureSize(search, 0).x; ++i) {
        vec2 at = st + texelFetch(search, ivec2(i, 0), 0).xy * scale;
        float depth = depth_at(ivec2(floor(at * vec2(textureSize(map, 0)))));
        if (on_map(at) && nearer(depth, here)) {
            total += distance_of(depth);
            count += 1.0;
        }
    }
    return count > 0.0 ? total / count : 0.0;
}

// The mean of the comparisons, each the mix of four.
float percentage(vec2 st, float scale, float here) {
    float total = 0.0;
    int count = textureSize(spread, 0).x;
    for (int i = 0; i < count; ++i) {
        vec2 place = st + texelFetch(spread, ivec2(i, 0), 0).xy * scale;
        vec2 at = place * vec2(textureSize(map, 0)) - 0.5;
        vec2 corner = floor(at);
        vec2 f = at - corner;
        ivec2 low = ivec2(corner);
        float top = mix(asked(low, here), asked(low + ivec2(1, 0), here), f.x);
        float bottom = mix(asked(low + ivec2(0, 1), here), asked(low + ivec2(1, 1), here), f.x);
        total += on_map(place) ? mix(top, bottom, f.y) : 0.0;
    }
    return total / float(count);
}

void main() {
    vec4 place = texelFetch(places, ivec2(gl_FragCoord.xy), 0);
    vec4 q = clip_from_view * (view_from_world * vec4(place.xyz, 1.0));
    vec3 coord = vec3(vec2(0.5 * q.x + 0.5 * q.w, 0.5 * q.w - 0.5 * q.y) / q.w, q.w);
    bool receives = place.w > 0.5 && place.w < 1.5 && coord.z > planes.z && on_map(coord.xy);
    float here = coord.z - bias;
    float found = receives ? blocker(coord.xy, 1.0 / planes.z - 1.0 / coord.z, here) : 0.0;
    float penumbra = found > 0.0 ? 1.0 / found - 1.0 / coord.z : 0.0;
    float shadow = found > 0.0 ? percentage(coord.xy, penumbra, here) : 0.0;
#ifdef COORD
    result = place.w > 0.5 ? vec4(coord, shadow) : vec4(0.0);
    softness = vec4(found, penumbra, 0.0, 0.0);
#else
    result = vec4(shadow, 0.0, 0.0, alpha);
#endif
}
