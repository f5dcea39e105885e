// What is drawn of each geom: its picture with light and shadow, or its distance and number.

struct View {
    // From the world to the picture, and from the world to the sun's.
    camera: mat4x4<f32>,
    sun: mat4x4<f32>,
    eye: vec4<f32>,
    // Where the camera looks; 1 in w for parallel lines of sight.
    ahead: vec4<f32>,
    // Towards the sun; in w the size of a texel of its shadow, in the shadow's picture.
    to_sun: vec4<f32>,
    sky: vec4<f32>,
    // Distances between which things fade into the sky.
    fog: vec4<f32>,
}

struct Item {
    pose: mat4x4<f32>,
    color: vec4<f32>,
    // Strength and sharpness of highlights, emission, number of the geom.
    surface: vec4<f32>,
    // The two colours of a computed texture, and of what is drawn over it; in w of the first its pattern (0 none, 1 checker, 2 flat,
    // 3 gradient), of the second what is drawn over it (0 nothing, 1 edges, 2 a cross).
    first: vec4<f32>,
    second: vec4<f32>,
    mark: vec4<f32>,
    // How often the picture repeats along x and y, on the unit of length in which z and w give the half size.
    repeat: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> items: array<Item>;
@group(1) @binding(0) var shadow: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) local: vec3<f32>,
    @location(3) @interpolate(flat) item: u32,
}

@vertex
fn corner(
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @builtin(instance_index) item: u32,
) -> Corner {
    let pose = items[item].pose;
    var out: Corner;
    out.place = (pose * vec4(place, 1.0)).xyz;
    out.normal = (pose * vec4(normal, 0.0)).xyz;
    out.local = place;
    out.item = item;
    out.position = view.camera * vec4(out.place, 1.0);
    return out;
}

@vertex
fn shadow_corner(@location(0) place: vec3<f32>, @builtin(instance_index) item: u32) -> @builtin(position) vec4<f32> {
    return view.sun * items[item].pose * vec4(place, 1.0);
}

// Screens show sRGB; light adds up in linear numbers.
fn linear(color: vec3<f32>) -> vec3<f32> {
    return pow(color, vec3(2.2));
}

fn pattern(item: Item, local: vec3<f32>) -> vec3<f32> {
    let kind = i32(item.first.w);
    if (kind == 0) {
        return vec3(1.0);
    }
    let at = (local.xy + item.repeat.zw) * item.repeat.xy;
    let cell = fract(at);
    var color = item.first.rgb;
    if (kind == 1 && (cell.x < 0.5) != (cell.y < 0.5)) {
        color = item.second.rgb;
    }
    if (kind == 3) {
        color = mix(item.second.rgb, item.first.rgb, saturate(length(cell - 0.5) * 1.4));
    }
    let over = i32(item.second.w);
    let middle = min(abs(cell.x - 0.5), abs(cell.y - 0.5));
    let edge = 0.5 - max(abs(cell.x - 0.5), abs(cell.y - 0.5));
    if ((over == 1 && edge < 0.006) || (over == 2 && middle < 0.006)) {
        color = item.mark.rgb;
    }
    return color;
}

// The share of the sun's light that comes through, from nine places beside each other.
fn sunlight(place: vec3<f32>, normal: vec3<f32>) -> f32 {
    let texel = view.to_sun.w;
    let at = view.sun * vec4(place + normal * view.fog.z, 1.0);
    let uv = at.xy * vec2(0.5, -0.5) + 0.5;
    if (any(uv < vec2(0.0)) || any(uv > vec2(1.0)) || at.z < 0.0) {
        return 1.0;
    }
    var sum = 0.0;
    for (var x = -1; x <= 1; x++) {
        for (var y = -1; y <= 1; y++) {
            let beside = uv + vec2(f32(x), f32(y)) * texel;
            sum += textureSampleCompareLevel(shadow, shadow_sampler, beside, at.z);
        }
    }
    return sum / 9.0;
}

@fragment
fn picture(in: Corner, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let item = items[in.item];
    var to_eye = view.eye.xyz - in.place;
    let distance = length(to_eye);
    to_eye = select(to_eye / distance, -view.ahead.xyz, view.ahead.w > 0.0);
    var normal = normalize(in.normal);
    // Whatever way its corners are in order: what is seen is outside.
    normal = select(normal, -normal, dot(normal, to_eye) < 0.0);
    let color = linear(item.color.rgb * pattern(item, in.local));

    let to_sun = view.to_sun.xyz;
    let facing = max(dot(normal, to_sun), 0.0);
    var sun = 0.0;
    if (facing > 0.0) {
        sun = sunlight(in.place, normal);
    }
    let sky = mix(vec3(0.20, 0.19, 0.18), vec3(0.42, 0.44, 0.47), 0.5 + 0.5 * normal.z);
    let front_light = 0.16 * max(dot(normal, to_eye), 0.0);
    let middle = normalize(to_sun + to_eye);
    let shine = item.surface.x * pow(max(dot(normal, middle), 0.0), 4.0 + 120.0 * item.surface.y) * facing;
    var light = color * (sky + front_light + 0.72 * facing * sun) + vec3(0.4 * shine * sun);
    light += color * item.surface.z;
    // Bright parts become white by and by.
    light = light / (1.0 + 0.18 * max(light.r, max(light.g, light.b)));
    let fog = smoothstep(view.fog.x, view.fog.y, distance);
    return vec4(mix(light, linear(view.sky.rgb), fog), item.color.a);
}

struct Facts {
    @location(0) geom: i32,
    @location(1) depth: f32,
}

@fragment
fn facts(in: Corner) -> Facts {
    let ahead = dot(in.place - view.eye.xyz, view.ahead.xyz);
    return Facts(i32(items[in.item].surface.w), ahead);
}
