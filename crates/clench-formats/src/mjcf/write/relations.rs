//! Contacts and tendons.

use super::names::{SaveError, body_name, label, named};
use super::xml::Xml;
use clench_builder::{DEFAULT_SOLIMP, DEFAULT_SOLREF, TENDON_NUMBERS};
use clench_dynamics::Model;
use clench_dynamics::model::{Pair, Tendon, Wrap};

/// Writes pairs that collide regardless of their masks, and bodies that never collide.
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
        let name = model.exclude_names.get(&(first, second));
        xml.tag("exclude")
            .name(name.map_or("", String::as_str))
            .text("body1", body_name(model, first as usize)?)
            .text("body2", body_name(model, second as usize)?)
            .end();
    }
    Ok(())
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
        plastic: _,
        coefs,
        limited,
        actfrclimited,
        frictionloss: _,
        reflecting: _,
        user,
    } = tendon;
    let p = &model.params;
    if p.tendon_lengthspring[t] == [-1.0; 2] && p.tendon_length0[t] != -1.0 {
        let reason = "the rest length of its spring is -1, which in MJCF means the initial length";
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
        .polynomial(
            "stiffness",
            polynomial(p.tendon_stiffness[t], p.tendon_stiffnesspoly[t]),
        )
        .polynomial(
            "damping",
            polynomial(p.tendon_damping[t], p.tendon_dampingpoly[t]),
        )
        .element_numbers(&TENDON_NUMBERS, p, t)
        .numbers("springlength", &p.tendon_lengthspring[t])
        .numbers_unless("solreflimit", &p.tendon_solref_lim[t], &DEFAULT_SOLREF)
        .numbers_unless("solimplimit", &p.tendon_solimp_lim[t], &DEFAULT_SOLIMP)
        .numbers_unless("solreffriction", &p.tendon_solref_fri[t], &DEFAULT_SOLREF)
        .numbers_unless("solimpfriction", &p.tendon_solimp_fri[t], &DEFAULT_SOLIMP)
        .numbers_unless("user", user, &[])
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
