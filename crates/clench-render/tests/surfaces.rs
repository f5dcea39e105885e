//! Pictures on surfaces and lights of a file. Without a device that draws these tests print that and check nothing
//! else.

#[path = "../../clench-formats/tests/suite/pictures/mod.rs"]
mod pictures;

use clench::{Loader, Sim};
use clench_render::{FreeCamera, Image, Picture, RenderError, Renderer, View};
use pictures::png;
use std::sync::Arc;

const R: [u8; 3] = [255, 0, 0];
const G: [u8; 3] = [0, 255, 0];
const B: [u8; 3] = [0, 0, 255];
const W: [u8; 3] = [255; 3];

/// Draws a scene from straight above, or from the given view; returns `None` if nothing can draw here.
fn drawn(text: &str, view: Option<View>) -> Option<Image> {
    let wish = std::env::var("CLENCH_GPU").unwrap_or_default();
    if wish == "skip" {
        return None;
    }
    // A quarter each, large enough that blurring does not mix neighbours.
    let upper = [[R; 4], [G; 4]].concat().repeat(4);
    let four = [upper, [[B; 4], [W; 4]].concat().repeat(4)].concat();
    let sides = [R, G, B, W, [255, 255, 0], [0, 255, 255]];
    let files = [
        ("four.png", png([8, 8], &four)),
        ("sides.png", png([6, 1], &sides)),
    ];
    let model = Loader::new().assets(files).load_str(text).unwrap();
    let mut sim = Sim::<f64>::new(Arc::new(model)).unwrap();
    let mut renderer = match Renderer::new(sim.model()) {
        Ok(renderer) => renderer,
        Err(RenderError::NoDevice(why)) if wish != "require" => {
            eprintln!("skipped: no device draws here: {why}");
            return None;
        }
        Err(error) => panic!("{error}"),
    };
    let above = FreeCamera {
        lookat: [0.0; 3],
        distance: 4.0,
        azimuth: 90.0,
        elevation: -90.0,
        fovy: 45.0,
    };
    let picture = Picture {
        views: vec![view.unwrap_or(View::Free(above))],
        ..Picture::new(100, 100)
    };
    Some(renderer.draw(&mut sim, &picture).unwrap())
}

fn at(image: &Image, x: usize, y: usize) -> [u8; 3] {
    let start = 3 * (100 * y + x);
    [0, 1, 2].map(|k| image.rgb[start + k])
}

/// Returns which of the three parts of a colour are present.
fn hue(color: [u8; 3]) -> [bool; 3] {
    let most = color.into_iter().max().unwrap_or_default();
    color.map(|part| 2 * u32::from(part) > u32::from(most))
}

/// Asserts that the quarters of a picture, from the upper left in rows, have these colours.
fn quarters(image: &Image, expected: [[u8; 3]; 4]) {
    let found = [(35, 35), (65, 35), (35, 65), (65, 65)].map(|(x, y)| hue(at(image, x, y)));
    assert_eq!(found, expected.map(hue));
}

fn textured(material: &str, geom: &str) -> String {
    format!(
        "<mujoco><asset><texture name='four' type='2d' file='four.png'/>
           <texture name='sides' type='cube' file='sides.png' gridsize='1 6' gridlayout='RLUDFB'/>
           <mesh name='tile' inertia='shell' vertex='-1 -1 0  1 -1 0  1 1 0  -1 1 0  0 0 -1' texcoord='0 1 1 1 1 0 0 0 0 0'
             face='0 1 2 0 2 3'/>
           <material name='m' {material}/></asset>
         <worldbody><geom material='m' {geom}/></worldbody></mujoco>"
    )
}

#[test]
fn a_picture_stands_upright_on_a_plane_a_box_and_a_mesh() {
    for geom in [
        "type='plane' size='1 1 1'",
        "type='box' size='1 1 .1'",
        "type='ellipsoid' size='1 1 .1'",
        "type='mesh' mesh='tile'",
    ] {
        if let Some(image) = drawn(&textured("texture='four'", geom), None) {
            quarters(&image, [R, G, B, W]);
        }
    }
}

