//! A sensor of every kind.

use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{
    CameraLens, CameraSpec, CameraTracking, ContactQuerySpec, ContactSideName, FrameKind,
    FrameName, GeomsName, MeshSpec, ModelBuilder, SensorSpec, SensorSubject, SiteSpec,
};
use clench_rigid::model::{
    Attachment, ContactField, ContactReduction, RayField, SensorData, SensorKind,
};

/// Returns a camera of every kind, on the trunk.
fn cameras() -> impl Iterator<Item = CameraSpec> {
    let modes = [
        ("fixed", CameraTracking::Fixed),
        ("track", CameraTracking::Track),
        ("trackcom", CameraTracking::TrackCom("hand".into())),
        ("target", CameraTracking::TargetBody("hand".into())),
        ("targetcom", CameraTracking::TargetBodyCom("arm".into())),
    ];
    modes
        .into_iter()
        .enumerate()
        .map(|(i, (name, tracking))| CameraSpec {
            name: name.into(),
            pos: Vec3::from_f64([0.3, 0.1 * i as f64, 0.2]),
            quat: Quat::new(0.8, 0.36, 0.0, 0.48),
            tracking,
            orthographic: i == 1,
            lens: match i {
                2 => CameraLens::Intrinsic {
                    sensorsize: [0.03, 0.02],
                    focal: [0.02, 0.03],
                    principal: [0.001, 0.002],
                },
                _ => CameraLens::FieldOfView(if i == 1 { 0.5 } else { 50.0 }),
            },
            resolution: [3, 2],
            ..CameraSpec::default()
        })
}

/// Returns contact sensors by geom, body, subtree and site, in every order.
fn contact_queries() -> impl Iterator<Item = SensorSubject> {
    let reductions = [
        (ContactReduction::None, 3),
        (ContactReduction::MinDist, 2),
        (ContactReduction::MaxForce, 4),
        (ContactReduction::NetForce, 1),
    ];
    let sides = [
        [ContactSideName::Any, ContactSideName::Any],
        [
            ContactSideName::Subtree("trunk".into()),
            ContactSideName::Body("world".into()),
        ],
    ];
    reductions.into_iter().flat_map(move |(reduction, count)| {
        let told = |field: &ContactField| {
            let moves = matches!(field, ContactField::LinVel | ContactField::AngVel);
            !moves || reduction != ContactReduction::NetForce
        };
        let fields: Vec<_> = ContactField::ALL.iter().copied().filter(told).collect();
        let query = move |sides, site: &str| {
            SensorSubject::Contacts(ContactQuerySpec {
                sides,
                site: site.into(),
                fields: fields.clone(),
                reduction,
                count,
            })
        };
        let [any, between] = sides.clone();
        [
            query(any.clone(), ""),
            query(between, ""),
            query(any, "imu"),
        ]
    })
}

/// Adds a mesh with tangents, and names the geoms of its tactile sensors.
fn add_skin(b: &mut ModelBuilder) {
    let corners = [
        [-0.3, -0.3, -0.3],
        [0.4, 0.0, 0.0],
        [0.0, 0.4, 0.0],
        [0.0, 0.0, 0.4],
    ];
    let tangents = [Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, 0.6, -0.8)];
    b.meshes.push(MeshSpec {
        name: "skin".into(),
        vertices: corners.map(Vec3::from_f64).to_vec(),
        tangents: vec![tangents; corners.len()],
        ..MeshSpec::default()
    });
    for name in ["trunk", "hand"] {
        let body = b.bodies.iter_mut().find(|found| found.name == name);
        body.expect("it is there").geoms[0].name = name.into();
    }
}

