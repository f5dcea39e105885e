// Shapes on a plane, whose normal is its z axis. CPU counterpart: `clench-collide/src/narrow/plane.rs`. Loops have one
// call that adds a contact, as drivers inline it.

// Adds a point of a surface `distance` above the plane.
fn add_on_plane(pair: u32, surface: vec3f, distance: f32, normal: vec3f, tangent: vec3f, range: f32) {
    if (distance <= range) {
        add_contact(pair, distance, surface - normal * (distance * 0.5), normal, tangent);
    }
}

fn plane_sphere(pair: u32, normal: vec3f, above: f32, center: vec3f, size: vec3f, range: f32) {
    let surface = center - normal * size.x;
    add_on_plane(pair, surface, above - size.x, normal, tangent_from_normal(normal), range);
}

// Adds the two ends of a capsule, the first tangent along its axis.
fn plane_capsule(pair: u32, normal: vec3f, above: f32, center: vec3f, axis: vec3f, size: vec3f, range: f32) {
    let rise = dot(normal, axis) * size.y;
    let tangent = tangent_along(normal, axis);
    let middle = center - normal * size.x;
    for (var k = 0u; k < bound(2u); k++) {
        let side = select(f32(1.0), f32(-1.0), k == 1u);
        add_on_plane(pair, middle + axis * (size.y * side), above + rise * side - size.x, normal, tangent, range);
    }
}

// Adds the lowest point of an ellipsoid: its support point opposite to the normal.
fn plane_ellipsoid(pair: u32, normal: vec3f, above: f32, center: vec3f, axes: mat3x3f, size: vec3f, range: f32) {
    let scaled = (transpose(axes) * normal) * size;
    let depth = length(scaled);
    let support = scaled * size * (1.0 / max(depth, SMALLEST));
    add_on_plane(pair, center - axes * support, above - depth, normal, tangent_from_normal(normal), range);
}

// Adds the lowest points of both rims, then two more on the lower rim, so that the three there form a regular triangle.
fn plane_cylinder(pair: u32, normal: vec3f, above: f32, center: vec3f, axes: mat3x3f, size: vec3f, range: f32) {
    let up = axes[2];
    let cosine = dot(normal, up);
    let axis = select(up, -up, cosine > 0.0) * size.y;
    let axis_rise = -abs(cosine) * size.y;
    let steepest = up * cosine - normal;
    let steepness = length(steepest);
    var spoke = axes[0] * size.x;
    if (steepness >= TINY) {
        spoke = steepest * (size.x / steepness);
    }
    let spoke_rise = dot(spoke, normal);
    let lowest = above + axis_rise + spoke_rise;
    if (lowest > range) {
        return;
    }
    let tangent = tangent_from_normal(normal);
    let flank = above + axis_rise - spoke_rise * 0.5;
    let sideways = direction(cross(spoke, axis)).xyz * (size.x * 0.8660254037844386);
    let middle = center + axis - spoke * 0.5;
    for (var k = 0u; k < bound(4u); k++) {
        var surface = middle + select(sideways, -sideways, k == 3u);
        var distance = flank;
        if (k == 0u) {
            surface = center + axis + spoke;
            distance = lowest;
        } else if (k == 1u) {
            surface = center - axis + spoke;
            distance = above - axis_rise + spoke_rise;
        }
        add_on_plane(pair, surface, distance, normal, tangent, range);
    }
}

// Adds the corners of a box on its lower side, at most four.
fn plane_box(pair: u32, normal: vec3f, above: f32, center: vec3f, axes: mat3x3f, size: vec3f, range: f32) {
    let local = (transpose(axes) * normal) * size;
    let tangent = tangent_from_normal(normal);
    var count = 0u;
    for (var corner = 0u; corner < 8u; corner++) {
        let bits = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let signs = vec3f(bits) * 2.0 - 1.0;
        let rise = dot(local, signs);
        if (above + rise <= range && rise <= 0.0 && count < 4u) {
            count++;
            add_on_plane(pair, center + axes * (size * signs), above + rise, normal, tangent, range);
        }
    }
}
