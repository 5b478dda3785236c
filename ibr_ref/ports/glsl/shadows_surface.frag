// Shadows by image warping: what the later passes need of a fragment: its place, its colour, how much light may reach it.

uniform vec4 eye;    // w = 0: the direction towards it
uniform vec3 light;  // the centre

in vec3 world;
in vec3 color;
flat in vec3 normal;
flat in float caster;

layout(location = 0) out vec4 place;    // world position, 1 on receivers, 2 on the caster
layout(location = 1) out vec4 surface;  // colour, max(0, n . l)
#ifdef DEPTH_TOO
layout(location = 2) out float depth;   // WebGL reads no depth buffer
#endif

void main() {
    vec3 to_light = normalize(light - world);
    float side = dot(normal, eye.xyz - eye.w * world) < 0.0 ? -1.0 : 1.0;
    place = vec4(world, 1.0 + caster);
    surface = vec4(color, max(0.0, side * dot(normal, to_light)));
#ifdef DEPTH_TOO
    depth = gl_FragCoord.z;
#endif
}
