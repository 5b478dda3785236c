// Shadows by image warping, method "grid": the map between the four around an object's place, or the nearest of them.

layout(binding = 0) uniform sampler2D m00;
layout(binding = 1) uniform sampler2D m10;
layout(binding = 2) uniform sampler2D m01;
layout(binding = 3) uniform sampler2D m11;
uniform vec2 fraction;  // s, t
uniform int mixed;

layout(location = 0) out float texel;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 share = mixed == 1 ? fraction : vec2(greaterThanEqual(fraction, vec2(0.5)));
    float top = mix(texelFetch(m00, at, 0).r, texelFetch(m10, at, 0).r, share.x);
    float bottom = mix(texelFetch(m01, at, 0).r, texelFetch(m11, at, 0).r, share.x);
    texel = mix(top, bottom, share.y);
}
