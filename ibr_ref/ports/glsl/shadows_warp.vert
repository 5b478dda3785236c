// Shadows by image warping, stage 3: a control mesh. Texture coordinates are the points of the source's own grid, positions
// those of the grid in between. A pass warps two images to the same mesh and mixes them, so it needs one mesh only.
// COLUMN: top and bottom to the object's place; otherwise a row: two neighbouring maps to a place between them.
// NEAREST: the nearer of the two is warped alone. CAPTURE: the mesh itself is handed back.

uniform vec3 shares;  // of the next map in the row (COLUMN: in the upper row, in the lower row), of the lower row

layout(location = 0) in vec2 in_a;  // of the row's first and second map; the top row's where COLUMN
layout(location = 1) in vec2 in_b;
#ifdef COLUMN
layout(location = 2) in vec2 in_c;  // the bottom row's
layout(location = 3) in vec2 in_d;
#endif

#ifdef CAPTURE
out vec2 place;
#else
noperspective out vec2 uv_first;
#ifndef NEAREST
noperspective out vec2 uv_second;
#endif
#endif

vec2 lerp(vec2 a, vec2 b, float f) {
    return a * (1.0 - f) + b * f;
}

void main() {
#ifdef COLUMN
    vec2 first = lerp(in_a, in_b, shares.x);
    vec2 second = lerp(in_c, in_d, shares.y);
    float share = shares.z;
#else
    vec2 first = in_a;
    vec2 second = in_b;
    float share = shares.x;
#endif
#ifdef CAPTURE
    place = lerp(first, second, share);
#else
#ifdef NEAREST
    uv_first = share < 0.5 ? first : second;
#else
    uv_first = first;
    uv_second = second;
#endif
#endif
    gl_Position = vec4(2.0 * lerp(first, second, share) - 1.0, 0.0, 1.0);  // v grows with the rows in memory
}
