//! `<compiler>`: settings for reading the file (units, order of rotations) and for deriving omitted values.

use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{CompilerSpec, InertiaFromGeom, LengthRangeMode, LengthRangeSpec};
use clench_math::{Quat, Vec3};

/// The treatment of options of attached models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Conflict {
    /// They are omitted, with a note.
    Warning,
    /// They are merged if possible.
    Merge,
    /// They must not contradict those of the model itself.
    Error,
}

/// The settings for reading the file.
#[derive(Clone, Debug)]
pub(crate) struct CompilerOptions {
    pub degrees: bool,
    /// The axes of the three Euler rotations; lower case: moving axes, upper case: fixed axes.
    pub eulerseq: [char; 3],
    /// The folder of mesh and height field files, relative to the model.
    pub meshdir: String,
    /// The folder of texture files.
    pub texturedir: String,
    /// True if only the last component of a file's path is used.
    pub strippath: bool,
    /// The treatment of options of attached models.
    pub conflict: Conflict,
}

impl Default for CompilerOptions {
    fn default() -> Self {
        CompilerOptions {
            degrees: true,
            eulerseq: ['x', 'y', 'z'],
            meshdir: String::new(),
            texturedir: String::new(),
            strippath: false,
            conflict: Conflict::Warning,
        }
    }
}

impl CompilerOptions {
    /// Converts an angle of the file to radians.
    pub(crate) fn radians(&self, angle: f64) -> f64 {
        if self.degrees {
            angle.to_radians()
        } else {
            angle
        }
    }

    /// Returns the rotation by three angles of the file.
    pub(crate) fn euler(&self, angles: [f64; 3]) -> Quat<f64> {
        let mut total = Quat::IDENTITY;
        for (angle, name) in angles.into_iter().zip(self.eulerseq) {
            let axis = match name.to_ascii_lowercase() {
                'x' => Vec3::new(1.0, 0.0, 0.0),
                'y' => Vec3::new(0.0, 1.0, 0.0),
                _ => Vec3::new(0.0, 0.0, 1.0),
            };
            let rotation = Quat::from_axis_angle(axis, self.radians(angle));
            total = if name.is_ascii_lowercase() {
                total * rotation
            } else {
                rotation * total
            };
        }
        total.normalize()
    }

    fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        element.set_keyword(
            "angle",
            &[("radian", false), ("degree", true)],
            &mut self.degrees,
        )?;
        for (name, target) in [
            ("meshdir", &mut self.meshdir),
            ("texturedir", &mut self.texturedir),
        ] {
            if let Some(directory) = element.text(name).or(element.text("assetdir")) {
                directory.clone_into(target);
            }
        }
        element.set_boolean("strippath", &mut self.strippath)?;
        let conflicts = [
            ("warning", Conflict::Warning),
            ("merge", Conflict::Merge),
            ("error", Conflict::Error),
        ];
        element.set_keyword("conflict", &conflicts, &mut self.conflict)?;
        if let Some(text) = element.text("eulerseq") {
            let axes: Vec<char> = text.chars().filter(|c| "xyzXYZ".contains(*c)).collect();
            let axes = <[char; 3]>::try_from(axes).ok().filter(|_| text.len() == 3);
            self.eulerseq =
                axes.ok_or_else(|| element.error("eulerseq needs three of x, y, z, X, Y, Z"))?;
        }
        Ok(())
    }
}

/// Reads one `<compiler>`; it overrides values of earlier ones.
pub(crate) fn read(
    element: &Element,
    compiler: &mut CompilerOptions,
    spec: &mut CompilerSpec,
) -> Result<(), LoadError> {
    compiler.read(element)?;
    if element.keyword("coordinate", &[("local", false), ("global", true)])? == Some(true) {
        return Err(element.error(
            "global coordinates were removed from MJCF; convert the model with MuJoCo 2.3.3",
        ));
    }
    element.set_boolean("autolimits", &mut spec.autolimits)?;
    element.refuse_negative(&["boundmass", "boundinertia"])?;
    element.set_number("boundmass", &mut spec.boundmass)?;
    element.set_number("boundinertia", &mut spec.boundinertia)?;
    if let Some([mass]) = element.numbers("settotalmass")? {
        spec.settotalmass = (mass > 0.0).then_some(mass);
    }
    element.set_boolean("balanceinertia", &mut spec.balanceinertia)?;
    let sources = [
        ("false", InertiaFromGeom::Never),
        ("true", InertiaFromGeom::Always),
        ("auto", InertiaFromGeom::Auto),
    ];
    element.set_keyword("inertiafromgeom", &sources, &mut spec.inertiafromgeom)?;
    let groups = element.text("inertiagrouprange");
    if groups.is_some_and(|groups| !groups.trim().is_empty()) {
        let groups = element.integers("inertiagrouprange")?;
        let wrong = |_| element.error("inertiagrouprange needs two integers");
        spec.inertiagrouprange = groups.try_into().map_err(wrong)?;
    }
    element.set_boolean("alignfree", &mut spec.alignfree)?;
    element.set_boolean("fitaabb", &mut spec.fitaabb)?;
    element.set_boolean("discardvisual", &mut spec.discardvisual)?;
    element.set_boolean("fusestatic", &mut spec.fusestatic)?;
    let lengthrange = element
        .children
        .iter()
        .find(|child| child.tag == "lengthrange");
    lengthrange.map_or(Ok(()), |child| {
        read_length_range(child, &mut spec.lengthrange)
    })
}

fn read_length_range(element: &Element, spec: &mut LengthRangeSpec) -> Result<(), LoadError> {
    let modes = [
        ("none", LengthRangeMode::None),
        ("muscle", LengthRangeMode::Muscle),
        ("muscleuser", LengthRangeMode::MuscleUser),
        ("all", LengthRangeMode::All),
    ];
    element.set_keyword("mode", &modes, &mut spec.mode)?;
    element.set_boolean("useexisting", &mut spec.useexisting)?;
    element.set_boolean("uselimit", &mut spec.uselimit)?;
    element.set_number("accel", &mut spec.accel)?;
    element.set_number("maxforce", &mut spec.maxforce)?;
    element.set_number("timeconst", &mut spec.timeconst)?;
    element.set_number("timestep", &mut spec.timestep)?;
    element.set_number("inttotal", &mut spec.inttotal)?;
    element.set_number("interval", &mut spec.interval)?;
    element.set_number("tolrange", &mut spec.tolrange)
}
