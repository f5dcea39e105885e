//! Keyframes of attached models. The expected numbers are those of MuJoCo 4.0.0.

use crate::files::Files;
use clench_rigid::builder::{KeyframeElement, KeyframePart};

/// Returns the keyframes of a model except its own one, as (name, time, values of elements).
fn keyframes(attach: &str) -> Vec<(String, f64, Vec<KeyframePart>)> {
    let part = "<mujoco>
      <default><default class='slides'><joint type='slide'/></default></default>
      <worldbody>
        <body name='A'><joint/><geom size='1'/><body><joint type='ball'/><geom size='1'/></body></body>
        <body name='D'><joint name='d' class='slides'/><geom size='1'/></body>
        <body name='M' mocap='true'/>
      </worldbody>
      <actuator><motor joint='d'/><general joint='d' dyntype='integrator'/></actuator>
      <keyframe>
        <key name='home' time='3' qpos='1 1 0 0 0 4' qvel='5 6 7 8 9' ctrl='.1 .2' act='.7' mpos='1 2 3'/>
      </keyframe></mujoco>";
    let main = format!(
        "<mujoco><asset><model name='part' file='part.xml'/></asset>
         <worldbody><body><joint/><geom size='1'/></body>{attach}</worldbody>
         <keyframe><key name='own' qpos='2'/></keyframe></mujoco>"
    );
    let files = Files::new(&[("main.xml", main.as_str()), ("part.xml", part)]);
    let model = files.read().unwrap();
    assert!(model.notes.is_empty(), "{:?}", model.notes);
    assert_eq!(model.keyframes[0].name, "own");
    let attached = model.keyframes.into_iter().skip(1);
    attached
        .map(|key| (key.name, key.time, key.parts))
        .collect()
}

fn part(element: KeyframeElement, first: &[f64], second: &[f64]) -> KeyframePart {
    KeyframePart {
        plastic: Vec::new(),
        element,
        first: first.to_vec(),
        second: second.to_vec(),
    }
}

#[test]
fn keyframes_of_attached_models_apply_to_the_attached_elements() {
    use KeyframeElement::{Actuator, Joint, Mocap};
    let all = keyframes("<attach model='part' prefix='x_'/>");
    let expected = vec![
        part(Joint(1), &[1.0], &[5.0]),
        part(Joint(2), &[1.0, 0.0, 0.0, 0.0], &[6.0, 7.0, 8.0]),
        part(Joint(3), &[4.0], &[9.0]),
        part(Actuator(0), &[0.1], &[]),
        part(Actuator(1), &[0.2], &[0.7]),
        part(Mocap(0), &[1.0, 2.0, 3.0], &[]),
    ];
    assert_eq!(all, [("x_home".to_owned(), 3.0, expected)]);
    let slider = keyframes("<attach model='part' body='D' prefix='y_'/>");
    let expected = vec![
        part(Joint(1), &[4.0], &[9.0]),
        part(Actuator(0), &[0.1], &[]),
        part(Actuator(1), &[0.2], &[0.7]),
    ];
    assert_eq!(slider, [("y_home".to_owned(), 3.0, expected)]);
}

#[test]
fn a_model_that_is_attached_twice_has_its_keyframes_twice_and_replicas_have_them_once() {
    use KeyframeElement::Joint;
    let twice = keyframes(
        "<attach model='part' body='A' prefix='x_'/><attach model='part' body='A' prefix='y_'/>",
    );
    let names: Vec<&str> = twice.iter().map(|(name, ..)| name.as_str()).collect();
    assert_eq!(names, ["x_home", "y_home"]);
    assert_eq!(twice[1].2[0], part(Joint(3), &[1.0], &[5.0]));
    let replicas =
        keyframes("<replicate count='3'><attach model='part' body='A' prefix='x_'/></replicate>");
    assert_eq!(replicas.len(), 1);
    assert_eq!(replicas[0].2[0], part(Joint(1), &[1.0], &[5.0]));
}

/// The values for a model that has its own yielding springs are MuJoCo's.
#[test]
fn keyframes_of_attached_models_store_plastic_states() {
    let part = "<mujoco><worldbody><body name='x'>
        <joint name='j' type='slide' springyield='.1'/><joint type='ball' springyield='.1'/><geom size='.1'/>
      </body></worldbody>
      <tendon><fixed name='t' springyield='1'><joint joint='j' coef='1'/></fixed></tendon>
      <keyframe><key name='k' plastic='.4 0 1 0 0 .6 .7'/></keyframe></mujoco>";
    let main = "<mujoco><asset><model name='part' file='part.xml'/></asset>
      <worldbody>
        <body><joint name='o' type='slide' springyield='.1'/><geom size='.1'/></body>
        <attach model='part' body='x' prefix='p_'/><attach model='part' body='x' prefix='q_'/>
      </worldbody>
      <tendon><fixed springyield='.1'><joint joint='o' coef='1'/></fixed></tendon></mujoco>";
    let files = Files::new(&[("main.xml", main), ("part.xml", part)]);
    let model = files.read().unwrap().build().unwrap();
    let found: Vec<_> = model.keyframes.iter().map(|key| &key.plastic[..]).collect();
    let (turned, plain) = ([0.4, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0]);
    let (given, none) = ([0.6, 0.7], [0.0, 0.0]);
    let expected = [
        [&[0.0], &turned[..], &plain, &none, &given, &none].concat(),
        [&[0.0], &plain[..], &turned, &none, &none, &given].concat(),
    ];
    assert_eq!(found, expected);
}

