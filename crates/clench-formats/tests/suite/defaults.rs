//! Default classes.

use clench_formats::read_str;
use clench_rigid::builder::ModelBuilder;

fn read(sections: &str) -> ModelBuilder {
    match read_str(&format!("<mujoco>{sections}</mujoco>")) {
        Ok(builder) => builder,
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn classes_inherit_and_the_nearest_word_counts() {
    let model = read(
        "<default>
           <joint damping='1 7 8' armature='1' stiffness='1'/>
           <default class='arm'>
             <joint armature='2'/>
             <default class='hand'><joint stiffness='3'/></default>
           </default>
         </default>
         <worldbody>
           <body>
             <joint/><joint class='arm'/><joint class='hand' damping='9'/>
             <body childclass='arm'>
               <joint/><joint class='main'/>
               <frame childclass='hand'><joint/></frame>
               <body><joint/></body>
             </body>
           </body>
         </worldbody>",
    );
    let of = |body: usize, joint: usize| {
        let joint = &model.bodies[body].joints[joint];
        assert_eq!(joint.damping[1..], [7.0, 8.0]);
        [joint.damping[0], joint.armature, joint.stiffness[0]]
    };
    assert_eq!(of(1, 0), [1.0, 1.0, 1.0]);
    assert_eq!(of(1, 1), [1.0, 2.0, 1.0]);
    assert_eq!(of(1, 2), [9.0, 2.0, 3.0]);
    assert_eq!(of(2, 0), [1.0, 2.0, 1.0]);
    assert_eq!(of(2, 1), [1.0, 1.0, 1.0]);
    assert_eq!(of(2, 2), [1.0, 2.0, 3.0]);
    assert_eq!(of(3, 0), [1.0, 2.0, 1.0]);
}

#[test]
fn a_class_inherits_later_settings_of_its_parent() {
    let model = read(
        "<default>
           <default class='child'><geom margin='2'/></default>
           <geom gap='1'/>
         </default>
         <worldbody><geom class='child' size='1'/></worldbody>",
    );
    let geom = &model.bodies[0].geoms[0];
    assert_eq!((geom.margin, geom.gap), (2.0, 1.0));
}

#[test]
fn several_default_sections_add_up() {
    let model = read(
        "<default><geom margin='1'/></default>
         <default class='main'><geom gap='2'/></default>
         <worldbody><geom size='1'/></worldbody>",
    );
    let geom = &model.bodies[0].geoms[0];
    assert_eq!((geom.margin, geom.gap), (1.0, 2.0));
}

#[test]
fn an_attribute_overwrites_only_as_many_numbers_as_it_gives() {
    let model = read(
        "<default><geom solimp='0.1 0.2 0.3' friction='2 3 4' size='7 8 9'/></default>
         <worldbody><geom solimp='0.5' friction='5 6' size='1'/></worldbody>",
    );
    let geom = &model.bodies[0].geoms[0];
    assert_eq!(geom.solimp, [0.5, 0.2, 0.3, 0.5, 2.0]);
    assert_eq!(geom.friction, [5.0, 6.0, 4.0]);
    assert_eq!(geom.size.to_array(), [1.0, 8.0, 9.0]);
}

#[test]
fn an_orientation_of_any_kind_replaces_that_of_the_class() {
    let model = read(
        "<default><geom size='1' euler='0 0 90'/></default>
         <worldbody><geom quat='1 0 0 0'/><geom zaxis='0 0 1'/></worldbody>",
    );
    for geom in &model.bodies[0].geoms {
        assert_eq!(geom.quat.to_array(), [1.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn every_kind_of_element_has_defaults() {
    let model = read(
        "<default>
           <site pos='1 2 3'/>
           <pair condim='6' friction='0.5'/>
           <equality active='false' solref='0.5'/>
           <tendon stiffness='4' springlength='1' springyield='2'/>
         </default>
         <worldbody><site/><body name='b'><joint name='j'/></body></worldbody>
         <contact><pair geom1='a' geom2='b' friction='0.1 0.2'/></contact>
         <equality><weld body1='b'/></equality>
         <tendon><fixed damping='5'><joint joint='j' coef='1'/></fixed></tendon>",
    );
    assert_eq!(model.bodies[0].sites[0].pos.to_array(), [1.0, 2.0, 3.0]);
    let pair = &model.pairs[0];
    assert_eq!(
        (pair.condim, pair.friction),
        (Some(6), Some([0.1, 0.2, 0.005, 0.0001, 0.0001]))
    );
    let weld = &model.equalities[0];
    assert_eq!((weld.active, weld.solref), (false, [0.5, 1.0]));
    let tendon = &model.tendons[0];
    assert_eq!(
        (tendon.stiffness, tendon.damping),
        ([4.0, 0.0, 0.0], [5.0, 0.0, 0.0])
    );
    assert_eq!(
        (tendon.springlength, tendon.springyield),
        (Some([1.0, 1.0]), 2.0)
    );
}

/// An unused class may contain values that no element supports.
#[test]
fn unsupported_attributes_are_accepted_in_unused_classes() {
    let geom = "<worldbody><body><joint name='j'/><geom size='1'/></body></worldbody>";
    for (said, used) in [
        (
            "<geom type='sdf'/>",
            "<worldbody><geom class='c' size='1'/></worldbody>",
        ),
        (
            "<site type='sdf'/>",
            "<worldbody><site class='c'/></worldbody>",
        ),
        (
            "<pid input='voltage quat'/>",
            "<actuator><pid class='c' joint='j'/></actuator>",
        ),
        (
            "<general input='ff'/>",
            "<actuator><general class='c' joint='j'/></actuator>",
        ),
    ] {
        let class = format!("<default><default class='c'>{said}</default></default>{geom}");
        read(&class);
        let text = format!("<mujoco>{class}{used}</mujoco>");
        assert!(read_str(&text).is_err(), "{text}");
    }
    let shaped = "<default><default class='c'><geom type='sdf'/></default></default>
                  <worldbody><geom class='c' type='box' size='1 1 1'/></worldbody>";
    assert_eq!(read(shaped).bodies[0].geoms.len(), 1);
}

#[test]
fn assets_that_classes_name_must_exist() {
    let expect = |sections: &str, message: &str| {
        let text = format!("<mujoco>{sections}</mujoco>");
        let error = read_str(&text).expect_err(sections).to_string();
        assert!(error.starts_with(message), "{error}");
    };
    let worldbody = "<worldbody><site name='s'/><site name='t'/><body><geom name='g' size='1'/></body></worldbody>";
    let string = "<tendon><spatial name='c'><site site='s'/><site site='t'/></spatial></tendon>";
    for (tag, element) in [
        ("geom", "geom \"g\""),
        ("site", "site \"s\""),
        ("tendon", "tendon \"c\""),
    ] {
        expect(
            &format!("<default><{tag} material='no'/></default>{worldbody}{string}"),
            &format!("line 1: {element}: there is no material \"no\""),
        );
    }
    expect(
        "<default><material texture='no'/></default><asset><material name='m'/></asset>",
        "line 1: material \"m\": there is no texture \"no\"",
    );
    // A mesh lends its material to its geoms; without any, none is needed.
    let mesh = "<asset><mesh name='m' material='no' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset>";
    read(mesh);
    expect(
        &format!("{mesh}<worldbody><geom type='mesh' mesh='m'/></worldbody>"),
        "line 1: geom: there is no material \"no\"",
    );
}
