//! The scene: the constant part of a model's appearance. The page reads it as JSON.

use crate::frame::SECTIONS;
use crate::stages::STAGES;
use crate::surfaces;
use clench::Model;
use clench::collide::ShapeKind;
use clench::formats::base64;
use clench::math::{Quat, Vec3};
use clench::rigid::model::{
    Appearance, Joint, JointKind, Light, LightKind, Mesh, Texture, TextureKind, Visuals,
};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// The elements to draw. Poses are relative to bodies, quaternions have w first, lengths are in metres.
#[derive(Clone, Debug, Serialize)]
pub struct Scene {
    name: String,
    timestep: f64,
    /// The names and widths of the sections of frames, in order.
    sections: Vec<Value>,
    /// The names of the stages whose times are in frames.
    stages: [&'static str; STAGES.len()],
    bodies: Vec<Value>,
    geoms: Vec<Value>,
    sites: Vec<Value>,
    joints: Vec<Value>,
    controls: Vec<Value>,
    tendons: Vec<Value>,
    equalities: Vec<Value>,
    sensors: Vec<Value>,
    keyframes: Vec<String>,
    cameras: Vec<Value>,
    lights: Vec<Value>,
    headlight: Value,
    meshes: Vec<Value>,
    height_fields: Vec<Value>,
    materials: Vec<Value>,
    textures: Vec<Value>,
    /// The tree of each movable body.
    trees: Vec<Option<usize>>,
    /// True if commands reach a simulation.
    active: bool,
    /// True if the simulation can be rewound.
    rewinds: bool,
    /// The number of environments.
    envs: usize,
}

impl Scene {
    /// Creates the scene of a model.
    pub fn new(model: &Model) -> Self {
        Scene {
            name: model.name.clone(),
            timestep: model.params.timestep,
            sections: (SECTIONS.iter())
                .map(|section| json!({"name": section.name, "width": section.width}))
                .collect(),
            stages: STAGES,
            bodies: (0..model.nbody()).map(|b| body(model, b)).collect(),
            geoms: (0..model.geoms.len()).map(|g| geom(model, g)).collect(),
            sites: (0..model.sites.len()).map(|s| site(model, s)).collect(),
            joints: (0..model.joints.len()).map(|j| joint(model, j)).collect(),
            controls: controls(model),
            tendons: (0..model.tendons.len()).map(|t| tendon(model, t)).collect(),
            equalities: (model.equalities.iter())
                .map(|equality| json!({"name": equality.name, "kind": equality.target.kind()}))
                .collect(),
            sensors: (model.sensors.iter())
                .map(
                    |s| json!({"name": s.name, "start": s.numbers.start, "count": s.numbers.len()}),
                )
                .collect(),
            keyframes: model.keyframes.iter().map(|k| k.name.clone()).collect(),
            cameras: (model.cameras.iter().zip(&model.params.cam_fovy))
                .map(|(camera, fovy)| {
                    json!({"name": camera.name, "orthographic": camera.orthographic, "fovy": fovy})
                })
                .collect(),
            lights: model.visuals.lights.iter().map(light).collect(),
            headlight: headlight(&model.visuals),
            meshes: model.meshes.iter().map(|mesh| surface(mesh)).collect(),
            height_fields: (model.height_fields.iter())
                .map(|field| {
                    let heights = field.shape.heights().iter().map(|&h| h as f32);
                    json!({
                        "rows": field.shape.rows(),
                        "columns": field.shape.columns(),
                        "size": field.shape.size(),
                        "heights": packed(heights.map(f32::to_le_bytes)),
                    })
                })
                .collect(),
            materials: materials(&model.visuals),
            textures: textures(model),
            trees: (0..model.nbody()).map(|b| model.tree_of_body(b)).collect(),
            active: true,
            rewinds: true,
            envs: 1,
        }
    }

    /// Returns the scene of `envs` independent environments.
    pub fn of_envs(self, envs: usize) -> Self {
        Scene {
            envs,
            rewinds: envs == 1,
            ..self
        }
    }

    /// Returns the scene of a simulation that stores no past states.
    pub fn without_past(self) -> Self {
        Scene {
            rewinds: false,
            ..self
        }
    }

    /// Returns the scene of a page whose commands reach no simulation.
    pub fn passive(self) -> Self {
        Scene {
            active: false,
            ..self
        }
    }

