// Definitions that depend on the precision: this file is for single precision, `elementary_double.wgsl` for double.
//
// The built-in sine and cosine of a device may be off by 5e-4 and differ between devices; these are accurate to
// rounding.

// The distance from 1 to the next number, its root, and the smallest normal number. They are untyped, so that the
// compiler computes products with them.
const EPSILON = 1.1920928955078125e-7;
const ROOT_OF_EPSILON = 3.4526698300124393e-4;
const SMALLEST = 1.1754943508222875e-38;

// Returns true if a number is infinite or NaN. It tests the bits, because shader compilers may assume that there are
// none.
fn is_wild(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) == 0x7f800000u;
}

// Returns true if all bits of a number are zero: −0 is not blank.
fn is_blank(x: f32) -> bool {
    return bitcast<u32>(x) == 0u;
}

// Returns sine and cosine, by Cody and Waite's reduction to a quarter turn and the minimax polynomials of
// `clench-math`.
fn sin_cos(x: f32) -> vec2f {
    let quarters = round(x * 0.63661977);
    var y = x - quarters * 1.5703125;
    y = y - quarters * 0.0004825592041015625;
    y = y - quarters * 1.2665987014770508e-06;
    y = y - quarters * 9.89530235528946e-10;
    let z = y * y;
    let sine = y + z * y * (-0.16666655 + z * (0.008332178 - z * 0.00019517296));
    let cosine = 1.0 - 0.5 * z + z * z * (0.041666646 + z * (-0.0013887367 + z * 2.4438449e-05));
    let quadrant = i32(quarters) & 3;
    if (quadrant == 0) {
        return vec2f(sine, cosine);
    }
    if (quadrant == 1) {
        return vec2f(cosine, -sine);
    }
    if (quadrant == 2) {
        return vec2f(-sine, -cosine);
    }
    return vec2f(-cosine, sine);
}

// Returns the angle of the point (x, y) with y not negative, in [0, π].
fn angle_of(y: f32, x: f32) -> f32 {
    let steep = y > abs(x);
    let small = select(y, abs(x), steep);
    let large = max(select(abs(x), y, steep), SMALLEST);
    let folded = small > large * 0.41421356;
    let t = select(small, small - large, folded) / select(large, small + large, folded);
    let z = t * t;
    let arc = t + t * z * (-0.33333316 + z * (0.19998489 + z * (-0.14243848 + z * (0.10595998 - z * 0.06083443))));
    var angle = select(arc, arc + 0.78539816, folded);
    angle = select(angle, HALF_PI - angle, steep);
    return select(angle, PI - angle, x < 0.0);
}

fn exponential(x: f32) -> f32 {
    return exp(x);
}

// Returns a power of a non-negative base.
fn power_of(base: f32, exponent: f32) -> f32 {
    return pow(base, exponent);
}

// Returns the bits of a number in reports: in single precision.
fn report_bits(x: f32) -> u32 {
    return bitcast<u32>(x);
}
