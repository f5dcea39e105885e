//! Mistakes with warnings, and errors.

use super::{joint, link, robot};
use clench_formats::{LoadError, load_str};

#[test]
fn other_elements_are_ignored_and_mistakes_are_reported() {
    let text = "<robot name='r' xmlns:controller='http://example.org/c'>
      <gazebo reference='a'><controller:plugin controller:x='1' filename='x.so'/></gazebo>
      <transmission name='t'><joint name='j'/></transmission>
      <link name='a'/>
      <link name='b'>
        <inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>
        <colision/>
      </link>
      <joint name='j' type='revolute'><parent link='a'/><child link='b'/><limit lower='-1' uper='1' upper='1'/></joint>
    </robot>";
    let model = load_str(text).unwrap();
    assert_eq!(model.notes.len(), 2, "{:?}", model.notes);
    assert_eq!(
        model.notes[0],
        "line 7: <colision> of link \"b\" is ignored; did you mean \"collision\"?"
    );
    assert!(model.notes[1].contains("\"uper\"") && model.notes[1].contains("\"upper\""));
}

fn rejected(parts: &[&str]) -> LoadError {
    let parts: Vec<String> = parts.iter().map(|part| (*part).to_owned()).collect();
    match load_str(&robot(&parts)) {
        Ok(_) => panic!("was accepted: {parts:?}"),
        Err(error) => error,
    }
}

#[test]
fn an_error_names_line_element_and_link() {
    let (a, b) = (&link("a", "")[..], &link("b", "")[..]);
    let ab = |kind: &str, more: &str| joint("j", kind, "a", "b", more);
    let cases: [(&[&str], u32, &str, &str); 16] = [
        (&["<link/>"], 2, "link", "\"name\" is required"),
        (&[a, a], 3, "link \"a\"", "already in use"),
        (
            &[a, &joint("j", "fixed", "a", "c", "")],
            3,
            "child of joint \"j\"",
            "no link \"c\"",
        ),
        (
            &[a, b, &ab("revolut", "")],
            4,
            "joint \"j\"",
            "not one of revolute",
        ),
        (
            &[
                a,
                b,
                "<joint name='j'><parent link='a'/><child link='b'/></joint>",
            ],
            4,
            "joint \"j\"",
            "\"type\" is required",
        ),
        (
            &[
                a,
                b,
                "<joint name='j' type='fixed'><child link='b'/></joint>",
            ],
            4,
            "joint \"j\"",
            "<parent> is required",
        ),
        (
            &[a, b, &ab("fixed", ""), &ab("fixed", "")],
            5,
            "joint \"j\"",
            "link \"b\" already has a parent",
        ),
        (
            &[a, b, &ab("fixed", ""), &joint("k", "fixed", "b", "a", "")],
            4,
            "joint \"j\"",
            "loop",
        ),
        (
            &[a, b, &ab("revolute", "<axis xyz='1 0'/>")],
            4,
            "axis of joint \"j\"",
            "needs 3 numbers",
        ),
        (
            &[a, b, &ab("revolute", "<axis xyz='0 0 0'/>")],
            4,
            "joint \"j\" of body \"b\"",
            "axis is zero",
        ),
        (
            &[a, b, &ab("revolute", "<limit lower='x'/>")],
            4,
            "limit of joint \"j\"",
            "\"x\" in lower",
        ),
        (
            &["<link name='a'><inertial><mass value='1'/></inertial></link>"],
            2,
            "inertial of link \"a\"",
            "<inertia> is required",
        ),
        (
            &["<link name='a'><collision/></link>"],
            2,
            "collision of link \"a\"",
            "<geometry> is required",
        ),
        (
            &["<link name='a'><collision><geometry/></collision></link>"],
            2,
            "geometry of link \"a\"",
            "needs a <box>",
        ),
        (
            &[
                "<link name='a'><collision><geometry><mesh filename='x.stl'/></geometry></collision></link>",
            ],
            2,
            "mesh of link \"a\"",
            "cannot find the file \"x.stl\"",
        ),
        (
            &[a, "<mujoco><compiler balanceinertias='true'/></mujoco>"],
            3,
            "compiler",
            "did you mean \"balanceinertia\"",
        ),
    ];
    for (parts, line, element, message) in cases {
        let error = rejected(parts);
        assert_eq!(error.line, Some(line), "{error}");
        assert_eq!(error.element.as_deref(), Some(element), "{error}");
        assert!(error.message.contains(message), "{error}");
    }
}

#[test]
fn inertias_that_no_body_has_name_the_link() {
    let with = |mass: &str, inertia: [&str; 3]| {
        let [x, y, z] = inertia;
        let b = format!(
            "<link name='b'><inertial><mass value='{mass}'/>\
             <inertia ixx='{x}' iyy='{y}' izz='{z}' ixy='0' ixz='0' iyz='0'/></inertial></link>"
        );
        rejected(&[
            "<link name='a'/>",
            &b,
            &joint("j", "revolute", "a", "b", ""),
        ])
    };
    let cases = [
        (with("1", ["1", "1", "3"]), "balanceinertia"),
        (with("1", ["-1", "1", "1"]), "positive definite"),
        (with("1", ["0", "0", "0"]), "a moving body must have a mass"),
        (with("-1", ["1", "1", "1"]), "cannot be negative"),
    ];
    for (error, message) in cases {
        assert_eq!(error.line, Some(3), "{error}");
        assert!(
            error
                .element
                .as_deref()
                .is_some_and(|e| e.contains("body \"b\"")),
            "{error}"
        );
        assert!(error.message.contains(message), "{error}");
    }
}

#[test]
fn a_long_chain_of_links_needs_no_stack() {
    let count = 3000;
    let mut text = String::from("<robot><link name='l0'/>");
    for k in 1..count {
        let above = k - 1;
        text += &format!(
            "<link name='l{k}'/><joint name='j{k}' type='fixed'><parent link='l{above}'/><child link='l{k}'/></joint>"
        );
    }
    text += "</robot>";
    let thread = std::thread::Builder::new().stack_size(128 * 1024);
    let model = thread
        .spawn(move || load_str(&text))
        .unwrap()
        .join()
        .unwrap();
    assert_eq!(model.unwrap().nbody(), 1);
}
