//! Drawn images agree with ray casts. Without a device that draws these tests print that and check nothing else.

use clench::math::Vec3;
use clench::{RayFilter, Sim, load_str};
use clench_render::{FreeCamera, Picture, Planes, RayCaster, RenderError, Renderer, View};
use std::sync::Arc;

const SCENE: &str = "<mujoco>
  <asset>
    <mesh name='wedge' vertex='0 0 0  0.4 0 0  0 0.3 0  0 0 0.5'/>
    <hfield name='hills' nrow='4' ncol='5' size='0.5 0.4 0.3 0.1' elevation='0 1 2 1 0  1 3 1 0 2  0 2 4 2 1  1 0 1 2 0'/>
  </asset>
  <worldbody>
    <geom type='plane' size='0 0 1'/>
    <geom type='hfield' hfield='hills' pos='0.9 0.9 0.2'/>
    <body pos='-0.8 -0.8 0.3'><freejoint/><geom size='0.25'/></body>
    <body pos='0 -0.8 0.4' euler='40 20 0'><freejoint/><geom type='capsule' size='0.12 0.25'/></body>
    <body pos='0.8 -0.8 0.3' euler='10 30 0'><freejoint/><geom type='box' size='0.2 0.15 0.25'/></body>
    <body pos='-0.8 0 0.3' euler='70 0 20'><freejoint/><geom type='cylinder' size='0.2 0.25'/></body>
    <body pos='0 0 0.4' euler='0 40 0'><freejoint/><geom type='ellipsoid' size='0.3 0.15 0.2'/></body>
    <body pos='0.7 0 0.3' euler='0 0 30'><freejoint/><geom type='mesh' mesh='wedge'/></body>
    <camera name='side' pos='2.5 -2 1.2' xyaxes='0.6 0.8 0 -0.25 0.19 0.95' fovy='50'/>
    <camera name='above' pos='0 0 3' fovy='3' projection='orthographic'/>
    <camera name='sensor' pos='2.5 -2 1.2' xyaxes='0.6 0.8 0 -0.25 0.19 0.95' resolution='30 20' sensorsize='0.03 0.02'
      focal='0.02 0.01' principal='0.003 -0.002'/>
  </worldbody>
</mujoco>";

fn sim() -> Sim<f64> {
    Sim::new(Arc::new(load_str(SCENE).unwrap())).unwrap()
}

