// The search above the polygon; displacement.py puts it into displacement.frag.

/** The first and the last t at which origin + direction t is in the unit square. */
vec2 inside_square(vec2 origin, vec2 direction) {
    vec2 moving = mix(direction, vec2(1e-30), lessThan(abs(direction), vec2(1e-30)));
    vec2 t0 = -origin / moving;
    vec2 t1 = (1.0 - origin) / moving;
    vec2 enter = min(t0, t1);
    vec2 leave = max(t0, t1);
    return vec2(max(enter.x, enter.y), min(leave.x, leave.y));
}

#ifdef VOLUME
/** Where the way to c enters the volume; the eye itself, if that is inside. */
vec3 entry(vec3 c) {
    vec3 eye = eye_patch.xyz;
    if (eye_patch.w == 1.0 && eye == clamp(eye, 0.0, 1.0)) return eye;
    vec3 towards = eye - eye_patch.w * c;
    vec3 border = vec3(greaterThan(towards, vec3(0.0)));
    vec3 t = mix((border - c) / towards, vec3(1e30), equal(towards, vec3(0.0)));
    float nearest = min(min(t.x, t.y), t.z);
    vec3 place = c + towards * nearest;
    if (t.x == nearest) place.x = border.x;
    else if (t.y == nearest) place.y = border.y;
    else place.z = border.z;
    return place;
}
#endif

Hit march(vec3 c) {
    vec3 v = eye_patch.xyz - eye_patch.w * c;
#ifdef VOLUME
    vec3 start = entry(c);
    vec3 way = c - start;
    vec2 bottom = c.xy;
    bool searched = true;
#else
    vec2 bottom = c.xy - v.xy * (c.z / v.z);                        // A, at h = 0
    vec3 start = vec3(c.xy + v.xy * ((1.0 - c.z) / v.z), 1.0);      // B, at h = 1
    vec3 way = vec3(bottom - start.xy, -1.0);
    bool searched = v.z > 0.0;
#endif
#if defined(VOLUME) || defined(REPEAT)
    vec2 domain = vec2(0.0, 1.0);
#else
    vec2 domain = inside_square(start.xy, way.xy);
#endif
    float first = max(ceil(domain.x * float(LINEAR_STEPS)), 0.0);
    float last = min(floor(domain.y * float(LINEAR_STEPS)), float(LINEAR_STEPS));

#ifdef VOLUME
    float i = first;
#else
    float i = max(first, 1.0);                          // never at i = 0: h = 1
#endif
    float t = i * STEP;
    bool stopped = false;
    while (i <= last) {
        t = i * STEP;
        if (start.z + way.z * t < height(start.xy + way.xy * t)) {
            stopped = true;
            break;
        }
        i += 1.0;
    }

    float k = i * FINE;
#if BINARY_STEPS > 0
    float half_bracket = 0.5 * FINE;                    // the bracket is (k - 2 half_bracket, k]
    float stop_below = stopped ? 1.0 : FINE;            // a wave without a stop leaves after one round: it ignores k
    do {
        float middle = (k - half_bracket) * (1.0 / LATTICE);
        bool inside = middle >= domain.x && start.z + way.z * middle < height(start.xy + way.xy * middle);
        k = inside ? k - half_bracket : k;
        half_bracket *= 0.5;
    } while (half_bracket >= stop_below);
#endif

    Hit hit;
    t = k / LATTICE;
    bool above = stopped && k < LATTICE;                // a hit at k = K is the polygon itself
    bool ground = c.z == 0.0 && all(greaterThanEqual(c.xy, vec2(0.0))) && all(lessThanEqual(c.xy, vec2(1.0)));
    hit.position = above ? start + way * t : vec3(bottom, 0.0);
    hit.found = searched && (above || ground);
    hit.linear_index = above ? i : -1.0;
    hit.hit_index = above ? k : LATTICE;
    hit.before = 0.0;
    hit.steep = false;
#ifdef NEEDS_STEEP
    float before = height(start.xy + way.xy * ((i - 1.0) * STEP));
    hit.before = above && i - 1.0 >= first ? before : 0.0;
    hit.steep = above && hit.position.z - hit.before > STEEP_THRESHOLD;
#endif
    return hit;
}
