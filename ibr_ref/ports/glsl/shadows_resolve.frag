// Shadows by image warping, stage 6: the colour, with the shadow that was accumulated.

layout(binding = 0) uniform sampler2D places;
layout(binding = 1) uniform sampler2D surfaces;
layout(binding = 2) uniform sampler2D shadows;
uniform float ambient;
uniform vec3 background;

layout(location = 0) out vec4 result;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(surfaces, pixel, 0);
    float shadow = min(texelFetch(shadows, pixel, 0).r, 1.0);
    float light = ambient + (1.0 - ambient) * (1.0 - shadow) * surface.a;
    result = vec4(texelFetch(places, pixel, 0).w > 0.5 ? surface.rgb * light : background, 1.0);
}
