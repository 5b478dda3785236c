// What Phong's light is made of; the ports put EXPONENT in front.

fn unit(a: vec3f) -> vec3f {
    let square = dot(a, a);
    return select(a, a / sqrt(square), square > 0.0);
}

/// base to the power EXPONENT by repeated squaring.
fn power(number: f32) -> f32 {
    var base = number;
    var result = 1.0;
    for (var e = EXPONENT; e > 0; e >>= 1u) {
        if ((e & 1) == 1) { result *= base; }
        base *= base;
    }
    return result;
}