#[test]
fn a_texture_repeats_as_set_by_the_material() {
    // Twice along each side: each quarter contains a whole picture.
    let twice = textured(
        "texture='four' texrepeat='2 2'",
        "type='plane' size='1 1 1'",
    );
    let uniform = textured(
        "texture='four' texrepeat='1 1' texuniform='true'",
        "type='plane' size='2 2 1'",
    );
    if let Some(image) = drawn(&twice, None) {
        let row = [27, 42, 58, 73].map(|x| hue(at(&image, x, 27)));
        assert_eq!(row, [W, B, W, B].map(hue));
    }
    // Once per two metres, from the middle of the plane.
    if let Some(image) = drawn(&uniform, None) {
        quarters(&image, [R, G, B, W]);
        assert_eq!(hue(at(&image, 5, 35)), hue(G));
    }
}

#[test]
fn a_texture_at_a_grazing_angle_is_blurred_along_the_line_of_sight_only() {
    // Each repetition lacks green on its left. On the plane the footprint of a pixel is twelve times as long as it is
    // wide, and about as long as the picture.
    let scene = textured(
        "texture='four' texrepeat='24 24'",
        "type='plane' size='2 2 1'/><camera pos='0 -2.5 .2' xyaxes='1 0 0 0 .08 1' fovy='30'",
    );
    if let Some(image) = drawn(&scene, Some(View::Camera(0))) {
        let greens: Vec<u8> = (30..70).map(|x| at(&image, x, 50)[1]).collect();
        let [least, most] = [greens.iter().min(), greens.iter().max()];
        assert!(least < Some(&40) && most > Some(&120), "{greens:?}");
    }
}

#[test]
fn each_side_of_a_cube_has_its_picture() {
    // The views of the sides of a box: right, left, up, down, front, back are x, −x, y, −y, z, −z.
    let sides = [
        (180.0, 0.0, R),
        (0.0, 0.0, G),
        (270.0, 0.0, B),
        (90.0, 0.0, W),
        (90.0, -90.0, [255, 255, 0]),
        (90.0, 90.0, [0, 255, 255]),
    ];
    let scene = textured("texture='sides'", "type='box' size='.5 .4 .3'");
    for (azimuth, elevation, expected) in sides {
        let camera = FreeCamera {
            lookat: [0.0; 3],
            distance: 4.0,
            azimuth,
            elevation,
            fovy: 45.0,
        };
        if let Some(image) = drawn(&scene, Some(View::Free(camera))) {
            assert_eq!(
                hue(at(&image, 50, 50)),
                hue(expected),
                "{azimuth} {elevation}"
            );
        }
    }
}

/// Returns a white surface at z = 0 under lights: that of a box, which has no grid lines.
fn lit(visual: &str, lights: &str) -> String {
    format!(
        "<mujoco><visual>{visual}</visual><worldbody>{lights}
         <geom type='box' size='2 2 .1' pos='0 0 -.1' rgba='1 1 1 1'/></worldbody></mujoco>"
    )
}

/// Returns the brightness of the middle and of a point next to it.
fn brightness(text: &str) -> Option<[i32; 2]> {
    let image = drawn(text, None)?;
    Some([(50, 50), (20, 50)].map(|(x, y)| i32::from(at(&image, x, y)[1])))
}

#[test]
fn lights_of_a_file_have_its_intensity() {
    let dark = "<headlight active='0'/>";
    let sun = |rest: &str| {
        format!("<light type='directional' diffuse='.5 .5 .5' specular='0 0 0' {rest}/>")
    };
    // Values of a screen: half of white, and half of that at an angle of 60 degrees.
    for (lights, expected) in [
        (sun(""), 127),
        (sun("dir='0 1.7320508 -1'"), 64),
        (sun("ambient='.25 .25 .25'"), 191),
        (sun("active='false'"), 0),
        ("<light type='point' pos='0 0 1' attenuation='1 0 1' diffuse='1 1 1' specular='0 0 0'/>".to_owned(), 127),
    ] {
        if let Some([middle, _]) = brightness(&lit(dark, &lights)) {
            assert!((middle - expected).abs() <= 3, "{lights}: {middle}, not {expected}");
        }
    }
    let spot = "<light pos='0 0 1' cutoff='30' exponent='0' diffuse='.5 .5 .5' specular='0 0 0'/>";
    if let Some([middle, beside]) = brightness(&lit(dark, spot)) {
        assert!(
            (middle - 127).abs() <= 3 && beside == 0,
            "{middle} {beside}"
        );
    }
    let head = lit(
        "<headlight ambient='.2 .2 .2' diffuse='.3 .3 .3' specular='0 0 0'/>",
        &sun("active='false'"),
    );
    if let Some([middle, _]) = brightness(&head) {
        assert!((middle - 127).abs() <= 3, "{middle}");
    }
}