/// Adds a sensor of every kind to [`everything`](super::everything), frame sensors with and without a reference.
pub fn add(b: &mut ModelBuilder) {
    let trunk = b.bodies.iter_mut().find(|found| found.name == "trunk");
    trunk.expect("it is there").cameras.extend(cameras());
    let sites = [
        ("trunk", "imu", ShapeKind::Box, [0.12, 0.22, 0.15]),
        ("hand", "palm", ShapeKind::Ellipsoid, [0.15, 0.2, 0.12]),
    ];
    for (body, name, kind, size) in sites {
        let body = b.bodies.iter_mut().find(|found| found.name == body);
        body.expect("it is there").sites.push(SiteSpec {
            name: name.into(),
            pos: Vec3::from_f64([0.03, -0.02, -0.04]),
            quat: Quat::new(0.8, 0.36, 0.0, 0.48),
            kind,
            size,
            ..SiteSpec::default()
        });
    }
    add_skin(b);
    let frame = |kind, name: &str| FrameName {
        kind,
        name: name.into(),
    };
    for &kind in SensorKind::ALL {
        let element = match kind.attachment() {
            Attachment::Site => "palm",
            Attachment::ScalarJoint => "slide",
            Attachment::Ball => "ball",
            Attachment::Joint => "elbow",
            Attachment::Tendon => "span",
            Attachment::Actuator => &b.actuators[0].name,
            _ => "arm",
        };
        let mut sensor = SensorSpec::new(kind, element);
        let object = frame(FrameKind::Inertial, "hand");
        match kind.attachment() {
            Attachment::Nothing => sensor.subject = SensorSubject::Nothing,
            Attachment::Frame => {
                sensor.subject = SensorSubject::Frame {
                    object: object.clone(),
                    reference: Some(frame(FrameKind::Site, "imu")),
                };
                b.sensors.push(sensor.clone());
                sensor.subject = SensorSubject::Frame {
                    object,
                    reference: None,
                };
            }
            Attachment::WorldFrame => {
                sensor.subject = SensorSubject::Frame {
                    object: frame(FrameKind::Body, "arm"),
                    reference: None,
                };
            }
            Attachment::Inside => {
                let inside = |object, enclosed| SensorSubject::Inside {
                    site: "palm".into(),
                    object,
                    enclosed,
                };
                for object in [
                    frame(FrameKind::Body, "arm"),
                    frame(FrameKind::Inertial, "hand"),
                    frame(FrameKind::Site, "imu"),
                ] {
                    sensor.subject = inside(object, true);
                    b.sensors.push(sensor.clone());
                }
                sensor.subject = inside(object, false);
            }
            Attachment::Geoms => {
                sensor.subject = SensorSubject::Geoms([
                    GeomsName::Body("trunk".into()),
                    GeomsName::Body("hand".into()),
                ]);
                sensor.cutoff = f64::from(u8::from(kind == SensorKind::Distance));
            }
            Attachment::Projection => {
                for camera in cameras() {
                    sensor.subject = SensorSubject::Projection {
                        site: "palm".into(),
                        camera: camera.name,
                    };
                    b.sensors.push(sensor.clone());
                }
            }
            Attachment::Rays => {
                let sources = cameras().map(|camera| frame(FrameKind::Camera, &camera.name));
                for source in sources.chain([frame(FrameKind::Site, "palm")]) {
                    sensor.subject = SensorSubject::Rays {
                        source,
                        fields: RayField::ALL.to_vec(),
                    };
                    b.sensors.push(sensor.clone());
                }
            }
            Attachment::Contacts => {
                for query in contact_queries() {
                    sensor.subject = query;
                    b.sensors.push(sensor.clone());
                }
            }
            Attachment::Taxels => {
                for geom in ["trunk", "hand"] {
                    sensor.subject = SensorSubject::Taxels {
                        mesh: "skin".into(),
                        geom: geom.into(),
                    };
                    b.sensors.push(sensor.clone());
                }
            }
            Attachment::User => sensor.subject = SensorSubject::User(2, SensorData::Real),
            _ => {}
        }
        b.sensors.push(sensor);
    }
}
