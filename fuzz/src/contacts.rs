//! Contacts from a user instead of collision detection.

use crate::trial::{check_result, machine};
use clench::math::{Mat3, Vec3};
use clench::rigid::contact::Contact;
use clench::{Model, Sim};
use std::sync::{Arc, LazyLock};

/// The bytes of a contact: two geoms, a dimension, and its numbers in single precision.
const CONTACT: usize = 3 + 4 * NUMBERS;
const NUMBERS: usize = 32;

/// Reads contacts from the bytes, and computes with them.
pub fn contacts(data: &[u8]) -> bool {
    static MACHINE: LazyLock<Arc<Model>> = LazyLock::new(machine);
    let (whole, _) = data.as_chunks::<CONTACT>();
    let contacts: Vec<_> = whole.iter().map(contact).collect();
    let mut sim = Sim::<f64>::new(MACHINE.clone()).expect("our own model");
    let accepted = sim.forward_with_contacts(&contacts).is_ok();
    if accepted {
        check_result(&sim);
    }
    accepted
}

fn contact(bytes: &[u8; CONTACT]) -> Contact<f64> {
    let [first, second, dim, rest @ ..] = bytes;
    let mut numbers = rest
        .as_chunks::<4>()
        .0
        .iter()
        .map(|&bytes| f64::from(f32::from_le_bytes(bytes)));
    let mut next = || numbers.next().unwrap_or_default();
    let mut vector = || Vec3::new(next(), next(), next());
    let (pos, x, y, z) = (vector(), vector(), vector(), vector());
    Contact {
        geoms: [usize::from(*first), usize::from(*second)],
        active: dim & 0x80 == 0,
        dim: usize::from(dim & 0x7f),
        pos,
        frame: Mat3::from_rows(x, y, z),
        dist: next(),
        includemargin: next(),
        friction: std::array::from_fn(|_| next()),
        solref: [next(), next()],
        solreffriction: [next(), next()],
        solimp: std::array::from_fn(|_| next()),
        adhesion: next(),
        surfacevel: std::array::from_fn(|_| next()),
        block: None,
    }
}
