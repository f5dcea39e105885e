// Draws geoms: their colours with light and shadow, or their distances and indices.

struct View {
    // The transforms from the world to the image and to the shadow map.
    camera: mat4x4<f32>,
    sun: mat4x4<f32>,
    eye: vec4<f32>,
    // The viewing direction; 1 in w for an orthographic camera.
    ahead: vec4<f32>,
    // The direction to the sun; in w the size of a texel of the shadow map, in texture coordinates.
    to_sun: vec4<f32>,
    sky: vec4<f32>,
    // The distances between which infinite planes fade into the sky, and the normal offset of shadow lookups.
    fog: vec4<f32>,
    // The ambient light of all lights, the headlight's diffuse light and its highlights. The w components of the first
    // two are the number of lights and the index of the first.
    ambient: vec4<f32>,
    head: vec4<f32>,
    head_specular: vec4<f32>,
}

// A light of the model.
struct Light {
    // The position; w is 0 for a spot, 1 for a directional light, 2 for a point light.
    place: vec4<f32>,
    // The direction; in w the cosine of the cutoff angle of a spot.
    dir: vec4<f32>,
    // The w components of the three colours: the exponent of a spot, 1 if the light casts the shadow, unused.
    ambient: vec4<f32>,
    diffuse: vec4<f32>,
    specular: vec4<f32>,
    attenuation: vec4<f32>,
}

struct Item {
    pose: mat4x4<f32>,
    // The factors of the size of its vertices along the axes, and how far the halves of a capsule move apart.
    stretch: vec4<f32>,
    // In linear values in a model without lights.
    color: vec4<f32>,
    // Strength and sharpness of highlights, emission, index of the geom.
    surface: vec4<f32>,
    // The spacing of grid lines, m; 1 if only the lines are drawn; 1 for an infinite plane.
    lines: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> items: array<Item>;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
@group(1) @binding(0) var shadow: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;
@group(2) @binding(0) var plane: texture_2d<f32>;
@group(2) @binding(1) var cube: texture_cube<f32>;
@group(2) @binding(2) var picture_sampler: sampler;

// Software devices evaluate both sides of a condition; with override constants they skip one.
// True if the model has lights.
override own_lights: bool;
// The surface of the items of a draw call: 0 a colour, 1 a colour with grid lines, 2 a plane texture, 3 a cube texture.
override kind: u32;
// The maximum number of parts of a pixel in a plane texture.
const MAX_PARTS = 8.0;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) texcoord: vec3<f32>,
    @location(3) @interpolate(flat) item: u32,
}

// The place of a vertex, in the frame of its item.
fn stretched(place: vec3<f32>, item: u32) -> vec4<f32> {
    let by = items[item].stretch;
    return vec4(place * by.xyz + vec3(0.0, 0.0, by.w * sign(place.z)), 1.0);
}

@vertex
fn corner(
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) texcoord: vec3<f32>,
    @builtin(instance_index) item: u32,
) -> Corner {
    let pose = items[item].pose;
    var out: Corner;
    out.place = (pose * stretched(place, item)).xyz;
    out.normal = (pose * vec4(normal / items[item].stretch.xyz, 0.0)).xyz;
    out.texcoord = texcoord;
    out.item = item;
    out.position = view.camera * vec4(out.place, 1.0);
    return out;
}

@vertex
fn shadow_corner(@location(0) place: vec3<f32>, @builtin(instance_index) item: u32) -> @builtin(position) vec4<f32> {
    return view.sun * items[item].pose * stretched(place, item);
}

// Screens show sRGB; daylight is added in linear values.
fn shown(color: vec3<f32>) -> vec3<f32> {
    return pow(color, vec3(1.0 / 2.2));
}