/// Values are scaled by the frame that the elements are attached to; omitted values are not scaled.
#[test]
fn keyframes_of_attached_models_are_scaled_with_their_joints() {
    let part = "<mujoco>
      <worldbody>
        <body pos='1 0 0'><joint name='s' type='slide' axis='0 1 0' springyield='.1' springref='.2' stiffness='1'/>
          <geom type='box' size='.1 .1 .1'/></body>
        <body pos='0 1 0'><freejoint/><geom type='box' size='.1 .1 .1'/></body>
        <body mocap='true'/>
      </worldbody>
      <tendon><fixed springyield='.1' stiffness='1'><joint joint='s' coef='1'/></fixed></tendon>
      <actuator><intvelocity joint='s' kp='1' actrange='-1 1'/><motor joint='s'/></actuator>
      <keyframe>
        <key qpos='1 3 4 5 1 0 0 0' qvel='1 3 4 5 6 7 8' ctrl='1 2' act='1' mpos='1 2 3' mquat='0 1 0 0' plastic='1 2 3'/>
        <key qpos='1'/>
      </keyframe></mujoco>";
    let root = 6.0_f64.cbrt();
    let main = |frame: &str| {
        format!(
            "<mujoco><asset><model name='part' file='part.xml'/></asset>
             <worldbody><frame {frame} pos='10 0 0' euler='0 0 90'><attach model='part' prefix='x_'/></frame></worldbody></mujoco>"
        )
    };
    for (frame, [y, z], linear, plastic) in [
        ("scale='2'", [8.0, 10.0], [6.0, 8.0, 10.0], [2.0, 4.0, 6.0]),
        (
            "scale='1 2 3' scaling='geometry'",
            [4.0, 15.0],
            [6.0, 4.0, 15.0],
            [2.0, 2.0 * root, 3.0 * root],
        ),
    ] {
        let main = main(frame);
        let files = Files::new(&[("main.xml", main.as_str()), ("part.xml", part)]);
        let model = files.read().unwrap().build().unwrap();
        let [key, short] = &model.keyframes[..] else {
            panic!("{} keyframes", model.keyframes.len())
        };
        let [u, v, w] = linear;
        near(&key.qpos, &[2.0, -4.0, y, z, 1.0, 0.0, 0.0, 0.0]);
        near(&key.qvel, &[2.0, u, v, w, 6.0, 7.0, 8.0]);
        near(&key.ctrl, &[2.0, 2.0]);
        near(&key.act, &[2.0]);
        near(&key.plastic, &plastic);
        let [_, height] = [y, z].map(|x| x / 5.0);
        near(&key.mocap_pos, &[-8.0, y / 2.0, 3.0 * height]);
        near(&key.mocap_quat, &[0.0, 1.0, 0.0, 0.0]);
        near(&short.qpos, &[&[2.0], &model.params.qpos0[1..]].concat());
    }
}

fn near(found: &[f64], expected: &[f64]) {
    let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
    assert_eq!(found.len(), expected.len());
    assert!(
        found.iter().zip(expected).all(close),
        "{found:?} {expected:?}"
    );
}

#[test]
fn those_that_a_size_requests_come_before_those_of_attached_models() {
    let times = |conflict: &str, own: &str, attached: &str| {
        let part = format!(
            "<mujoco>{attached}<worldbody><body><joint/><geom size='1'/></body></worldbody>
             <keyframe><key name='a' time='3'/><key name='b' time='4'/></keyframe></mujoco>"
        );
        let main = format!(
            "<mujoco><compiler conflict='{conflict}'/>{own}<asset><model name='part' file='part.xml'/></asset>
             <worldbody><frame><attach model='part' prefix='x_'/></frame></worldbody>
             <keyframe><key time='1'/></keyframe></mujoco>"
        );
        let files = Files::new(&[("main.xml", main.as_str()), ("part.xml", part.as_str())]);
        let model = files.read().expect("it is a valid model");
        Vec::from_iter(model.keyframes.iter().map(|key| key.time))
    };
    let [four, five] = ["<size nkey='4'/>", "<size nkey='5'/>"];
    assert_eq!(times("warning", four, ""), [1.0, 0.0, 3.0, 4.0]);
    assert_eq!(times("warning", "", five), [1.0, 3.0, 4.0]);
    assert_eq!(times("merge", four, five), [1.0, 0.0, 0.0, 3.0, 4.0]);
    assert_eq!(times("merge", five, four), [1.0, 0.0, 0.0, 3.0, 4.0]);
}
