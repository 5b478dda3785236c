// Searches below the polygon, which is the top of the volume. displacement.py puts this behind displacement.wgsl, and SEARCH,
// MIN_STEPS, MAX_STEPS and DISTANCE_LAYERS in front of both.

@group(0) @binding(7) var search_map: texture_2d<f32>;      // cones; layers of distances or levels of a quadtree, one below the other

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

fn below_surface(uv: vec2f, along: vec2f, d: f32) -> f32 {
    return d - (1.0 - height(uv - along * d));
}

/// Depth at which the ray meets the bilinear patch between two depths; 2 if it does not.
fn patch_hit(uv: vec2f, along: vec2f, first: f32, last: f32) -> f32 {
    let start = below_surface(uv, along, first);
    if (start > 0.0) { return first; }
    let middle = below_surface(uv, along, 0.5 * (first + last));
    let end = below_surface(uv, along, last);
    let bend = 2.0 * (end - 2.0 * middle + start);
    let rise = end - start - bend;
    let inner = rise * rise - 4.0 * bend * start;
    let apex = bend < 0.0 && rise > 0.0 && rise < -2.0 * bend && inner > 0.0;
    if (!(end > 0.0 || apex)) { return 2.0; }
    let root = sqrt(max(0.0, inner));
    var share = -2.0 * start / (rise + root);
    if (rise < 0.0) { share = (root - rise) / (2.0 * bend); }
    return first + clamp(share, 0.0, 1.0) * (last - first);
}

/// The largest height of a node.
fn highest(cells: vec2i, node: vec2i, level: u32) -> f32 {
    var row = node.y;
    for (var i = 0u; i < level; i++) { row += (cells.y + (1 << i) - 1) >> i; }
    return textureLoad(search_map, vec2i(node.x, row), 0).x;
}

/// The first intersection, node by node; the bottom where there is none.
fn first_hit(uv: vec2f, along: vec2f) -> Hit {
    let size = vec2i(textureDimensions(height_map));
    let cells = select(size + 1, size, REPEAT);
    let x = uv * vec2f(size) + select(0.5, -0.5, REPEAT);
    let dx = -along * vec2f(size);
    let ahead = dx > vec2f(0.0);
    let leaves = abs((select(vec2f(0.0), vec2f(1.0), ahead) - uv) / along);
    let last = select(min(1.0, min(leaves.x, leaves.y)), 1.0, REPEAT);
    var cell = vec2i(floor(x));
    if (!REPEAT) { cell = clamp(cell, vec2i(0), cells - 1); }
    var top = 0u;
    while ((1 << top) < max(cells.x, cells.y)) { top++; }
    var level = top;
    var d = 0.0;
    for (var i = 0; i < 4096; i++) {
        let inside = (cell + 4096 * cells) % cells;
        let node = inside >> vec2u(level);
        let begin = cell - inside + (node << vec2u(level));
        let stop = cell - inside + min((node + 1) << vec2u(level), cells);
        let above = 1.0 - highest(cells, node, level);
        let exits = (select(vec2f(begin), vec2f(stop), ahead) - x) / dx;
        let out_of = max(d, min(min(exits.x, exits.y), last));
        let passes = above >= out_of;
        if (!passes && level > 0u) {
            if (above > d) {
                d = above;
                cell = clamp(vec2i(floor(x + dx * d)), begin, stop - 1);
            }
            level--;
            continue;
        }
        if (!passes) {
            let hit = patch_hit(uv, along, d, out_of);
            if (hit <= 1.0) { return hit_at(uv, along, hit, 0.0, 0.0, 0.0); }
        }
        if (!(out_of < last)) { break; }
        d = out_of;
        cell = clamp(vec2i(floor(x + dx * d)), begin, stop - 1);
        if (exits.x <= d) { cell.x = select(begin.x - 1, stop.x, ahead.x); }
        if (exits.y <= d) { cell.y = select(begin.y - 1, stop.y, ahead.y); }
        level = min(level + 1u, top);
    }
    if (last < 1.0) { return below(vec3f(uv, 0.0)); }
    return hit_at(uv, along, 1.0, 0.0, 0.0, 0.0);
}

fn march_below(c: vec3f) -> Hit {
    let v = p.eye_patch.xyz - p.eye_patch.w * c;
    if (!(v.z > 0.0)) { return below(vec3f(c.xy, 0.0)); }
    let along = v.xy / v.z;
    if (SEARCH == RELIEF) { return relief(c.xy, along); }
    if (SEARCH == MCGUIRE) { return steep_parallax(c.xy, along); }
    if (SEARCH == TATARCHUK) { return occlusion(c.xy, along); }
    if (SEARCH == WELSH) { return parallax(c.xy, along); }
    if (SEARCH == MAXIMUM_MIPMAP) { return first_hit(c.xy, along); }
    if (SEARCH == DONNELLY) { return traced(c.xy, along); }
    return cones(c.xy, along);
}