// The mean of a plane texture under a pixel whose sides are these two vectors in the texture. The longer side is
// divided into parts as long as the other, so that a ground is sharp at grazing angles. Anisotropic samplers can do
// this too, but Mesa's visits every texel under a pixel, which takes minutes at the horizon.
fn plane_color(at: vec2<f32>, across: vec2<f32>, down: vec2<f32>) -> vec3<f32> {
    let size = vec2<f32>(textureDimensions(plane));
    let lengths = vec2(length(across * size), length(down * size));
    let longer = select(down, across, lengths.x > lengths.y);
    let long = max(lengths.x, lengths.y);
    let short = max(min(lengths.x, lengths.y), 1e-6);
    let parts = clamp(ceil(long / short), 1.0, MAX_PARTS);
    let level = log2(max(long / parts, short));
    var sum = vec3(0.0);
    for (var part = 0.5; part < parts; part += 1.0) {
        sum += textureSampleLevel(plane, picture_sampler, at + (part / parts - 0.5) * longer, level).rgb;
    }
    return sum / parts;
}

// The color of a texture, in linear values.
fn painted(at: vec3<f32>, across: vec3<f32>, down: vec3<f32>) -> vec3<f32> {
    if (kind == 2u) {
        return plane_color(at.xy, across.xy, down.xy);
    }
    if (kind == 3u) {
        return textureSampleGrad(cube, picture_sampler, at, across, down).rgb;
    }
    return vec3(1.0);
}

// The color and opacity of grid lines below a model without a ground, and the share of color that lines on a floor
// take.
const GRID = vec4(0.596, 0.635, 0.682, 0.42);
const LINE_SHADE = 0.15;

// The share of a pixel that grid lines cover: they are one pixel wide, and vanish where they are close to each other.
fn grid_cover(place: vec2<f32>, cell: f32) -> f32 {
    let at = place / cell;
    let wide = fwidth(at);
    let lines = saturate(1.0 - abs(fract(at - 0.5) - 0.5) / max(wide, vec2(1e-6))) * saturate(1.0 - 2.0 * wide);
    return max(lines.x, lines.y);
}

// The unshadowed share of the light that casts the shadow: the mean of nine adjacent samples, each interpolated between
// four texels. They read sixteen texels together.
fn sunlight(place: vec3<f32>, normal: vec3<f32>) -> f32 {
    let texel = view.to_sun.w;
    let seen = view.sun * vec4(place + normal * view.fog.z, 1.0);
    let at = seen.xyz / seen.w;
    let uv = at.xy * vec2(0.5, -0.5) + 0.5;
    if (any(uv < vec2(0.0)) || any(uv > vec2(1.0)) || at.z < 0.0 || seen.w <= 0.0) {
        return 1.0;
    }
    let place_in_map = uv / texel - 0.5;
    let part = fract(place_in_map);
    // The corner between the four texels of the middle sample.
    let middle = (floor(place_in_map) + 1.0) * texel;
    let left = textureGatherCompare(shadow, shadow_sampler, middle - texel, at.z);
    let right = textureGatherCompare(shadow, shadow_sampler, middle + vec2(texel, -texel), at.z);
    let left_below = textureGatherCompare(shadow, shadow_sampler, middle + vec2(-texel, texel), at.z);
    let right_below = textureGatherCompare(shadow, shadow_sampler, middle + texel, at.z);
    // The texels of a gather are those at the lower left, lower right, upper right and upper left.
    let rows = mat4x4(
        vec4(left.wz, right.wz),
        vec4(left.xy, right.xy),
        vec4(left_below.wz, right_below.wz),
        vec4(left_below.xy, right_below.xy),
    );
    let weights = vec4(1.0 - part.y, 1.0, 1.0, part.y);
    return dot(rows * weights, vec4(1.0 - part.x, 1.0, 1.0, part.x)) / 9.0;
}

