//! The JSON that `forward` reads: states. Errors name the field and the index of a value.

use anyhow::{Error, Result, anyhow, bail, ensure};
use clench::Sim;
use clench::math::{Force, Mat3, Quat, Vec3};
use clench::rigid::contact::Contact;
use clench::rigid::state::State;
use clench::rigid::state::kind::{self, Kind, StickReference};
use serde_json::{Map, Value};
use std::fmt::Display;

/// Fields of a contact that MuJoCo derives from the others, and Clench's `force`: ignored, so that a whole mjContact or
/// a contact of a result can be passed.
const IGNORED: [&str; 9] = [
    "mu",
    "H",
    "geom1",
    "geom2",
    "flex",
    "elem",
    "vert",
    "efc_address",
    "force",
];

/// A JSON object of which fields are read one by one.
struct Fields<'a>(&'a Map<String, Value>);

impl Fields<'_> {
    fn of<'a>(value: &'a Value, what: &str) -> Result<Fields<'a>> {
        let object = value.as_object();
        object
            .map(Fields)
            .ok_or_else(|| anyhow!("{what} is an object in braces"))
    }

    /// Returns an error if there is a field that is not in the list.
    fn check_names(&self, names: &[&str]) -> Result<()> {
        let unknown = self.0.keys().find(|key| !names.contains(&key.as_str()));
        match unknown {
            None => Ok(()),
            Some(key) => bail!("unknown field {key}; the fields are {}", names.join(", ")),
        }
    }

    /// Reads a field that may be missing or null.
    fn read<T>(&self, name: &str, read: impl FnOnce(&Value) -> Result<T>) -> Result<Option<T>> {
        let value = self.0.get(name).filter(|value| !value.is_null());
        let value = value.map(|value| read(value).map_err(|error| at(name, error)));
        value.transpose()
    }

    /// Reads a field that must be there.
    fn require<T>(&self, name: &str, read: impl FnOnce(&Value) -> Result<T>) -> Result<T> {
        let value = self.read(name, read)?;
        value.ok_or_else(|| anyhow!("the field {name} is missing"))
    }
}

/// Adds a place to an error.
fn at(place: impl Display, error: Error) -> Error {
    error.context(place.to_string())
}

fn number(value: &Value) -> Result<f64> {
    value
        .as_f64()
        .ok_or_else(|| anyhow!("{value} is not a number"))
}

fn integer(value: &Value) -> Result<i64> {
    value
        .as_i64()
        .ok_or_else(|| anyhow!("{value} is not an integer"))
}

/// Reads each item of a list.
fn list<T>(value: &Value, read: impl Fn(&Value) -> Result<T>) -> Result<Vec<T>> {
    let items = value.as_array();
    let items = items.ok_or_else(|| anyhow!("{value} is not a list"))?;
    let read = |(i, item)| read(item).map_err(|error| at(format_args!("item {i}"), error));
    items.iter().enumerate().map(read).collect()
}

fn numbers<const N: usize>(value: &Value) -> Result<[f64; N]> {
    let found = list(value, number)?;
    let length = found.len();
    found
        .try_into()
        .map_err(|_| anyhow!("{length} numbers, not {N}"))
}

/// The JSON representation of a state's element.
trait Written: Kind {
    /// Reads an element from its JSON value: a number, a list of numbers, or a truth value.
    fn read(json: &Value) -> Result<Self::Of<f64>>;
}

impl Written for kind::Number {
    fn read(json: &Value) -> Result<f64> {
        number(json)
    }
}
impl Written for kind::Integer {
    fn read(json: &Value) -> Result<f64> {
        integer(json).map(|x| x as f64)
    }
}
impl Written for kind::Vector {
    fn read(json: &Value) -> Result<Vec3<f64>> {
        numbers(json).map(Vec3::from_array)
    }
}
impl Written for kind::Quaternion {
    fn read(json: &Value) -> Result<Quat<f64>> {
        numbers(json).map(Quat::from_f64)
    }
}
/// Force and torque, as in MuJoCo.
impl Written for kind::Wrench {
    fn read(json: &Value) -> Result<Force<f64>> {
        let [fx, fy, fz, tx, ty, tz] = numbers(json)?;
        Ok(Force::new(Vec3::new(tx, ty, tz), Vec3::new(fx, fy, fz)))
    }
}
/// The geoms, each plus one, then position and orientation.
impl Written for kind::Reference {
    fn read(json: &Value) -> Result<StickReference<f64>> {
        let [first, second, x, y, z, quat @ ..] = numbers::<9>(json)?;
        Ok(StickReference {
            first,
            second,
            position: Vec3::new(x, y, z),
            rotation: Quat::from_f64(quat),
        })
    }
}
/// `true`, `false`, or a number that is not zero, as MuJoCo stores flags.
impl Written for kind::Truth {
    fn read(json: &Value) -> Result<bool> {
        match json {
            Value::Bool(truth) => Ok(*truth),
            _ => number(json).map(|x| x != 0.0),
        }
    }
}

