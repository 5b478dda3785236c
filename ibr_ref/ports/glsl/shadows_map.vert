// Shadows by image warping, stage 1: the caster at an offset, seen from a light sample. Put in front by shadow_maps.py:
// `#version` and the #defines (ZERO_TO_ONE: the clip volume is 0 <= z <= w).

uniform mat4 clip_from_view;
uniform mat4 view_from_world;
uniform vec3 offset;

layout(location = 0) in vec3 in_position;

void main() {
    vec4 position = clip_from_view * (view_from_world * vec4(in_position + offset, 1.0));
    position.y = -position.y;  // row 0 of the map is the top one
#ifndef ZERO_TO_ONE
    position.z = 2.0 * position.z - position.w;
#endif
    gl_Position = position;
}
