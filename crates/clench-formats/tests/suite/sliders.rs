//! Inverse inertias of bodies with only slide joints.

use clench_formats::load_str;

/// For simple bodies with only slide joints MuJoCo uses the mass in every direction; for others it takes the mean over
/// directions.
#[test]
fn a_slider_weighs_in_every_direction_unless_it_is_not_simple() {
    let weight = |simple: &str| {
        let text = format!(
            "<mujoco><worldbody><body simple='{simple}'>
               <joint type='slide'/><geom type='box' size='1 1 1' mass='2'/>
             </body></worldbody></mujoco>"
        );
        load_str(&text).expect("valid").params.body_invweight0[1][0]
    };
    assert_eq!(weight("auto"), 0.5);
    assert!((weight("false") - 0.5 / 3.0).abs() < 1e-15);
}

/// MuJoCo 4.0's values: 1/(mass + armature · coef²) for the dof; for the body the mean over three directions, of which
/// it moves in one.
#[test]
fn a_slider_with_the_inertia_of_a_tendon_is_not_simple() {
    let weights = |armature: f64| {
        let text = format!(
            "<mujoco><worldbody><body>
               <joint name='j' type='slide'/><geom type='box' size='1 1 1' mass='2'/>
             </body></worldbody>
             <tendon><fixed armature='{armature}'><joint joint='j' coef='2'/></fixed></tendon></mujoco>"
        );
        let params = load_str(&text).expect("valid").params.clone();
        [params.dof_invweight0[0], params.body_invweight0[1][0]]
    };
    assert_eq!(weights(0.0), [0.5, 0.5]);
    let [dof, body] = weights(0.5);
    assert!((dof - 0.25).abs() < 1e-15 && (body - 0.25 / 3.0).abs() < 1e-15);
}
