//! Sleep settings in files, and settings that files cannot express.

use clench_formats::{LoadError, load_str};
use clench_rigid::model::{Model, SleepPolicy};

fn load(option: &str, bodies: &str) -> Result<Model, LoadError> {
    load_str(&format!(
        "<mujoco>\n{option}\n<worldbody>\n{bodies}\n</worldbody>\n</mujoco>"
    ))
}

#[test]
fn tolerance_flag_and_policies_are_read() {
    let ball = |policy: &str| format!("<body{policy}><freejoint/><geom size='0.1'/></body>");
    let policies = [
        "",
        " sleep='auto'",
        " sleep='never'",
        " sleep='allowed'",
        " sleep='init'",
    ];
    let bodies = policies.map(ball).concat();
    let model = load("", &bodies).expect("valid");
    assert!(!model.flags.sleep && model.params.sleep_tolerance == 1e-3);
    assert!(model.tree_asleep0.is_empty());
    let found = Vec::from_iter(model.trees.iter().map(|tree| tree.sleep));
    use SleepPolicy::{Allowed, Init, Never};
    assert_eq!(found, [Allowed, Allowed, Never, Allowed, Init]);
    let option = "<option sleep_tolerance='0.02'><flag sleep='enable' contact='disable'/></option>";
    let model = load(option, &bodies).expect("valid");
    assert!(model.flags.sleep && model.params.sleep_tolerance == 0.02);
    assert_eq!(model.tree_asleep0, [-10.0, -10.0, -11.0, -10.0, 4.0]);
}

#[test]
fn invalid_policies_are_errors_with_their_line() {
    let enable = "<option><flag sleep='enable'/></option>";
    let spring = "<body sleep='allowed'><joint name='a'/><geom size='1'/></body><body><joint name='b'/><geom size='1'/></body>
        </worldbody><tendon><fixed stiffness='1'><joint joint='a' coef='1'/><joint joint='b' coef='1'/></fixed></tendon><worldbody>";
    for (option, bodies, line, message) in [
        (
            enable,
            "<body sleep='yes'><joint/><geom size='1'/></body>",
            4,
            "sleep",
        ),
        (
            enable,
            "<body sleep='allowed'><geom size='1'/></body>",
            4,
            "not the moving root",
        ),
        (
            enable,
            "<body><joint/><geom size='1'/><body sleep='never'><joint/><geom size='1'/></body></body>",
            4,
            "not the moving root",
        ),
        (enable, spring, 5, "acts on several trees"),
        ("", spring, 5, "acts on several trees"),
        ("<option><flag sleep='on'/></option>", "", 2, "sleep"),
        ("<option sleep_tolerance='nan'/>", "", 2, "sleep_tolerance"),
        ("<option sleep_tolerance='1 2'/>", "", 2, "sleep_tolerance"),
        (
            "<option integrator='RK4'><flag sleep='enable'/></option>",
            "",
            2,
            "RK4",
        ),
    ] {
        let error = load(option, bodies).expect_err(message);
        assert!(error.message.contains(message), "{error}");
        assert_eq!(error.line, Some(line), "{error}");
    }
}