    /// Returns the scene as JSON for the page.
    pub fn to_json(&self) -> String {
        // Numbers, texts and lists of them always serialize.
        serde_json::to_string(self).unwrap_or_default()
    }
}

fn body(model: &Model, b: usize) -> Value {
    let (body, p) = (&model.bodies[b], &model.params);
    json!({
        "name": body.name,
        "parent": body.parent,
        "mass": p.body_mass[b],
        "inertia": p.body_inertia[b].to_array(),
        "ipos": p.body_ipos[b].to_array(),
        "iquat": p.body_iquat[b].to_array(),
        // True if a force can move it.
        "free": p.body_invweight0[b][0] > 0.0,
    })
}

/// Returns the MJCF keyword of a shape.
fn shape(kind: ShapeKind) -> &'static str {
    match kind {
        ShapeKind::Plane => "plane",
        ShapeKind::HeightField => "hfield",
        ShapeKind::Sphere => "sphere",
        ShapeKind::Capsule => "capsule",
        ShapeKind::Ellipsoid => "ellipsoid",
        ShapeKind::Cylinder => "cylinder",
        ShapeKind::Box => "box",
        ShapeKind::Mesh => "mesh",
    }
}

fn shape_at(
    model: &Model,
    pose: (Vec3<f64>, Quat<f64>),
    appearance: Appearance,
    (kind, size): (ShapeKind, Vec3<f64>),
) -> Value {
    json!({
        "pos": pose.0.to_array(),
        "quat": pose.1.to_array(),
        "kind": shape(kind),
        "size": size.to_array(),
        "rgba": model.visuals.rgba(appearance),
        "material": appearance.material,
        // The factor from coordinates to texture coordinates.
        "scale": surfaces::texture_scale(model, appearance, kind, size),
    })
}

/// Merges the entries of both objects.
fn merged(mut first: Value, second: Value) -> Value {
    if let (Value::Object(first), Value::Object(second)) = (&mut first, second) {
        first.extend(second);
    }
    first
}

fn geom(model: &Model, g: usize) -> Value {
    let (geom, p) = (&model.geoms[g], &model.params);
    let drawn = shape_at(
        model,
        (p.geom_pos[g], p.geom_quat[g]),
        model.visuals.geoms[g],
        (geom.kind, p.geom_size[g]),
    );
    let own = json!({
        "name": geom.name,
        "body": geom.body,
        "group": geom.group,
        "mesh": geom.mesh,
        "hfield": geom.height_field,
        "friction": p.geom_friction[g],
        "condim": geom.condim,
    });
    merged(drawn, own)
}

fn site(model: &Model, s: usize) -> Value {
    let (site, p) = (&model.sites[s], &model.params);
    let (mut pos, mut quat) = (p.site_pos[s], p.site_quat[s]);
    if let Some(mesh) = site.mesh {
        // The page stores meshes about their centres of mass, a site uses the author's coordinates.
        let mesh = &model.meshes[mesh];
        pos += quat.rotate(mesh.pos);
        quat = quat * mesh.quat;
    }
    let drawn = shape_at(
        model,
        (pos, quat),
        model.visuals.sites[s],
        (site.kind, p.site_size[s]),
    );
    let own = json!({
        "name": site.name,
        "mesh": site.mesh,
        "body": site.body,
        "group": site.group,
    });
    merged(drawn, own)
}

fn joint(model: &Model, j: usize) -> Value {
    let Joint {
        name,
        kind,
        body,
        qpos,
        dof,
        limited,
        ..
    } = &model.joints[j];
    let kind = match kind {
        JointKind::Free => "free",
        JointKind::Ball => "ball",
        JointKind::Slide => "slide",
        JointKind::Hinge => "hinge",
    };
    json!({
        "name": name,
        "kind": kind,
        "body": body,
        "qpos": qpos,
        "dof": dof,
        "range": limited.then(|| model.params.jnt_range[j]),
        "pos": model.params.jnt_pos[j].to_array(),
        "axis": model.params.jnt_axis[j].to_array(),
    })
}

