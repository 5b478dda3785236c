// Protruded displacement mapping, vertex stage: a corner of a face in patch space goes to world, view and clip space.
// `#version` and the #defines are put in front by displacement.py (ZERO_TO_ONE: the clip volume is 0 ≤ z ≤ w).

layout(std140, binding = 0) uniform Polygon {
    mat4 clip_from_view;
    mat4 view_from_world;
    mat4 clip_from_patch;
    vec4 corner;
    vec4 edge_u;
    vec4 edge_v;
    vec4 edge_h;
    vec4 reciprocal_u;
    vec4 reciprocal_v;
    vec4 unit_normal;
    vec4 eye_patch;
    vec4 light_patch;
    vec4 eye_world;
    vec4 light_world;
    vec4 lighting;
    vec4 background;
    vec4 sizes;
    vec4 search;
    ivec4 identity;
};

layout(location = 0) in vec3 in_patch;
layout(location = 1) in int in_face;

layout(location = 0) out vec3 patch_position;
layout(location = 1) flat out int face;
#ifdef CAPTURE
out vec4 clip;
#endif

void main() {
    vec3 world = corner.xyz + in_patch.x * edge_u.xyz + in_patch.y * edge_v.xyz + in_patch.z * edge_h.xyz;
    vec4 position = clip_from_view * (view_from_world * vec4(world, 1.0));
    patch_position = in_patch;
    face = in_face;
#ifdef CAPTURE
    clip = position;
#endif
    position.y = -position.y;  // row 0 of the image is the top one
#ifndef ZERO_TO_ONE
    position.z = 2.0 * position.z - position.w;
#endif
    gl_Position = position;
}