macro_rules! declare_line {
    ($($group:ident { $(
        $(#[$doc:meta])* $name:ident $setter:ident: $kind:ident, $size:ident, $bound:ident;
    )* })*) => {
        const FIELDS: &[&str] = &["time", $($(stringify!($name),)*)* "contacts"];

        /// Sets the given fields.
        fn assign_fields(fields: &Fields, state: &mut State<f64>) -> Result<()> {
            $($(assign::<kind::$kind>(fields, stringify!($name), &mut state.$name)?;)*)*
            Ok(())
        }
    };
}
clench::rigid::state_fields!(declare_line);

fn assign<K: Written>(fields: &Fields, name: &str, target: &mut Vec<K::Of<f64>>) -> Result<()> {
    let Some(values) = fields.read(name, |value| list(value, K::read))? else {
        return Ok(());
    };
    ensure!(
        values.len() == target.len(),
        "{name}: {} values given, the model has {}",
        values.len(),
        target.len()
    );
    *target = values;
    Ok(())
}

/// Sets the state of a simulation that is at its defaults from one line of standard input; missing fields keep their
/// values. Returns the contacts that replace collision detection.
pub fn apply(line: &str, sim: &mut Sim) -> Result<Option<Vec<Contact<f64>>>> {
    let value = serde_json::from_str(line)?;
    let fields = Fields::of(&value, "a state")?;
    fields.check_names(FIELDS)?;
    if let Some(time) = fields.read("time", number)? {
        sim.state.time = time;
    }
    assign_fields(&fields, &mut sim.state)?;
    fields.read("contacts", |value| list(value, |value| contact(value, sim)))
}

/// Reads a contact with the fields of MuJoCo's `mjContact`.
fn contact(value: &Value, sim: &Sim) -> Result<Contact<f64>> {
    const READ: [&str; 13] = [
        "geom",
        "dist",
        "pos",
        "frame",
        "includemargin",
        "friction",
        "solref",
        "solreffriction",
        "solimp",
        "dim",
        "exclude",
        "surfacevel",
        "adhesion",
    ];
    let fields = Fields::of(value, "a contact")?;
    fields.check_names(&[&READ[..], &IGNORED[..]].concat())?;
    let geoms = fields.require("geom", |value| geoms(value, sim))?;
    let dim = fields.require("dim", integer)?;
    ensure!(
        matches!(dim, 1 | 3 | 4 | 6),
        "dim: {dim} is not 1, 3, 4 or 6"
    );
    let (dist, includemargin) = (
        fields.require("dist", number)?,
        fields.require("includemargin", number)?,
    );
    let frame = fields.require("frame", numbers::<9>)?;
    let [normal, first, second] = [0, 3, 6].map(|start| Vec3::from_slice(&frame[start..]));
    Ok(Contact {
        geoms,
        active: match fields.read("exclude", integer)?.unwrap_or(0) {
            0 => true,
            // In the gap, where it creates no constraint, and sensors include it.
            1 => dist >= includemargin,
            // No dof is between its bodies: they move as one, or neither has dofs, as a mocap body and the world.
            3 => {
                let model = sim.model();
                let [first, second] = geoms.map(|g| model.bodies[model.geoms[g].body].weld);
                let stands = |body: usize| model.bodies[body].dofs.is_empty();
                first == second || stands(first) && stands(second)
            }
            _ => false,
        },
        dim: dim as usize,
        dist,
        pos: Vec3::from_array(fields.require("pos", numbers)?),
        frame: Mat3::from_rows(normal, first, second),
        includemargin,
        friction: fields.require("friction", numbers)?,
        solref: fields.require("solref", numbers)?,
        solreffriction: fields.read("solreffriction", numbers)?.unwrap_or_default(),
        solimp: fields.require("solimp", numbers)?,
        adhesion: fields.read("adhesion", number)?.unwrap_or_default(),
        surfacevel: fields.read("surfacevel", numbers)?.unwrap_or_default(),
        block: None,
    })
}

/// Reads the two geoms of a contact.
fn geoms(value: &Value, sim: &Sim) -> Result<[usize; 2]> {
    let ngeom = sim.model().geoms.len();
    let geom = |value: &Value| match integer(value).map(usize::try_from)? {
        Ok(geom) if geom < ngeom => Ok(geom),
        _ => bail!("{value} is not one of the model's {ngeom} geoms"),
    };
    let found = list(value, geom)?;
    found
        .try_into()
        .map_err(|_| anyhow!("two geoms are needed"))
}