#[test]
fn bodies_cast_shadows() {
    for light in [
        "type='directional' pos='0 0 3'",
        "type='spot' pos='0 0 3' cutoff='60' exponent='0'",
        "type='point' pos='0 0 3'",
    ] {
        let scene = |shadow: bool| {
            format!(
                "<mujoco><visual><headlight active='0'/></visual><worldbody>
                 <light {light} dir='0 0 -1' diffuse='.5 .5 .5' specular='0 0 0' castshadow='{shadow}'/>
                 <geom type='plane' size='2 2 1' rgba='1 1 1 1'/>
                 <body pos='0 0 .5'><freejoint/><geom type='box' size='.3 .3 .02' group='0' rgba='1 0 0 1'/></body>
                 <camera name='low' pos='2 0 .2' xyaxes='0 1 0 -.1 0 1' fovy='30'/>
                 </worldbody></mujoco>"
            )
        };
        let low = |shadow| drawn(&scene(shadow), Some(View::Camera(0)));
        let (Some(with), Some(without)) = (low(true), low(false)) else {
            return;
        };
        // The ground under the box, seen from the side.
        let [with, without] = [&with, &without].map(|image| i32::from(at(image, 50, 50)[1]));
        assert!(
            without > 60 && with < without / 3,
            "{light}: {with} {without}"
        );
    }
}

#[test]
fn sites_are_seen_in_their_groups() {
    let scene = |group: usize| {
        format!(
            "<mujoco><worldbody><geom size='.1' pos='.5 0 0'/>
             <site type='box' size='.3 .3 .1' rgba='0 1 0 1' group='{group}'/></worldbody></mujoco>"
        )
    };
    let middle = |group| drawn(&scene(group), None).map(|image| hue(at(&image, 50, 50)));
    if let (Some(seen), Some(hidden)) = (middle(0), middle(4)) {
        assert_eq!(seen, hue(G));
        assert_ne!(hidden, hue(G));
    }
}

#[test]
fn a_ground_without_a_picture_has_lines_as_on_the_page() {
    let balls = "<body pos='-1.3 0 1'><geom size='0.2'/></body><body pos='1.3 0 1'><geom size='0.2'/></body>";
    // Lines are 0.5 m apart, and a pixel is 33 mm wide: one line crosses these pixels of a row.
    for floor in ["<geom type='plane' size='0 0 1'/>", ""] {
        let text = format!("<mujoco><worldbody>{floor}{balls}</worldbody></mujoco>");
        let Some(image) = drawn(&text, None) else {
            return;
        };
        let row = Vec::from_iter((56..72).map(|x| at(&image, x, 42)[1]));
        let (least, most) = (row.iter().min().unwrap(), row.iter().max().unwrap());
        assert!(most - least > 4, "{row:?}");
    }
    let picture = "<mujoco>
          <asset><texture name='t' type='2d' builtin='flat' rgb1='1 1 1' width='8' height='8'/><material name='m' texture='t'/></asset>
          <worldbody><geom type='plane' size='0 0 1' material='m'/>BALLS</worldbody>
        </mujoco>";
    if let Some(image) = drawn(&picture.replace("BALLS", balls), None) {
        let row = Vec::from_iter((56..72).map(|x| at(&image, x, 42)[1]));
        let (least, most) = (row.iter().min().unwrap(), row.iter().max().unwrap());
        assert!(most - least <= 4, "{row:?}");
    }
}

#[test]
fn a_large_scene_around_a_small_body_does_not_fade() {
    // The camera is two hundred sizes of the body away.
    let text = "<mujoco><visual><headlight ambient='1 1 1' diffuse='0 0 0' specular='0 0 0'/></visual><worldbody>
      <light active='false'/><geom type='plane' size='9 9 1' rgba='1 0 0 1'/>
      <body><freejoint/><geom size='0.01'/></body></worldbody></mujoco>";
    let Some(image) = drawn(text, None) else {
        return;
    };
    assert_eq!(at(&image, 20, 20), R);
}
