// Splatting by ellipses, fragment stage of both passes. See splatting.vert.
//   NEAREST     the first: number and distance of the nearest splat, through the depth test
//   otherwise   the second: those of its surface, to be added up (blending ONE, ONE)

layout(location = 0) flat in vec3 color;
layout(location = 1) flat in int splat;
layout(location = 3) flat in vec4 gaussian;
layout(location = 4) flat in vec3 conic;
layout(location = 5) flat in vec2 ends;

#ifdef NEAREST
layout(location = 0) out int out_splat;
layout(location = 1) out float out_distance;
layout(location = 2) out float out_depth;       // WebGL reads no depth buffer
#else
layout(binding = 2) uniform sampler2D nearest;
layout(location = 0) out vec4 out_sum;          // weighted colour, weight
layout(location = 1) out float out_count;
#endif

void main() {
    vec2 d = gl_FragCoord.xy - gaussian.xy;
    float q = conic.x * d.x * d.x + 2.0 * conic.y * d.x * d.y + conic.z * d.y * d.y;
    if (q > ends.x) discard;
#ifdef NEAREST
    out_splat = splat;
    out_distance = gaussian.w;
    out_depth = gl_FragCoord.z;
#else
    if (gaussian.w > ends.y * texelFetch(nearest, ivec2(gl_FragCoord.xy), 0).x) discard;
    float weight = gaussian.z * exp(-0.5 * q);
    out_sum = vec4(weight * color, weight);
    out_count = 1.0;
#endif
}
