// Searches below the polygon, which is the top of the volume. displacement.py puts this behind displacement.wgsl, and SEARCH,
// MIN_STEPS, MAX_STEPS and DISTANCE_LAYERS in front of both.

@group(0) @binding(7) var search_map: texture_2d<f32>;      // cones, or layers of distances, one below the other

fn on_map(uv: vec2f) -> bool {
    return REPEAT || (all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0)));
}

/// World length of the view ray from depth 1 up to the polygon.
fn ray_length(along: vec2f) -> f32 {
    return length(along.x * p.edge_u.xyz + along.y * p.edge_v.xyz + p.edge_h.xyz);
}

fn below(position: vec3f) -> Hit {
    return Hit(false, position, -1.0, -1.0, 0.0, false);
}

/// A hit at depth d after so many steps.
fn hit_at(c: vec2f, along: vec2f, d: f32, step: f32, index: f32, before: f32) -> Hit {
    let uv = c - along * d;
    return Hit(on_map(uv), vec3f(uv, -d), step, index, before, false);
}

fn relief(c: vec2f, along: vec2f) -> Hit {
    var before = 0.0;
    var index = -1.0;
    var step = 0;
    for (; step <= LINEAR_STEPS; step++) {
        let d = f32(step) / f32(LINEAR_STEPS);
        let at = c - along * d;
        let here = height(at);
        if (on_map(at) && d >= 1.0 - here) {
            index = f32(step) * FINE;
            break;
        }
        before = select(0.0, here, on_map(at));
    }
    if (index < 0.0) { return below(vec3f(c, 0.0)); }
    var half_bracket = 0.5 * FINE;
    while (step > 0 && half_bracket >= 1.0) {
        let d = (index - half_bracket) / LATTICE;
        let at = c - along * d;
        if (on_map(at) && d >= 1.0 - height(at)) { index -= half_bracket; }
        half_bracket *= 0.5;
    }
    return hit_at(c, along, index / LATTICE, f32(step), index, before);
}

fn steep_parallax(c: vec2f, along: vec2f) -> Hit {
    let most = 2.0 * f32(LINEAR_STEPS);
    let count = floor(mix(most, f32(LINEAR_STEPS), p.search.x / ray_length(along)) + 0.5);
    var before = 0.0;
    for (var k = 0.0; k <= count; k += 1.0) {
        let at = c - along * (k / count);
        if (!on_map(at)) { break; }
        let here = height(at);
        if (k / count >= 1.0 - here) { return hit_at(c, along, k / count, k, k, before); }
        before = here;
    }
    return below(vec3f(c, 0.0));
}

fn occlusion(c: vec2f, along: vec2f) -> Hit {
    let count = floor(mix(f32(MAX_STEPS), f32(MIN_STEPS), p.search.x / ray_length(along)));
    var before = 1.0;
    for (var k = 1.0; k <= count; k += 1.0) {
        let ray = 1.0 - k / count;
        let at = c - along * (1.0 - ray);
        if (!on_map(at)) { break; }
        let here = height(at);
        if (here > ray) {
            let ray_before = 1.0 - (k - 1.0) / count;
            let over = ray_before - before;
            let under = here - ray;
            let d = 1.0 - (ray * over + ray_before * under) / (over + under);
            return hit_at(c, along, d, k, k, before);
        }
        before = here;
    }
    return hit_at(c, along, 1.0, count, count, 0.0);
}

fn parallax(c: vec2f, along: vec2f) -> Hit {
    let uv = c + height(c) * p.search.x * along / ray_length(along);
    return Hit(on_map(uv), vec3f(uv, 0.0), 0.0, 0.0, 0.0, false);
}

fn cones(c: vec2f, along: vec2f) -> Hit {
    let speed = length(along);
    var d = 0.0;
    for (var i = 0; i < LINEAR_STEPS; i++) {
        let at = c - along * d;
        let ratio = fetch(search_map, at, REPEAT).x;
        d += ratio * max(0.0, 1.0 - height(at) - d) / (speed + ratio);
    }
    if (SEARCH == RELAXED_CONE && BINARY_STEPS > 0) {
        var stretch = 0.5 * d;
        d = stretch;
        for (var i = 0; i < BINARY_STEPS; i++) {
            stretch *= 0.5;
            let at = c - along * d;
            d += select(stretch, -stretch, on_map(at) && d >= 1.0 - height(at));
        }
    }
    return hit_at(c, along, d, f32(LINEAR_STEPS), f32(LINEAR_STEPS), 0.0);
}

/// A layer of the distance map, bilinear; clamped.
fn layer_of_distances(number: i32, uv: vec2f) -> f32 {
    let size = vec2i(textureDimensions(search_map)) / vec2i(1, DISTANCE_LAYERS);
    let first = clamp(number, 0, DISTANCE_LAYERS - 1) * size.y;
    let at = uv * vec2f(size) - 0.5;
    let corner = floor(at);
    let f = at - corner;
    let low = vec2i(clamp(corner, vec2f(-1e6), vec2f(1e6)));
    let x = vec2i(wrapped(low.x, size.x, REPEAT), wrapped(low.x + 1, size.x, REPEAT));
    let y = first + vec2i(wrapped(low.y, size.y, REPEAT), wrapped(low.y + 1, size.y, REPEAT));
    let top = mix(textureLoad(search_map, vec2i(x.x, y.x), 0).x, textureLoad(search_map, vec2i(x.y, y.x), 0).x, f.x);
    let bottom = mix(textureLoad(search_map, vec2i(x.x, y.y), 0).x, textureLoad(search_map, vec2i(x.y, y.y), 0).x, f.x);
    return mix(top, bottom, f.y);
}

fn traced(c: vec2f, along: vec2f) -> Hit {
    let ray = length(vec3f(along, 1.0));
    var d = 0.0;
    for (var i = 0; i < LINEAR_STEPS; i++) {
        let at = c - along * d;
        let layer = d * f32(DISTANCE_LAYERS) - 0.5;
        let above = floor(layer);
        d += mix(layer_of_distances(i32(above), at), layer_of_distances(i32(above) + 1, at), layer - above) / ray;
    }
    return hit_at(c, along, min(d, 1.0), f32(LINEAR_STEPS), f32(LINEAR_STEPS), 0.0);
}

fn march_below(c: vec3f) -> Hit {
    let v = p.eye_patch.xyz - p.eye_patch.w * c;
    if (!(v.z > 0.0)) { return below(vec3f(c.xy, 0.0)); }
    let along = v.xy / v.z;
    if (SEARCH == RELIEF) { return relief(c.xy, along); }
    if (SEARCH == MCGUIRE) { return steep_parallax(c.xy, along); }
    if (SEARCH == TATARCHUK) { return occlusion(c.xy, along); }
    if (SEARCH == WELSH) { return parallax(c.xy, along); }
    if (SEARCH == DONNELLY) { return traced(c.xy, along); }
    return cones(c.xy, along);
}
