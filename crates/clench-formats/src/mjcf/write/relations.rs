//! Contacts, equalities and tendons.

use super::names::{SaveError, body_name, label, named};
use super::xml::{Tag, Xml};
use clench_math::{Quat, Vec3};
use clench_rigid::Model;
use clench_rigid::builder::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_rigid::model::{Equality, EqualityTarget, Pair, Tendon, Wrap};

/// Pairs that collide whatever their masks say, and bodies that never collide.
pub(super) fn write_contacts(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    let p = &model.params;
    for (k, pair) in model.pairs.iter().enumerate() {
        let Pair {
            name,
            geoms,
            condim,
        } = pair;
        let geom = |g: usize| named("geom", &model.geoms[g].name, g);
        xml.tag("pair")
            .name(name)
            .text("geom1", geom(geoms[0])?)
            .text("geom2", geom(geoms[1])?)
            .integer("condim", *condim)
            .numbers("friction", &p.pair_friction[k])
            .numbers("solref", &p.pair_solref[k])
            .numbers_unless("solreffriction", &p.pair_solreffriction[k], &[0.0; 2])
            .numbers("solimp", &p.pair_solimp[k])
            .number_unless("margin", p.pair_margin[k], 0.0)
            .number_unless("gap", p.pair_gap[k], 0.0)
            .number_unless("adhesion", p.pair_adhesion[k], 0.0)
            .end();
    }
    let mut excludes: Vec<_> = model.excludes.iter().copied().collect();
    excludes.sort_unstable();
    for (first, second) in excludes {
        xml.tag("exclude")
            .text("body1", body_name(model, first as usize)?)
            .text("body2", body_name(model, second as usize)?)
            .end();
    }
    Ok(())
}

pub(super) fn write_equalities(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    for (k, equality) in model.equalities.iter().enumerate() {
        write_equality(model, k, equality, xml)?;
    }
    Ok(())
}

fn write_equality(
    model: &Model,
    k: usize,
    equality: &Equality,
    xml: &mut Xml,
) -> Result<(), SaveError> {
    let Equality {
        name,
        target,
        sites,
        active0,
    } = equality;
    let p = &model.params;
    let mut tag = xml.tag(target.kind()).name(name);
    tag = match (*target, sites) {
        (EqualityTarget::Connect { .. } | EqualityTarget::Weld { .. }, Some([site1, site2])) => {
            let site = |s: usize| named("site", &model.sites[s].name, s);
            tag.text("site1", site(*site1)?)
                .text("site2", site(*site2)?)
        }
        (EqualityTarget::Connect { body1, body2 }, None) => {
            bodies(model, [body1, body2], tag)?.numbers("anchor", &p.eq_anchor1[k].to_array())
        }
        (EqualityTarget::Weld { body1, body2 }, None) => {
            let tag = bodies(model, [body1, body2], tag)?;
            weld(p.eq_anchor1[k], p.eq_anchor2[k], p.eq_quat1[k], tag)
        }
        (EqualityTarget::Joint { joint1, joint2 }, _) => {
            let joint = |j: usize| named("joint", &model.joints[j].name, j);
            let tag = tag.text("joint1", joint(joint1)?);
            let tag = match joint2 {
                Some(joint2) => tag.text("joint2", joint(joint2)?),
                None => tag,
            };
            tag.numbers("polycoef", &p.eq_polycoef[k])
        }
        (EqualityTarget::Tendon { tendon1, tendon2 }, _) => {
            let tendon = |t: usize| named("tendon", &model.tendons[t].name, t);
            let tag = tag.text("tendon1", tendon(tendon1)?);
            let tag = match tendon2 {
                Some(tendon2) => tag.text("tendon2", tendon(tendon2)?),
                None => tag,
            };
            tag.numbers("polycoef", &p.eq_polycoef[k])
        }
    };
    if let EqualityTarget::Weld { .. } = target {
        tag = tag.number_unless("torquescale", p.eq_torquescale[k], 1.0);
    }
    if !*active0 {
        tag = tag.boolean("active", false);
    }
    tag.numbers_unless("solref", &p.eq_solref[k], &DEFAULT_SOLREF)
        .numbers_unless("solimp", &p.eq_solimp[k], &DEFAULT_SOLIMP)
        .end();
    Ok(())
}