// The lighting of a model without lights: a sun, a sky and a little light from the camera.
fn daylight(color: vec3<f32>, surface: vec4<f32>, place: vec3<f32>, normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    let to_sun = view.to_sun.xyz;
    let facing = max(dot(normal, to_sun), 0.0);
    var sun = 0.0;
    if (facing > 0.0) {
        sun = sunlight(place, normal);
    }
    let sky = mix(vec3(0.20, 0.19, 0.18), vec3(0.42, 0.44, 0.47), 0.5 + 0.5 * normal.z);
    let front_light = 0.16 * max(dot(normal, to_eye), 0.0);
    let middle = normalize(to_sun + to_eye);
    let shine = surface.x * pow(max(dot(normal, middle), 0.0), 4.0 + 120.0 * surface.y) * facing;
    let light = color * (sky + front_light + 0.72 * facing * sun + surface.z) + vec3(0.24 * shine * sun);
    // Bright parts become white gradually.
    return light / (1.0 + 0.18 * max(light.r, max(light.g, light.b)));
}

// The brightness of the highlight of a light (Blinn and Phong).
fn highlight(surface: vec4<f32>, normal: vec3<f32>, to_light: vec3<f32>, to_eye: vec3<f32>) -> f32 {
    let middle = normalize(to_light + to_eye);
    return surface.x * pow(max(dot(normal, middle), 0.0), max(128.0 * surface.y, 1.0));
}

// The lighting by a model's lights, added in sRGB values, as in OpenGL and so in MuJoCo.
fn lit(color: vec3<f32>, surface: vec4<f32>, place: vec3<f32>, normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    var matte = view.ambient.rgb + surface.z;
    var shine = vec3(0.0);
    let to_head = -view.ahead.xyz;
    let head = max(dot(normal, to_head), 0.0);
    matte += view.head.rgb * head;
    if (head > 0.0) {
        shine += view.head_specular.rgb * highlight(surface, normal, to_head, to_eye);
    }
    // For the one light that casts the shadow, computed once instead of in every iteration.
    let through = sunlight(place, normal);
    for (var k = 0u; k < u32(view.ambient.w); k++) {
        let light = lights[u32(view.head.w) + k];
        var to_light = -light.dir.xyz;
        var strength = 1.0;
        if (light.place.w != 1.0) {
            let way = light.place.xyz - place;
            let distance = length(way);
            to_light = way / max(distance, 1e-9);
            let parts = light.attenuation.xyz * vec3(1.0, distance, distance * distance);
            strength = 1.0 / max(parts.x + parts.y + parts.z, 1e-9);
        }
        if (light.place.w == 0.0) {
            let along = dot(-to_light, light.dir.xyz);
            strength *= select(0.0, pow(max(along, 0.0), light.ambient.w), along >= light.dir.w);
        }
        matte += strength * light.ambient.rgb;
        let facing = dot(normal, to_light);
        if (facing > 0.0 && strength > 0.0) {
            strength *= select(1.0, through, light.diffuse.w > 0.0);
            matte += strength * facing * light.diffuse.rgb;
            shine += strength * light.specular.rgb * highlight(surface, normal, to_light, to_eye);
        }
    }
    return saturate(color * matte + shine);
}

@fragment
fn picture(in: Corner, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let item = items[in.item];
    let texel = painted(in.texcoord, dpdx(in.texcoord), dpdy(in.texcoord));
    var to_eye = view.eye.xyz - in.place;
    let distance = length(to_eye);
    to_eye = select(to_eye / distance, -view.ahead.xyz, view.ahead.w > 0.0);
    var normal = normalize(in.normal);
    // Independent of the winding: the visible side is the outside.
    normal = select(normal, -normal, dot(normal, to_eye) < 0.0);
    var light = vec3(0.0);
    if (own_lights) {
        light = lit(item.color.rgb * shown(texel), item.surface, in.place, normal, to_eye);
    } else {
        light = shown(daylight(item.color.rgb * texel, item.surface, in.place, normal, to_eye));
    }
    let fog = item.lines.z * smoothstep(view.fog.x, view.fog.y, distance);
    if (kind == 1u) {
        let lines = grid_cover(in.place.xy, item.lines.x);
        if (item.lines.y > 0.0) {
            return vec4(GRID.rgb, GRID.a * lines * (1.0 - fog));
        }
        light *= 1.0 - LINE_SHADE * lines;
    }
    return vec4(mix(light, view.sky.rgb, fog), item.color.a);
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
