//! The parameters of a contact, mixed from those of its geoms by MuJoCo 4.0's rules.
//!
//! Margins and gaps add up: a contact is listed if dist ≤ margin + gap and carries force if dist < margin. The geom of
//! higher priority determines all other parameters; at equal priority, condim and friction take the larger value,
//! solref and solimp the average weighted by solmix, and adhesion the sum. A solref in direct format (not both
//! positive) takes the smaller of each number, hence the stiffer, since an average would be meaningless. An explicit
//! pair has its own parameters. The model's override replaces margin, solref, solreffriction, solimp and friction of
//! every contact.

use super::Candidate;
use crate::model::{Model, Params};
use clench_math::{Mask, Real, array};

/// Weights below this count as zero while stepping (MuJoCo's `mjMINVAL`).
const MIN_WEIGHT: f64 = 1e-15;
/// The minimum friction coefficient (MuJoCo's `mjMINMU`).
const MIN_FRICTION: f64 = 1e-5;

/// The parameters of a contact from its geoms or pair; fields as in [`Contact`](super::Contact).
#[derive(Clone, Copy, Debug)]
pub struct ContactParams<T> {
    /// Dimensions.
    pub dim: usize,
    /// The margin within which the contact carries force, m.
    pub includemargin: T,
    /// Two slides, spin, two rolls.
    pub friction: [T; 5],
    /// Reference dynamics.
    pub solref: [T; 2],
    /// Reference dynamics of the friction dimensions; equal to `solref` if both are zero.
    pub solreffriction: [T; 2],
    /// Impedance.
    pub solimp: [T; 5],
    /// The force with which the contact adheres, N.
    pub adhesion: T,
}

/// Returns the margin of a pair and the distance within which its contacts are listed (margin + gap), m.
#[inline(always)]
pub fn contact_range<T: Real>(model: &Model, params: &Params<T>, pair: &Candidate) -> (T, T) {
    let (margin, gap) = match pair.pair {
        Some(p) => (params.pair_margin[p as usize], params.pair_gap[p as usize]),
        None => {
            let [a, b] = pair.geoms.map(|g| g as usize);
            let (margin, gap) = (&params.geom_margin, &params.geom_gap);
            (margin[a] + margin[b], gap[a] + gap[b])
        }
    };
    let margin = if model.override_contacts {
        params.override_margin
    } else {
        margin
    };
    (margin, margin + gap)
}

/// Returns the parameters of every contact of a pair.
#[inline(always)]
pub fn contact_params<T: Real>(
    model: &Model,
    params: &Params<T>,
    pair: &Candidate,
) -> ContactParams<T> {
    let mut mixed = match pair.pair {
        Some(p) => pair_params(model, params, p as usize),
        None => mixed_params(model, params, pair.geoms.map(|g| g as usize), MIN_WEIGHT),
    };
    mixed.includemargin = contact_range(model, params, pair).0;
    if model.override_contacts {
        mixed.solref = params.override_solref;
        mixed.solreffriction = params.override_solref;
        mixed.solimp = params.override_solimp;
        mixed.friction = params.override_friction;
    }
    for mu in &mut mixed.friction {
        *mu = mu.max(T::new(MIN_FRICTION));
    }
    mixed
}

#[inline(always)]
fn pair_params<T: Real>(model: &Model, params: &Params<T>, pair: usize) -> ContactParams<T> {
    ContactParams {
        dim: model.pairs[pair].condim as usize,
        includemargin: T::ZERO,
        friction: params.pair_friction[pair],
        solref: params.pair_solref[pair],
        solreffriction: params.pair_solreffriction[pair],
        solimp: params.pair_solimp[pair],
        adhesion: params.pair_adhesion[pair],
    }
}

/// Returns the parameters of two geoms, without margin and override; `solmix` below `min_weight` counts as zero.
#[inline(always)]
pub fn mixed_params<T: Real>(
    model: &Model,
    params: &Params<T>,
    [a, b]: [usize; 2],
    min_weight: f64,
) -> ContactParams<T> {
    let (geom_a, geom_b) = (&model.geoms[a], &model.geoms[b]);
    let (condim, [slide, spin, roll], solref, solimp, adhesion);
    if geom_a.priority == geom_b.priority {
        condim = geom_a.condim.max(geom_b.condim);
        let (friction_a, friction_b) = (params.geom_friction[a], params.geom_friction[b]);
        [slide, spin, roll] = array(
            #[inline(always)]
            |i| friction_a[i].max(friction_b[i]),
        );
        let weight = weight(params.geom_solmix[a], params.geom_solmix[b], min_weight);
        solref = mix_solref(params.geom_solref[a], params.geom_solref[b], weight);
        solimp = average(params.geom_solimp[a], params.geom_solimp[b], weight);
        adhesion = params.geom_adhesion[a] + params.geom_adhesion[b];
    } else {
        let winner = if geom_a.priority > geom_b.priority {
            a
        } else {
            b
        };
        condim = model.geoms[winner].condim;
        [slide, spin, roll] = params.geom_friction[winner];
        solref = params.geom_solref[winner];
        solimp = params.geom_solimp[winner];
        adhesion = params.geom_adhesion[winner];
    }
    ContactParams {
        dim: condim as usize,
        includemargin: T::ZERO,
        friction: [slide, slide, spin, roll, roll],
        solref,
        solreffriction: [T::ZERO; 2],
        solimp,
        adhesion,
    }
}

/// Returns the share of the first of two weights; one half if both vanish.
#[inline(always)]
fn weight<T: Real>(a: T, b: T, least: f64) -> T {
    let least = T::new(least);
    let (has_a, has_b) = (a.ge(least), b.ge(least));
    let (a, b) = (T::select(has_a, a, T::ZERO), T::select(has_b, b, T::ZERO));
    let both = has_a | has_b;
    T::select(both, a / T::select(both, a + b, T::ONE), T::new(0.5))
}

#[inline(always)]
fn average<T: Real, const N: usize>(a: [T; N], b: [T; N], weight: T) -> [T; N] {
    array(
        #[inline(always)]
        |i| weight * a[i] + (T::ONE - weight) * b[i],
    )
}

#[inline(always)]
fn mix_solref<T: Real>(a: [T; 2], b: [T; 2], weight: T) -> [T; 2] {
    let standard = a[0].gt(T::ZERO) & b[0].gt(T::ZERO);
    let mean = average(a, b, weight);
    if standard.all() {
        return mean;
    }
    array(
        #[inline(always)]
        |i| T::select(standard, mean[i], a[i].min(b[i])),
    )
}