/// Returns a renderer of the scene; `None` if there is no device or the environment variable `CLENCH_GPU` is `skip`. If
/// it is `require`, a missing device is a failure.
fn renderer(sim: &Sim<f64>) -> Option<Renderer> {
    let wish = std::env::var("CLENCH_GPU").unwrap_or_default();
    if wish == "skip" {
        return None;
    }
    match Renderer::new(sim.model()) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoDevice(why)) if wish != "require" => {
            eprintln!("skipped: no device draws here: {why}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

const WIDTH: usize = 240;
const HEIGHT: usize = 180;

/// Returns the shares of pixels whose geom, and whose distance to a millimetre and a thousandth, are those of the ray
/// through their middle.
fn agreement(
    sim: &mut Sim<f64>,
    view: View,
    rays: impl Fn(f64, f64) -> (Vec3<f64>, Vec3<f64>),
) -> Option<[f64; 2]> {
    let mut renderer = renderer(sim)?;
    let picture = Picture {
        views: vec![view],
        ..Picture::new(WIDTH as u32, HEIGHT as u32)
    };
    let image = renderer.draw_facts(sim, &picture).unwrap();
    let mut agreeing = [0, 0];
    for row in 0..HEIGHT {
        for column in 0..WIDTH {
            let x = (2.0 * column as f64 + 1.0 - WIDTH as f64) / HEIGHT as f64;
            let y = (HEIGHT as f64 - 2.0 * row as f64 - 1.0) / HEIGHT as f64;
            // Directions have length 1 along the viewing direction.
            let (origin, direction) = rays(x, y);
            let hit = sim.ray(origin, direction, &RayFilter::default()).unwrap();
            let pixel = row * WIDTH + column;
            let geom = hit.as_ref().map_or(-1, |hit| hit.geom as i32);
            let depth = hit.map_or(f64::INFINITY, |hit| hit.distance);
            let drawn = f64::from(image.depth[pixel]);
            let near = drawn == depth || (drawn - depth).abs() < 1e-3 + 1e-3 * depth;
            agreeing[0] += usize::from(image.geoms[pixel] == geom);
            agreeing[1] += usize::from(near);
        }
    }
    Some(agreeing.map(|count| count as f64 / (WIDTH * HEIGHT) as f64))
}

fn camera(sim: &mut Sim<f64>, index: usize) -> (Vec3<f64>, [Vec3<f64>; 3]) {
    let place = sim.output("cam_xpos").unwrap();
    let turn = sim.output("cam_xmat").unwrap();
    let axis = |k: usize| Vec3::from_array([0, 3, 6].map(|row| turn[9 * index + row + k]));
    let place = Vec3::from_array([0, 1, 2].map(|k| place[3 * index + k]));
    (place, [axis(0), axis(1), axis(2)])
}

#[test]
fn every_kind_of_geom_is_drawn_at_the_hits_of_rays() {
    let mut sim = sim();
    let (place, [right, up, back]) = camera(&mut sim, 0);
    let half = 25f64.to_radians().tan();
    let rays = |x: f64, y: f64| (place, right * (half * x) + up * (half * y) - back);
    let Some([geoms, depth]) = agreement(&mut sim, View::Camera(0), rays) else {
        return;
    };
    assert!(geoms > 0.995, "{geoms}");
    assert!(depth > 0.99, "{depth}");
}

#[test]
fn lines_of_sight_can_be_parallel() {
    let mut sim = sim();
    let (place, [right, up, back]) = camera(&mut sim, 1);
    let rays = |x: f64, y: f64| (place + right * (1.5 * x) + up * (1.5 * y), back * -1.0);
    let Some([geoms, depth]) = agreement(&mut sim, View::Camera(1), rays) else {
        return;
    };
    assert!(geoms > 0.995, "{geoms}");
    assert!(depth > 0.99, "{depth}");
}

#[test]
fn a_sensor_fills_the_picture() {
    let mut sim = sim();
    let (place, [right, up, back]) = camera(&mut sim, 2);
    // The sensor is 1.5 x 2 at distance 1, and its middle is aside of the optical axis, as MuJoCo draws it.
    let aspect = WIDTH as f64 / HEIGHT as f64;
    let rays = |x: f64, y: f64| {
        let aside = right * (0.15 + 0.75 * x / aspect) + up * (0.2 + y);
        (place, aside - back)
    };
    let Some([geoms, depth]) = agreement(&mut sim, View::Camera(2), rays) else {
        return;
    };
    assert!(geoms > 0.995, "{geoms}");
    assert!(depth > 0.99, "{depth}");
}

#[test]
fn a_free_camera_looks_at_its_point() {
    let mut sim = sim();
    let free = FreeCamera {
        lookat: [-0.8, -0.8, 0.3],
        distance: 2.0,
        azimuth: 30.0,
        elevation: -20.0,
        fovy: 45.0,
    };
    let Some(mut renderer) = renderer(&sim) else {
        return;
    };
    let picture = Picture {
        views: vec![View::Free(free)],
        ..Picture::new(101, 101)
    };
    let image = renderer.draw_facts(&mut sim, &picture).unwrap();
    let middle = 50 * 101 + 50;
    assert_eq!(image.geoms[middle], 2);
    assert!(
        (image.depth[middle] - 1.75).abs() < 2e-3,
        "{}",
        image.depth[middle]
    );
    assert_eq!(image.rgb.len(), 3 * 101 * 101);
    // The same picture again is identical to the byte. Then the whole scene, without a view.
    assert!(renderer.draw_facts(&mut sim, &picture).unwrap() == image);
    let all = renderer
        .draw_facts(
            &mut sim,
            &Picture {
                views: vec![View::All],
                ..picture
            },
        )
        .unwrap();
    let seen = (0..8).filter(|geom| all.geoms.contains(geom)).count();
    assert!(seen >= 7, "{seen}");
}

#[test]
fn a_camera_in_a_shape_looks_out_of_it() {
    for shape in [
        "size='0.3'",
        "type='box' size='0.2 0.3 0.4'",
        "type='cylinder' size='0.3 0.2'",
        "type='capsule' size='0.3 0.2' rgba='1 1 1 0.5'",
        "type='ellipsoid' size='0.2 0.3 0.4'",
        "type='mesh' mesh='open'",
    ] {
        let xml = format!(
            "<mujoco><asset><mesh name='open' inertia='shell' vertex='-1 -1 -1  1 -1 -1  0 1 -1  0 0 1'
              face='0 2 1  0 1 3  1 2 3'/></asset><worldbody><geom size='0.5' pos='0 0 -3'/><geom {shape}/>
              <camera/></worldbody></mujoco>"
        );
        let Some([drawn, cast]) = in_the_middle(&xml) else {
            return;
        };
        assert_eq!(drawn.0, 0, "{shape}");
        assert!((drawn.1 - 2.5).abs() < 1e-3, "{shape}");
        assert_eq!(cast, (0, 2.5), "{shape}");
    }
}

/// Returns the geom in the middle of a picture by the first camera of a scene, and its distance: drawn, and by rays.
fn in_the_middle(xml: &str) -> Option<[(i32, f32); 2]> {
    let model = Arc::new(load_str(xml).expect("the scene is complete"));
    let mut sim = Sim::<f64>::new(model).expect("the scene is at rest");
    let mut renderer = renderer(&sim)?;
    let picture = Picture {
        views: vec![View::Camera(0)],
        ..Picture::new(9, 9)
    };
    let image = renderer.draw_facts(&mut sim, &picture).expect("a picture");
    let (mut geoms, mut depth) = ([0; 81], [0.0; 81]);
    let caster = RayCaster::new(sim.model()).expect("the scene has a size");
    let planes = Planes {
        rgb: &mut [],
        depth: &mut depth,
        geoms: &mut geoms,
    };
    let mut rays = caster.pictures(&picture, 1, planes, 1).expect("a size");
    rays.add(&mut sim, 0, None).expect("a picture");
    rays.finish();
    Some([(image.geoms[40], image.depth[40]), (geoms[40], depth[40])])
}

/// As in MuJoCo.
#[test]
fn of_two_geoms_in_one_place_the_later_is_seen() {
    let geom = "<geom type='box' size='0.2 0.3 0.4' pos='0 0 -3'/>";
    let xml = format!("<mujoco><worldbody>{geom}{geom}<camera/></worldbody></mujoco>");
    if let Some(seen) = in_the_middle(&xml) {
        assert_eq!(seen.map(|(geom, _)| geom), [1, 1]);
    }
}

#[test]
fn many_geoms_of_different_sizes_are_drawn() {
    // Balls and cylinders on a grid, seen from above.
    let geom = |k: usize| {
        let (x, y, size) = (k % 30, k / 30, 0.2 + 2e-4 * k as f64);
        let kind = ["sphere", "cylinder"][k % 2];
        format!("<geom type='{kind}' size='{size} {size}' pos='{x} {y} 0'/>")
    };
    let geoms: String = (0..900).map(geom).collect();
    let xml = format!(
        "<mujoco><worldbody>{geoms}<camera pos='14.5 14.5 9' fovy='30' projection='orthographic'/></worldbody></mujoco>"
    );
    let mut sim = Sim::<f64>::new(Arc::new(load_str(&xml).expect("the scene is complete")))
        .expect("the scene is at rest");
    let Some(mut renderer) = renderer(&sim) else {
        return;
    };
    let picture = Picture {
        views: vec![View::Camera(0)],
        ..Picture::new(600, 600)
    };
    let image = renderer.draw_facts(&mut sim, &picture).expect("a picture");
    for k in [0, 449, 450, 899] {
        let pixels = image.geoms.iter().filter(|&&geom| geom == k).count() as f64;
        let radius = 20.0 * (0.2 + 2e-4 * f64::from(k));
        let area = std::f64::consts::PI * radius * radius;
        assert!((pixels / area - 1.0).abs() < 0.15, "{k}: {pixels} {area}");
    }
}

#[test]
fn impossible_images_are_errors() {
    let mut sim = sim();
    let Some(mut renderer) = renderer(&sim) else {
        return;
    };
    for (width, height, view) in [
        (0, 5, View::All),
        (5, 1 << 20, View::All),
        (5, 5, View::Camera(3)),
    ] {
        let picture = Picture {
            views: vec![view],
            ..Picture::new(width, height)
        };
        assert!(renderer.draw_facts(&mut sim, &picture).is_err());
    }
}
