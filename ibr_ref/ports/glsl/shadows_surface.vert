// Shadows by image warping: receivers and caster as the camera sees them. `#version` and the #defines are put in front.

uniform mat4 clip_from_view;
uniform mat4 view_from_world;
uniform vec3 offset;

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec3 in_color;
layout(location = 3) in float in_caster;  // 1: moves by the offset

out vec3 world;
out vec3 color;
flat out vec3 normal;
flat out float caster;

void main() {
    world = in_position + in_caster * offset;
    color = in_color;
    normal = in_normal;
    caster = in_caster;
    vec4 position = clip_from_view * (view_from_world * vec4(world, 1.0));
    position.y = -position.y;  // row 0 of the picture is the top one
#ifndef ZERO_TO_ONE
    position.z = 2.0 * position.z - position.w;
#endif
    gl_Position = position;
}
