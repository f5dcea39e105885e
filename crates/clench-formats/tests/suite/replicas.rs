//! References to a replicated part of the tree, and those that MuJoCo omits. The names are those of MuJoCo 4.0.0.

use clench_formats::read_str;
use clench_rigid::builder::{ModelBuilder, WrapSpec};

/// Reads a fixed body `f` and two replicas of a body `b`, with sections outside the tree.
fn replicated(sections: &str) -> ModelBuilder {
    read_str(&format!(
        "<mujoco><worldbody>
           <body name='f'><joint name='fj'/><geom name='fg' size='.1'/><site name='fs'/></body>
           <replicate count='2' offset='1 0 0'>
             <body name='b'><joint name='j'/><geom name='g' size='.1'/><site name='s'/></body>
           </replicate>
         </worldbody>{sections}</mujoco>"
    ))
    .unwrap()
}

fn names<T>(elements: &[T], name: impl Fn(&T) -> &str) -> Vec<&str> {
    elements.iter().map(name).collect()
}

#[test]
fn actuators_and_equalities_are_copied_if_all_their_targets_are() {
    let model = replicated(
        "<actuator><motor name='a' joint='j'/><motor name='own' joint='fj'/></actuator>
         <equality>
           <connect name='c' body1='b' anchor='0 0 0'/>
           <weld name='world' body1='world' body2='b'/>
           <connect name='lost' body1='b' body2='f' anchor='0 0 0'/>
           <connect name='own' body1='f' anchor='0 0 0'/>
         </equality>",
    );
    assert_eq!(names(&model.actuators, |a| &a.name), ["own", "a0", "a1"]);
    let equalities = names(&model.equalities, |e| &e.name);
    assert_eq!(equalities, ["own", "c0", "world0", "c1", "world1"]);
}

#[test]
fn one_replicated_object_is_enough_for_pairs_and_sensors_and_one_joint_for_tendons() {
    let model = replicated(
        "<contact>
           <pair name='p' geom1='fg' geom2='g'/>
           <exclude name='e' body1='b' body2='f'/>
           <exclude name='own' body1='world' body2='f'/>
         </contact>
         <tendon>
           <fixed name='t'><joint joint='j' coef='1'/><joint joint='fj' coef='2'/></fixed>
           <fixed name='own'><joint joint='fj' coef='1'/></fixed>
         </tendon>
         <sensor>
           <framepos name='q' objtype='body' objname='f' reftype='body' refname='b'/>
           <tendonpos name='l' tendon='t'/>
           <jointpos name='own' joint='fj'/>
         </sensor>",
    );
    assert_eq!(names(&model.pairs, |p| &p.name), ["p0", "p1"]);
    assert_eq!(names(&model.pairs, |p| &p.geom2), ["g0", "g1"]);
    assert_eq!(names(&model.pairs, |p| &p.geom1), ["fg", "fg"]);
    assert_eq!(names(&model.excludes, |e| &e.name), ["own", "e0", "e1"]);
    assert_eq!(names(&model.tendons, |t| &t.name), ["own", "t0", "t1"]);
    assert!(matches!(&model.tendons[1].path[1], WrapSpec::Joint { joint, .. } if joint == "fj"));
    let sensors = names(&model.sensors, |s| &s.name);
    assert_eq!(sensors, ["own", "q0", "l0", "q1", "l1"]);
}

#[test]
fn elements_without_references_are_copied_with_every_replica() {
    let model = replicated("<sensor><clock name='c'/></sensor>");
    assert_eq!(names(&model.sensors, |s| &s.name), ["c", "c0", "c1", "c01"]);
}

#[test]
fn elements_can_name_one_replica() {
    let model = replicated("<sensor><jointpos name='first' joint='j0'/></sensor>");
    assert_eq!(names(&model.sensors, |s| &s.name), ["first"]);
    assert!(model.build().is_ok());
}

#[test]
fn of_no_replicas_nothing_is_left() {
    let model = read_str(
        "<mujoco><worldbody><replicate count='0'><body name='b'/></replicate></worldbody>
         <sensor><framepos objtype='body' objname='b'/></sensor></mujoco>",
    )
    .unwrap();
    assert_eq!((model.bodies.len(), model.sensors.len()), (1, 0));
}

#[test]
fn inner_suffixes_come_first() {
    let model = read_str(
        "<mujoco><worldbody><replicate count='2' sep='_'><body name='b'><geom size='.1'/>
           <replicate count='2' sep='-'><site name='s'/></replicate>
         </body></replicate></worldbody>
         <sensor>
           <framepos name='q' objtype='site' objname='s'/>
           <framepos name='r' objtype='body' objname='b'/>
         </sensor></mujoco>",
    )
    .unwrap();
    let sites = names(&model.bodies[2].sites, |s| &s.name);
    assert_eq!(sites, ["s-0_1", "s-1_1"]);
    let sensors = names(&model.sensors, |s| &s.name);
    assert_eq!(sensors, ["r_0", "q-0_0", "q-1_0", "r_1", "q-0_1", "q-1_1"]);
}
