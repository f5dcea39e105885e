// Camera projection: the image position of a site, and the line of sight of a pixel. CPU counterpart:
// `sensor/camera.rs`.

// A half line with a unit direction.
struct Line {
    origin: vec3f,
    along: vec3f,
}

fn resolution(camera: u32) -> vec2f {
    return vec2f(f32(words[camera + CAMERA_WIDTH]), f32(words[camera + CAMERA_HEIGHT]));
}

// Returns the size of a pixel at unit distance, the inverse of the focal lengths in pixels.
fn size_of_pixel(c: u32) -> vec2f {
    let camera = CAMERAS + CAMERA_SIZE * c;
    if (words[camera + CAMERA_INTRINSIC] == 1u) {
        let sensor = vec2f(parameter(CAM_SENSORSIZE + 2u * c), parameter(CAM_SENSORSIZE + 2u * c + 1u));
        return sensor / (parameter4(CAM_INTRINSIC + 4u * c).xy * resolution(camera));
    }
    let half = sin_cos(parameter(CAM_FOVY + c) * (PI / 360.0));
    return vec2f(2.0 * half.x / (half.y * resolution(camera).y));
}

// Returns the image position of a site, in pixels from the upper left corner.
fn project(site: u32, c: u32) -> vec2f {
    let position = fetch3(SITE_XPOS + 3u * site) - fetch3(CAM_XPOS + 3u * c);
    let p = position * fetch_matrix(CAM_XMAT + 9u * c);
    let z = select(max(p.z, TINY), min(p.z, -TINY), p.z < 0.0);
    let offset = vec2f(-p.x, p.y) / (z * size_of_pixel(c));
    return 0.5 * resolution(CAMERAS + CAMERA_SIZE * c) + offset;
}

// Returns the image position of the optical axis.
fn optical_axis(c: u32) -> vec2f {
    let camera = CAMERAS + CAMERA_SIZE * c;
    if (words[camera + CAMERA_INTRINSIC] == 1u && words[camera + CAMERA_ORTHOGRAPHIC] == 0u) {
        let sensor = vec2f(parameter(CAM_SENSORSIZE + 2u * c), parameter(CAM_SENSORSIZE + 2u * c + 1u));
        return parameter4(CAM_INTRINSIC + 4u * c).zw / sensor * resolution(camera);
    }
    return 0.5 * resolution(camera);
}

// Returns the line of sight through the centre of a pixel; pixels are counted line by line from the upper left corner.
fn line_of_sight(c: u32, pixel: u32) -> Line {
    let camera = CAMERAS + CAMERA_SIZE * c;
    let width = words[camera + CAMERA_WIDTH];
    let middle = vec2f(f32(pixel % width), f32(pixel / width)) + 0.5;
    let offset = (middle - optical_axis(c)) * vec2f(1.0, -1.0);
    let position = fetch3(CAM_XPOS + 3u * c);
    let axes = fetch_matrix(CAM_XMAT + 9u * c);
    if (words[camera + CAMERA_ORTHOGRAPHIC] == 1u) {
        let size = parameter(CAM_FOVY + c) / resolution(camera);
        return Line(position + axes * vec3f(offset * size, 0.0), -axes[2]);
    }
    return Line(position, axes * direction(vec3f(offset * size_of_pixel(c), -1.0)).xyz);
}
