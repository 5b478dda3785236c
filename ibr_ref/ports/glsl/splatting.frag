// Splatting of depth images, fragment stage: the splat's colour. See splatting.vert.

layout(location = 0) flat in vec3 color;
#ifdef STAGES
layout(location = 1) flat in int splat;
#endif
#ifdef DISC
layout(location = 2) flat in vec3 disc;
#endif

layout(location = 0) out vec4 out_color;
#ifdef STAGES
layout(location = 1) out int out_splat;
#endif
#ifdef DEPTH_TOO
layout(location = 2) out float out_depth;       // WebGL reads no depth buffer
#endif

void main() {
#ifdef DISC
    vec2 off = gl_FragCoord.xy - disc.xy;
    if (off.x * off.x + off.y * off.y > disc.z) discard;
#endif
    out_color = vec4(color, 1.0);
#ifdef STAGES
    out_splat = splat;
#endif
#ifdef DEPTH_TOO
    out_depth = gl_FragCoord.z;
#endif
}
