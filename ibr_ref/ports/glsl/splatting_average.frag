// Splatting by ellipses, last pass: the sums of the second become averages.

layout(binding = 0) uniform sampler2D sums;     // weighted colour, weight
uniform vec4 background;

layout(location = 0) out vec4 out_color;

void main() {
    vec4 sum = texelFetch(sums, ivec2(gl_FragCoord.xy), 0);
    out_color = sum.w > 0.0 ? vec4(min(sum.rgb / sum.w, 1.0), 1.0) : background;
}
