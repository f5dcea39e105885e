//! A body's mass, centre of mass and principal moments, from the author or from its geoms.

use super::element::Element;
use super::placed::{Assets, PlacedGeom};
use super::shapes;
use super::{
    BodySpec, BuildError, CompilerSpec, GeomMass, InertiaFromGeom, InertiaSpec, InertialSpec,
};
use clench_math::{Inertia, Mat3, Quat, Vec3, principal_axes};

/// Masses of geoms (kg), volumes (m³) and principal moments (kg m²) below this count as zero (MuJoCo's `mjEPS`).
const NEGLIGIBLE: f64 = 1e-14;

/// Mass properties of a body, in its frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct MassProperties {
    pub mass: f64,
    /// Centre of mass.
    pub pos: Vec3<f64>,
    /// Orientation of the principal frame.
    pub quat: Quat<f64>,
    /// Principal moments.
    pub moments: Vec3<f64>,
}

impl MassProperties {
    /// The mass properties of the world.
    pub(super) const NONE: Self = MassProperties {
        mass: 0.0,
        pos: Vec3::ZERO,
        quat: Quat::IDENTITY,
        moments: Vec3::ZERO,
    };
}

/// Returns the mass properties of a body other than the world; `name` is its name in messages.
///
/// # Errors
/// Returns an error if masses or inertias are negative, not finite, or impossible.
pub(super) fn mass_properties(
    body: &BodySpec,
    name: &str,
    compiler: &CompilerSpec,
    assets: &Assets,
) -> Result<MassProperties, BuildError> {
    let found = unbounded_mass_properties(body, name, compiler, assets)?;
    plausible(body, found, compiler).map_err(|e| e.about(name))
}

/// Does the same as [`mass_properties`], before bounds are applied and inertias balanced.
///
/// # Errors
/// Returns the same errors, except for impossible inertias.
pub(super) fn unbounded_mass_properties(
    body: &BodySpec,
    name: &str,
    compiler: &CompilerSpec,
    assets: &Assets,
) -> Result<MassProperties, BuildError> {
    let from_geoms = match compiler.inertiafromgeom {
        InertiaFromGeom::Always => true,
        InertiaFromGeom::Auto => body.inertial.is_none(),
        InertiaFromGeom::Never => false,
    };
    let counted = match from_geoms {
        true => geoms_with_mass(body, compiler, assets).map_err(|e| e.of_body(name))?,
        false => Vec::new(),
    };
    let found = match (&counted[..], &body.inertial) {
        ([], Some(inertial)) => specified(body, inertial, compiler),
        // Without data MuJoCo puts the inertial frame at the body's offset from its parent, or from its innermost
        // <frame>.
        ([], None) => {
            let (pos, quat) = body.written.unwrap_or((body.pos, body.quat));
            Ok(MassProperties {
                pos,
                quat: quat.normalize(),
                ..MassProperties::NONE
            })
        }
        ([one], _) => Ok(*one),
        (many, _) => combine(body, many, compiler),
    };
    found.map_err(|e| e.about(name))
}

/// Returns the geoms that count towards inertia.
fn geoms_with_mass(
    body: &BodySpec,
    compiler: &CompilerSpec,
    assets: &Assets,
) -> Result<Vec<MassProperties>, BuildError> {
    let [first, last] = compiler.inertiagrouprange;
    let mut counted = Vec::new();
    for geom in &body.geoms {
        if (first..=last).contains(&geom.group) {
            let geom = assets.place(geom)?;
            let mass = geom_mass(&geom)?;
            if mass > NEGLIGIBLE {
                counted.push(MassProperties {
                    mass,
                    pos: geom.pos,
                    quat: geom.quat,
                    moments: shapes::moments(&geom, mass),
                });
            }
        }
    }
    Ok(counted)
}

fn geom_mass(geom: &PlacedGeom) -> Result<f64, BuildError> {
    let measure = shapes::measure(geom);
    let mass = match geom.spec.mass {
        GeomMass::Mass(mass) if mass == 0.0 || measure > NEGLIGIBLE => mass,
        GeomMass::Mass(_) => 0.0,
        GeomMass::Density(density) => density * measure,
    };
    geom.spec.require_not_negative("mass", &[mass])?;
    Ok(mass)
}

/// Returns the author's mass properties, in the principal frame.
fn specified(
    body: &BodySpec,
    inertial: &InertialSpec,
    compiler: &CompilerSpec,
) -> Result<MassProperties, BuildError> {
    let (moments, quat) = match inertial.inertia {
        InertiaSpec::Diagonal(moments) => (Vec3::from_array(moments), inertial.quat.normalize()),
        InertiaSpec::Full(full) => principal(body, full, compiler)?,
    };
    Ok(MassProperties {
        mass: inertial.mass,
        pos: inertial.pos,
        quat,
        moments,
    })
}

/// Combines several geoms: masses add, and so do inertias about the common centre of mass.
///
/// # Errors
/// Returns an error if inertias are not positive.
pub(super) fn combine(
    body: &BodySpec,
    geoms: &[MassProperties],
    compiler: &CompilerSpec,
) -> Result<MassProperties, BuildError> {
    let mut mass = 0.0;
    let mut moment = Vec3::ZERO;
    for geom in geoms {
        mass += geom.mass;
        moment += geom.pos * geom.mass;
    }
    let pos = moment * (1.0 / mass);
    let mut total = Inertia::ZERO;
    for geom in geoms {
        let axes = geom.quat.to_matrix();
        total += Inertia::from_principal(geom.moments, &axes, geom.pos - pos, geom.mass);
    }
    let (moments, quat) = principal(body, total.rotational, compiler)?;
    Ok(MassProperties {
        mass,
        pos,
        quat,
        moments,
    })
}

/// Computes principal moments and frame of a full inertia: xx, yy, zz, xy, xz, yz.
fn principal(
    body: &BodySpec,
    full: [f64; 6],
    compiler: &CompilerSpec,
) -> Result<(Vec3<f64>, Quat<f64>), BuildError> {
    body.require_finite("inertia", &full)?;
    let [xx, yy, zz, xy, xz, yz] = full;
    let (moments, quat) =
        principal_axes(&Mat3::from_f64([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]));
    // `boundinertia` raises a vanishing moment; a negative one is an error whatever the bound.
    let least = match compiler.boundinertia > 0.0 {
        true => -NEGLIGIBLE,
        false => NEGLIGIBLE,
    };
    if moments.z < least {
        return Err(body.error(format!(
            "inertia must be positive definite, but its smallest principal moment is {:?}",
            moments.z
        )));
    }
    Ok((moments, quat))
}

/// Applies bounds, then checks the triangle inequality: no moment exceeds the sum of the other two.
fn plausible(
    body: &BodySpec,
    mut found: MassProperties,
    compiler: &CompilerSpec,
) -> Result<MassProperties, BuildError> {
    found.mass = found.mass.max(compiler.boundmass);
    for axis in 0..3 {
        found.moments[axis] = found.moments[axis].max(compiler.boundinertia);
    }
    body.require_not_negative("mass", &[found.mass])?;
    body.require_not_negative("inertia", &found.moments.to_array())?;
    let [a, b, c] = found.moments.to_array();
    if a + b < c || a + c < b || b + c < a {
        if !compiler.balanceinertia {
            return Err(body.error(format!(
                "no body has the principal moments {a}, {b}, {c}: the sum of two is never below the third \
                 (balanceinertia would replace them by their mean)"
            )));
        }
        let mean = (a + b + c) / 3.0;
        found.moments = Vec3::new(mean, mean, mean);
    }
    Ok(found)
}
