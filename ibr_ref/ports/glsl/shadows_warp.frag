// Shadows by image warping, stage 3: the fetch, of one image (NEAREST) or the mix of two.
// EXACT: the bilinear mix in float32; the sampler of a GPU may have 8 bits for its weights.

layout(binding = 0) uniform sampler2D first;
#ifndef NEAREST
layout(binding = 1) uniform sampler2D second;
uniform float share;

noperspective in vec2 uv_second;
#endif
noperspective in vec2 uv_first;

layout(location = 0) out float texel;

float fetch(sampler2D image, vec2 uv) {
#ifdef EXACT
    ivec2 last = textureSize(image, 0) - 1;
    vec2 place = uv * vec2(last + 1) - 0.5;
    vec2 corner = floor(place);
    vec2 f = place - corner;
    ivec2 low = clamp(ivec2(corner), ivec2(0), last);
    ivec2 high = clamp(ivec2(corner) + 1, ivec2(0), last);
    float top = mix(texelFetch(image, low, 0).r, texelFetch(image, ivec2(high.x, low.y), 0).r, f.x);
    float bottom = mix(texelFetch(image, ivec2(low.x, high.y), 0).r, texelFetch(image, high, 0).r, f.x);
    return mix(top, bottom, f.y);
#else
    return textureLod(image, uv, 0.0).r;
#endif
}

void main() {
#ifdef NEAREST
    texel = fetch(first, uv_first);
#else
    texel = mix(fetch(first, uv_first), fetch(second, uv_second), share);
#endif
}
