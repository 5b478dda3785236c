// Shadows by image warping, stage 1: the share of covered samples, of a mask with k x k times as many texels.

layout(binding = 0) uniform sampler2D mask;
uniform int samples;  // k

layout(location = 0) out float texel;

void main() {
    ivec2 corner = samples * ivec2(gl_FragCoord.xy);
    float covered = 0.0;
    for (int row = 0; row < samples; ++row)
        for (int column = 0; column < samples; ++column)
            covered += texelFetch(mask, corner + ivec2(column, row), 0).r;
    texel = covered / float(samples * samples);
}