fn bodies<'a>(model: &Model, pair: [usize; 2], tag: Tag<'a>) -> Result<Tag<'a>, SaveError> {
    let [body1, body2] = pair;
    Ok(tag
        .text("body1", body_name(model, body1)?)
        .text("body2", body_name(model, body2)?))
}

/// The anchor is a point of the second body; the relative pose says where the first body holds it, and how turned.
fn weld<'a>(held: Vec3<f64>, anchor: Vec3<f64>, turn: Quat<f64>, tag: Tag<'a>) -> Tag<'a> {
    let [x, y, z] = held.to_array();
    let [w, a, b, c] = turn.to_array();
    tag.numbers("anchor", &anchor.to_array())
        .numbers("relpose", &[x, y, z, w, a, b, c])
}

pub(super) fn write_tendons(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    for (t, tendon) in model.tendons.iter().enumerate() {
        write_tendon(model, t, tendon, xml)?;
    }
    Ok(())
}

fn write_tendon(model: &Model, t: usize, tendon: &Tendon, xml: &mut Xml) -> Result<(), SaveError> {
    let Tendon {
        name,
        path,
        coefs,
        limited,
        actfrclimited,
        frictionloss: _,
        reflecting: _,
    } = tendon;
    let p = &model.params;
    if p.tendon_lengthspring[t] == [-1.0; 2] && p.tendon_length0[t] != -1.0 {
        let reason = "its spring rests at -1, which means its initial length in MJCF";
        return Err(SaveError::new(label("tendon", name, t), reason));
    }
    let polynomial = |linear: f64, [quadratic, cubic]: [f64; 2]| [linear, quadratic, cubic];
    let kind = if tendon.is_spatial() {
        "spatial"
    } else {
        "fixed"
    };
    xml.tag(kind)
        .name(name)
        .numbers_unless("range", &p.tendon_range[t], &[0.0; 2])
        .boolean("limited", *limited)
        .numbers_unless("actuatorfrcrange", &p.tendon_actfrcrange[t], &[0.0; 2])
        .boolean("actuatorfrclimited", *actfrclimited)
        .number_unless("margin", p.tendon_margin[t], 0.0)
        .polynomial(
            "stiffness",
            polynomial(p.tendon_stiffness[t], p.tendon_stiffnesspoly[t]),
        )
        .polynomial(
            "damping",
            polynomial(p.tendon_damping[t], p.tendon_dampingpoly[t]),
        )
        .number_unless("armature", p.tendon_armature[t], 0.0)
        .numbers("springlength", &p.tendon_lengthspring[t])
        .number_unless("frictionloss", p.tendon_frictionloss[t], 0.0)
        .numbers_unless("solreflimit", &p.tendon_solref_lim[t], &DEFAULT_SOLREF)
        .numbers_unless("solimplimit", &p.tendon_solimp_lim[t], &DEFAULT_SOLIMP)
        .numbers_unless("solreffriction", &p.tendon_solref_fri[t], &DEFAULT_SOLREF)
        .numbers_unless("solimpfriction", &p.tendon_solimp_fri[t], &DEFAULT_SOLIMP)
        .open();
    for (&wrap, &number) in path.iter().zip(&p.wrap_coef[coefs.clone()]) {
        let site = |s: usize| named("site", &model.sites[s].name, s);
        let tag = match wrap {
            Wrap::Joint(j) => (xml.tag("joint"))
                .text("joint", named("joint", &model.joints[j].name, j)?)
                .numbers("coef", &[number]),
            Wrap::Site(s) => xml.tag("site").text("site", site(s)?),
            Wrap::Pulley => xml.tag("pulley").numbers("divisor", &[number]),
            Wrap::Geom { geom, side } => {
                let name = named("geom", &model.geoms[geom].name, geom)?;
                let tag = xml.tag("geom").text("geom", name);
                match side {
                    Some(side) => tag.text("sidesite", site(side)?),
                    None => tag,
                }
            }
        };
        tag.end();
    }
    xml.close();
    Ok(())
}
