// Searches below the polygon, which is the top of the volume; displacement.py puts it into displacement.frag.
//   RELIEF, MCGUIRE, TATARCHUK, WELSH, CONE, RELAXED_CONE, DONNELLY,
//   MAXIMUM_MIPMAP      one of them is defined
//   MIN_STEPS, MAX_STEPS      of TATARCHUK

#if defined(MAXIMUM_MIPMAP)
layout(binding = 4) uniform sampler2D quadtree;      // levels, one below the other
#elif defined(DONNELLY)
layout(binding = 4) uniform sampler3D distance_map;
#else
layout(binding = 4) uniform sampler2D cone_map;
#endif

bool on_map(vec2 uv) {
#ifdef REPEAT
    return true;
#else
    return all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0)));
#endif
}

/** World length of the view ray from depth 1 up to the polygon. */
float ray_length(vec2 along) {
    return length(along.x * edge_u.xyz + along.y * edge_v.xyz + edge_h.xyz);
}

#if defined(MAXIMUM_MIPMAP)
/** d - D. */
float below_surface(vec2 uv, vec2 along, float d) {
    return d - (1.0 - height(uv - along * d));
}

/** Depth at which the ray meets the bilinear patch between two depths; 2 if it does not. */
float patch_hit(vec2 uv, vec2 along, float first, float last) {
    float start = below_surface(uv, along, first);
    if (start > 0.0) return first;
    float middle = below_surface(uv, along, 0.5 * (first + last));
    float end = below_surface(uv, along, last);
    float bend = 2.0 * (end - 2.0 * middle + start);
    float rise = end - start - bend;
    float inner = rise * rise - 4.0 * bend * start;
    bool apex = bend < 0.0 && rise > 0.0 && rise < -2.0 * bend && inner > 0.0;
    if (!(end > 0.0 || apex)) return 2.0;
    float root = sqrt(max(0.0, inner));
    float share = rise >= 0.0 ? -2.0 * start / (rise + root) : (root - rise) / (2.0 * bend);
    return first + clamp(share, 0.0, 1.0) * (last - first);
}

/** The largest height of a node. */
float highest(ivec2 cells, ivec2 node, int level) {
    int row = node.y;
    for (int i = 0; i < level; ++i) row += (cells.y + (1 << i) - 1) >> i;
    return texelFetch(quadtree, ivec2(node.x, row), 0).r;
}

/** Depth of the first intersection; without one 1 where the ray reaches the bottom, else 2. */
float first_hit(vec2 uv, vec2 along) {
    vec2 size = vec2(textureSize(height_map, 0));
#ifdef REPEAT
    ivec2 cells = textureSize(height_map, 0);
    vec2 x = uv * size - 0.5;
    ivec2 cell = ivec2(floor(x));
#else
    ivec2 cells = textureSize(height_map, 0) + 1;
    vec2 x = uv * size + 0.5;
    ivec2 cell = clamp(ivec2(floor(x)), ivec2(0), cells - 1);
#endif
    vec2 dx = -along * size;
    bvec2 ahead = greaterThan(dx, vec2(0.0));
    float last = 1.0;
#ifndef REPEAT
    vec2 leaves = abs((vec2(ahead) - uv) / along);
    last = min(1.0, min(leaves.x, leaves.y));
#endif
    int top = 0;
    while ((1 << top) < max(cells.x, cells.y)) ++top;
    int level = top;
    float d = 0.0;
    for (int i = 0; i < 4096; ++i) {
        ivec2 inside = (cell + 4096 * cells) % cells;      // cells repeat; no remainder of a negative number is defined
        ivec2 node = inside >> level;
        ivec2 begin = cell - inside + (node << level);
        ivec2 stop = cell - inside + min((node + 1) << level, cells);
        float above = 1.0 - highest(cells, node, level);
        vec2 exits = (mix(vec2(begin), vec2(stop), vec2(ahead)) - x) / dx;
        float out_of = max(d, min(min(exits.x, exits.y), last));
        bool passes = above >= out_of;
        if (!passes && level > 0) {
            if (above > d) {
                d = above;
                cell = clamp(ivec2(floor(x + dx * d)), begin, stop - 1);
            }
            --level;
            continue;
        }
        if (!passes) {
            float hit = patch_hit(uv, along, d, out_of);
            if (hit <= 1.0) return hit;
        }
        if (!(out_of < last)) break;
        d = out_of;
        cell = clamp(ivec2(floor(x + dx * d)), begin, stop - 1);
        if (exits.x <= d) cell.x = ahead.x ? stop.x : begin.x - 1;
        if (exits.y <= d) cell.y = ahead.y ? stop.y : begin.y - 1;
        level = min(level + 1, top);
    }
    return last == 1.0 ? 1.0 : 2.0;
}
#elif defined(DONNELLY)
/** Depth after all steps through the distance map, along the unit ray. */
float traced(vec2 uv, vec2 along) {
    float ray = length(vec3(along, 1.0));
    float d = 0.0;
    for (int i = 0; i < LINEAR_STEPS; ++i) d += textureLod(distance_map, vec3(uv - along * d, d), 0.0).r / ray;
    return min(d, 1.0);
}
#else
/** Depth after all cone steps. */
float cone_steps(vec2 uv, vec2 along) {
    float speed = length(along);
    float d = 0.0;
    for (int i = 0; i < LINEAR_STEPS; ++i) {
        vec2 at = uv - along * d;
        float ratio = textureLod(cone_map, at, 0.0).r;
        d += ratio * max(0.0, 1.0 - height(at) - d) / (speed + ratio);
    }
    return d;
}
#endif

