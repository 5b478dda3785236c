// Shadows by image warping, stage 1: the silhouette (1), or with DEPTH the window depth.

layout(location = 0) out float texel;

void main() {
#ifdef DEPTH
    texel = gl_FragCoord.z;
#else
    texel = 1.0;
#endif
}