fn controls(model: &Model) -> Vec<Value> {
    let of_actuator = |actuator: &clench::rigid::model::Actuator| {
        let several = actuator.controls.len() > 1;
        let one = |(k, u): (usize, usize)| {
            let name = match several {
                true => format!("{} {k}", actuator.name),
                false => actuator.name.clone(),
            };
            let limited = actuator.ctrllimited.get(k).copied().unwrap_or(false);
            json!({"name": name, "range": limited.then(|| model.params.actuator_ctrlrange[u])})
        };
        (actuator.controls.clone().enumerate())
            .map(one)
            .collect::<Vec<_>>()
    };
    model.actuators.iter().flat_map(of_actuator).collect()
}

fn light(light: &Light) -> Value {
    let properties = &light.properties;
    json!({
        "name": light.name,
        "kind": match properties.kind {
            LightKind::Spot => "spot",
            LightKind::Directional => "directional",
            LightKind::Point => "point",
        },
        "active": properties.active,
        "castshadow": properties.castshadow,
        "attenuation": properties.attenuation,
        "cutoff": properties.cutoff,
        "exponent": properties.exponent,
        "ambient": properties.ambient,
        "diffuse": properties.diffuse,
    })
}

fn headlight(visuals: &Visuals) -> Value {
    let head = &visuals.headlight;
    json!({"active": head.active, "ambient": head.ambient, "diffuse": head.diffuse})
}

fn tendon(model: &Model, t: usize) -> Value {
    let visuals = &model.visuals;
    json!({
        "name": model.tendons[t].name,
        "rgba": visuals.rgba(visuals.tendons[t]),
        "width": visuals.tendon_width[t],
    })
}

/// Encodes vertices and triangles of a mesh, and the triangles of its hull if it has one.
fn surface(mesh: &Mesh) -> Value {
    let numbers = |points: &[Vec3<f64>]| {
        let numbers = points.iter().flat_map(|v| v.to_array());
        packed(numbers.map(|x| (x as f32).to_le_bytes()))
    };
    let corners = |faces: &[[u32; 3]]| packed(faces.iter().flatten().map(|i| i.to_le_bytes()));
    let hull = mesh.hull.as_ref().map(|hull| {
        // Each polygonal face is drawn as a fan of triangles.
        let fans = (0..hull.face_count()).flat_map(|f| {
            let corners = hull.corners(f);
            let pairs = corners.windows(2).skip(1);
            pairs.map(|pair| [corners[0], pair[0], pair[1]])
        });
        let fans: Vec<_> = fans.collect();
        json!({"vertices": numbers(hull.vertices()), "faces": corners(&fans)})
    });
    json!({
        "name": mesh.name,
        "vertices": numbers(&mesh.vertices),
        "faces": corners(&mesh.faces),
        "texcoords": texcoords(mesh),
        "hull": hull,
    })
}

/// Encodes the texture coordinates of each corner of each triangle, if the mesh has any.
fn texcoords(mesh: &Mesh) -> Option<String> {
    let corners = mesh.face_texcoords.as_flattened().iter();
    let places = corners.flat_map(|&corner| mesh.texcoords[corner as usize]);
    (!mesh.texcoords.is_empty()).then(|| packed(places.map(f32::to_le_bytes)))
}

/// Encodes numbers of four bytes each in base 64.
fn packed(numbers: impl Iterator<Item = [u8; 4]>) -> String {
    base64::encode(&numbers.flatten().collect::<Vec<u8>>())
}

fn materials(visuals: &Visuals) -> Vec<Value> {
    let material = |material: &clench::rigid::model::Material| {
        json!({
            "texture": material.texture,
            "emission": material.emission,
            "specular": material.specular,
            "shininess": material.shininess,
            "reflectance": material.reflectance,
        })
    };
    visuals.materials.iter().map(material).collect()
}

/// Encodes the textures; the images of unused ones are empty.
fn textures(model: &Model) -> Vec<Value> {
    let visuals = &model.visuals;
    let seen = visuals.geoms.iter().chain(&visuals.sites);
    let used: BTreeSet<usize> = seen.filter_map(|&a| surfaces::texture(model, a)).collect();
    let texture = |(index, texture): (usize, &Texture)| {
        let shown = used.contains(&index);
        json!({
            "kind": match texture.kind {
                TextureKind::Plane => "plane",
                TextureKind::Cube => "cube",
                TextureKind::Sky => "sky",
            },
            "png": if shown { base64::encode(&surfaces::png(texture)) } else { String::new() },
        })
    };
    visuals.textures.iter().enumerate().map(texture).collect()
}
