// Definitions that depend on the precision: this file is for double precision, `elementary.wgsl` for single. In double
// precision devices have no functions beyond roots. These are the counterparts of `clench-math`'s `elementary`, with
// the same coefficients, accurate to some roundings.

const EPSILON = 2.220446049250313e-16;
const ROOT_OF_EPSILON = 1.4901161193847656e-8;
const SMALLEST = 2.2250738585072014e-308;
// Returns true if a number is infinite, NaN, or beyond single precision, like no number of a motion. It tests the bits
// in that, because shader compilers may assume that there are none.
fn is_wild(x: f64) -> bool {
    return (bitcast<u32>(f32(x)) & 0x7f800000u) == 0x7f800000u;
}

// Returns true if all bits of a number are zero: −0 is not blank.
fn is_blank(x: f64) -> bool {
    return x == 0.0 && bitcast<u32>(f32(x)) == 0u;
}

// Returns sine and cosine, by Cody and Waite's reduction to a quarter turn and minimax polynomials.
fn sin_cos(x: f64) -> vec2<f64> {
    let quarters = round(x * 0.6366197723675814);
    var y = x - quarters * 1.5707963267341256;
    y = y - quarters * 6.077100506303966e-11;
    y = y - quarters * 2.0222662487959506e-21;
    let z = y * y;
    var s = -2.505075863080562e-08 + z * 1.5896826608749683e-10;
    s = -0.00019841269829816538 + z * (2.7557313695083844e-06 + z * s);
    s = -0.16666666666666632 + z * (0.008333333333322424 + z * s);
    var c = 2.0875723671699116e-09 - z * 1.1359669172594054e-11;
    c = 2.4801587289491536e-05 + z * (-2.75573143551531e-07 + z * c);
    c = 0.0416666666666666 + z * (-0.0013888888888874138 + z * c);
    let sine = y + z * y * s;
    let cosine = 1.0 - 0.5 * z + z * z * c;
    let quadrant = i32(quarters) & 3;
    if (quadrant == 0) {
        return vec2<f64>(sine, cosine);
    }
    if (quadrant == 1) {
        return vec2<f64>(cosine, -sine);
    }
    if (quadrant == 2) {
        return vec2<f64>(-sine, -cosine);
    }
    return vec2<f64>(-cosine, sine);
}

// Returns the angle of the point (x, y) with y not negative, in [0, π].
fn angle_of(y: f64, x: f64) -> f64 {
    let steep = y > abs(x);
    let small = select(y, abs(x), steep);
    let large = max(select(abs(x), y, steep), SMALLEST);
    let folded = small > large * 0.41421356237309503;
    let t = select(small, small - large, folded) / select(large, small + large, folded);
    let z = t * t;
    var p = 0.03807829695962818 - z * 0.017922250281083824;
    p = 0.05848008760777935 + z * (-0.050398446792522485 + z * p);
    p = 0.07692061636187414 + z * (-0.06663120367352943 + z * p);
    p = 0.11111110786139128 + z * (-0.09090897836434896 + z * p);
    p = 0.19999999999954082 + z * (-0.14285714280248585 + z * p);
    p = -0.333333333333332 + z * p;
    let arc = t + t * z * p;
    var angle = select(arc, arc + 0.7853981633974483, folded);
    angle = select(angle, HALF_PI - angle, steep);
    return select(angle, PI - angle, x < 0.0);
}

// Returns 2 to an integer power within ±1100.
fn power_of_two(exponent: i32) -> f64 {
    var result = f64(1.0);
    var base = select(f64(2.0), f64(0.5), exponent < 0);
    for (var left = u32(abs(exponent)); left > 0u; left >>= 1u) {
        if ((left & 1u) == 1u) {
            result *= base;
        }
        base *= base;
    }
    return result;
}

// Computes eˣ = 2ᵏ eʳ with x = k ln 2 + r and |r| ≤ ½ ln 2.
fn exponential(x: f64) -> f64 {
    let bounded = clamp(x, -745.0, 710.0);
    let k = round(bounded * 1.4426950408889634);
    let r = (bounded - k * 0.6931471805598903) - k * 5.497923018708371e-14;
    var p = 2.7631266561974415e-07 + r * 2.5117843735792646e-08;
    p = 2.480148997826072e-05 + r * (2.7557216358932284e-06 + r * p);
    p = 0.001388888894698388 + r * (0.00019841269917314874 + r * p);
    p = 0.04166666666651553 + r * (0.008333333333307238 + r * p);
    p = 0.5000000000000012 + r * (0.166666666666667 + r * p);
    let half = i32(k) / 2;
    return (1.0 + (r + r * r * p)) * power_of_two(half) * power_of_two(i32(k) - half);
}

// Returns the natural logarithm of a positive number: x = 2ᵏ m with m in [√½, √2), and ln m = 2 artanh s with s = (m −
// 1)/(m + 1).
fn logarithm(x: f64) -> f64 {
    var m = x;
    var k = 0;
    // Scales into single precision, whose bits are accessible.
    // The smallest and the largest numbers take 34 iterations.
    for (var iteration = 0u; iteration < 34u && m < 2.3283064365386963e-10; iteration++) {
        m *= 4294967296.0;
        k -= 32;
    }
    for (var iteration = 0u; iteration < 34u && m > 4294967296.0; iteration++) {
        m *= 2.3283064365386963e-10;
        k += 32;
    }
    let exponent = i32(bitcast<u32>(f32(m)) >> 23u) - 127;
    m *= power_of_two(-exponent);
    k += exponent;
    if (m > 1.4142135623730951) {
        m *= 0.5;
        k += 1;
    }
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    var p = 0.11674836346811365 + z * 0.11988864589335137;
    p = 0.153845568938563 + z * (0.1333631653996441 + z * p);
    p = 0.22222222217539195 + z * (0.18181818869979532 + z * p);
    p = 0.3999999999999998 + z * (0.285714285714451 + z * p);
    let ln_m = s * (2.0 + z * (0.6666666666666666 + z * p));
    return f64(k) * 0.6931471805598903 + (ln_m + f64(k) * 5.497923018708371e-14);
}

// Returns a power of a non-negative base.
fn power_of(base: f64, exponent: f64) -> f64 {
    if (!(base > 0.0)) {
        return select(f64(0.0), f64(1.0), exponent == 0.0);
    }
    return exponential(exponent * logarithm(base));
}

// Returns the bits of a number in reports: in single precision.
fn report_bits(x: f64) -> u32 {
    return bitcast<u32>(f32(x));
}
