//! User data of elements: stored, with the same width for all elements of a kind.

use clench_formats::{Loader, SaveModel, load_str};
use clench_rigid::{Budget, Model};
use std::sync::Arc;

fn load(text: &str) -> Model {
    load_str(text).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    match load_str(text) {
        Ok(_) => panic!("it loads: {text}"),
        Err(error) => error.to_string(),
    }
}

fn rows<'a>(users: impl Iterator<Item = &'a Arc<[f64]>>) -> Vec<Vec<f64>> {
    users.map(|user| user.to_vec()).collect()
}

const GEOMS: &str = "
    <default>
      <geom user='1 2 3'/>
      <default class='short'><geom user='7'/></default>
      <default class='unused'><geom user='1 2 3 4 5'/></default>
    </default>
    <worldbody>
      <geom name='plain' size='1'/>
      <geom name='own' size='1' user='4'/>
      <geom name='short' class='short' size='1'/>
      <geom name='blank' size='1' user=''/>
    </worldbody>";

#[test]
fn an_element_has_its_own_or_those_of_its_class_and_zeros_behind() {
    let model = load(&format!("<mujoco>{GEOMS}</mujoco>"));
    let expected = [
        [1.0, 2.0, 3.0],
        [4.0, 0.0, 0.0],
        [7.0, 0.0, 0.0],
        [1.0, 2.0, 3.0],
    ];
    assert_eq!(rows(model.geoms.iter().map(|geom| &geom.user)), expected);
    assert!(model.bodies[0].user.is_empty());
}

#[test]
fn the_width_may_be_given() {
    let model = load(&format!(
        "<mujoco><size nuser_geom='4' nuser_body='2'/>{GEOMS}</mujoco>"
    ));
    assert!(model.geoms.iter().all(|geom| geom.user.len() == 4));
    assert_eq!(
        rows(model.bodies.iter().map(|body| &body.user)),
        [[0.0, 0.0]]
    );
    let automatic = load(&format!(
        "<mujoco><size nuser_geom='4'/><size nuser_geom='-1'/>{GEOMS}</mujoco>"
    ));
    assert!(automatic.geoms.iter().all(|geom| geom.user.len() == 3));

    let narrow = refused(
        "<mujoco>\n<size nuser_geom='1'/>\n<worldbody>\n<geom name='g' size='1' user='1 2'/></worldbody></mujoco>",
    );
    for word in ["4: ", "geom \"g\"", "2 numbers, more than the 1"] {
        assert!(narrow.contains(word), "{narrow}");
    }
    assert!(refused("<mujoco><size nuser_jnt='-2'/></mujoco>").contains("nuser_jnt is -2"));
    let word = "<mujoco><worldbody><body name='b' user='1 x'/></worldbody></mujoco>";
    assert!(refused(word).contains("body \"b\": \"x\" in user is not a number"));
}

#[test]
fn any_number_will_do_and_comes_back_from_a_saved_model() {
    let text = "<mujoco><worldbody><body user='nan inf -0.1'><freejoint/><geom size='1'/></body></worldbody></mujoco>";
    let model = load(text);
    let again = load(&model.to_mjcf().expect("it can be saved"));
    for user in [&model.bodies[1].user, &again.bodies[1].user] {
        assert!(user[0].is_nan());
        assert_eq!(user[1..], [f64::INFINITY, -0.1]);
    }
    assert_eq!(again.bodies[0].user[..], [0.0; 3]);
}

#[test]
fn bodies_that_are_fused_take_theirs_along() {
    let model = load(
        "<mujoco><compiler fusestatic='true'/><worldbody>
           <body user='1 2 3'><geom size='1' user='4'/></body>
           <body user='5'><freejoint/><geom size='1'/></body>
         </worldbody></mujoco>",
    );
    assert_eq!(
        rows(model.bodies.iter().map(|body| &body.user)),
        [[0.0], [5.0]]
    );
    assert_eq!(
        rows(model.geoms.iter().map(|geom| &geom.user)),
        [[4.0], [0.0]]
    );
}

#[test]
fn they_are_held_against_the_budget_before_they_are_made() {
    let text =
        "<mujoco><size nuser_geom='2000000000'/><worldbody><geom size='1'/></worldbody></mujoco>";
    assert!(refused(text).contains("user data would take more than"));
    let modest = text.replace("2000000000", "2000000");
    let small = Budget {
        bytes: 8_000_000,
        ..Budget::default()
    };
    assert!(Loader::new().budget(small).load_str(&modest).is_err());
    assert_eq!(load(&modest).geoms[0].user.len(), 2_000_000);
}

/// Returns the width of the user data of geoms in a model with the size `own` and an attached model with size 5.
fn attached(conflict: &str, own: &str) -> Result<usize, String> {
    let part = "<mujoco><size nuser_geom='5'/><worldbody><body name='b'><geom size='1' user='1 2'/></body></worldbody></mujoco>";
    let main = format!(
        "<mujoco><compiler conflict='{conflict}'/><size {own}/><asset><model name='part' file='part.xml'/></asset>
         <worldbody><attach model='part' body='b' prefix='p'/></worldbody></mujoco>"
    );
    let loaded = Loader::new()
        .assets([("part.xml", part.as_bytes())])
        .load_str(&main);
    let model = loaded.map_err(|error| error.to_string())?;
    assert_eq!(model.geoms[0].user[..2], [1.0, 2.0]);
    Ok(model.geoms[0].user.len())
}

#[test]
fn widths_of_attached_models_are_merged_as_options_are() {
    let widest = ["", "nuser_geom='-1'", "nuser_geom='1'", "nuser_geom='7'"];
    assert_eq!(
        widest.map(|own| attached("merge", own).unwrap()),
        [5, 5, 5, 7]
    );
    assert_eq!(
        widest.map(|own| attached("warning", own).ok()),
        [Some(2), Some(2), None, Some(7)]
    );
    assert_eq!(attached("error", ""), Ok(2));
    assert_eq!(attached("error", "nuser_geom='5'"), Ok(5));
    let error = attached("error", "nuser_geom='7'").unwrap_err();
    assert!(error.contains("nuser_geom: here 7, there 5"), "{error}");
}