Hit march(vec3 c) {
    vec3 v = eye_patch.xyz - eye_patch.w * c;
    vec2 along = v.xy / v.z;
    Hit hit = Hit(false, vec3(c.xy, 0.0), -1.0, -1.0, 0.0, false);
    if (!(v.z > 0.0)) return hit;
    float d = 0.0;
    float before = 0.0;
    float step = -1.0;
    float index = -1.0;
#if defined(RELIEF)
    float last = 0.0;
    for (int i = 0; i <= LINEAR_STEPS && step < 0.0; ++i) {
        vec2 at = c.xy - along * (float(i) * STEP);
        float here = on_map(at) ? height(at) : 0.0;
        if (on_map(at) && float(i) * STEP >= 1.0 - here) {
            step = float(i);
            before = last;
        }
        last = here;
    }
    index = step * FINE;
    if (step > 0.0) {
        for (float half_bracket = 0.5 * FINE; half_bracket >= 1.0; half_bracket *= 0.5) {
            float middle = (index - half_bracket) / LATTICE;
            vec2 at = c.xy - along * middle;
            if (on_map(at) && middle >= 1.0 - height(at)) index -= half_bracket;
        }
    }
    d = index / LATTICE;
#elif defined(MCGUIRE)
    float count = floor(mix(2.0 * float(LINEAR_STEPS), float(LINEAR_STEPS), search.x / ray_length(along)) + 0.5);
    float last = 0.0;
    for (float k = 0.0; k <= count; k += 1.0) {
        vec2 at = c.xy - along * (k / count);
        if (!on_map(at)) break;
        float here = height(at);
        if (k / count >= 1.0 - here) {
            step = k;
            before = last;
            break;
        }
        last = here;
    }
    index = step;
    d = step / count;
#elif defined(TATARCHUK)
    float count = floor(mix(float(MAX_STEPS), float(MIN_STEPS), search.x / ray_length(along)));
    float last = 1.0;
    step = count;
    d = 1.0;
    for (float k = 1.0; k <= count; k += 1.0) {
        float ray = 1.0 - k / count;
        vec2 at = c.xy - along * (1.0 - ray);
        if (!on_map(at)) break;
        float here = height(at);
        if (here > ray) {
            float ray_before = 1.0 - (k - 1.0) / count;
            float over = ray_before - last;
            float under = here - ray;
            step = k;
            before = last;
            d = 1.0 - (ray * over + ray_before * under) / (over + under);
            break;
        }
        last = here;
    }
    index = step;
#elif defined(WELSH)
    step = 0.0;
    index = 0.0;
    hit.position.xy += height(c.xy) * search.x * along / ray_length(along);
#elif defined(MAXIMUM_MIPMAP)
    d = first_hit(c.xy, along);
    if (!(d <= 1.0)) return hit;
    step = 0.0;
    index = 0.0;
#elif defined(DONNELLY)
    step = float(LINEAR_STEPS);
    index = step;
    d = traced(c.xy, along);
#else
    step = float(LINEAR_STEPS);
    index = step;
    d = cone_steps(c.xy, along);
#if defined(RELAXED_CONE) && BINARY_STEPS > 0
    float stretch = 0.5 * d;
    d = stretch;
    for (int i = 0; i < BINARY_STEPS; ++i) {
        stretch *= 0.5;
        vec2 at = c.xy - along * d;
        d += on_map(at) && d >= 1.0 - height(at) ? -stretch : stretch;
    }
#endif
#endif
#ifndef WELSH
    hit.position = vec3(c.xy - along * d, -d);
#endif
    hit.found = step >= 0.0 && on_map(hit.position.xy);
    hit.linear_index = step;
    hit.hit_index = index;
    hit.before = before;
    return hit;
}
