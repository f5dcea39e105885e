//! Models of several files.

use crate::files::Files;

#[test]
fn the_children_of_the_other_root_take_the_place_of_the_include() {
    let files = Files::new(&[
        (
            "main.xml",
            "<mujoco><include file='common.xml'/>
               <worldbody><body name='a'/><include file='bodies.xml'/><body name='d'/></worldbody></mujoco>",
        ),
        ("common.xml", "<mujoco model='ignored'><option timestep='0.5'/><option density='2'/></mujoco>"),
        ("bodies.xml", "<mujocoinclude><body name='b'/><body name='c'/></mujocoinclude>"),
    ]);
    let model = files.read().unwrap();
    let names: Vec<_> = model.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["world", "a", "b", "c", "d"]);
    assert_eq!((model.physics.timestep, model.physics.density), (0.5, 2.0));
}

#[test]
fn nested_includes_are_found_from_the_model_or_from_the_including_file() {
    let files = Files::new(&[
        (
            "main.xml",
            "<mujoco><include file='parts/first.xml'/></mujoco>",
        ),
        (
            "parts/first.xml",
            "<m><include file='second.xml'/><include file='parts/third.xml'/></m>",
        ),
        ("parts/second.xml", "<m><option timestep='0.5'/></m>"),
        ("parts/third.xml", "<m><option density='2'/></m>"),
    ]);
    let model = files.read().unwrap();
    assert_eq!((model.physics.timestep, model.physics.density), (0.5, 2.0));
}

#[test]
fn an_error_names_the_included_file() {
    let files = Files::new(&[
        ("main.xml", "<mujoco>\n<include file='part.xml'/></mujoco>"),
        ("part.xml", "<m>\n\n\n<option typo='1'/></m>"),
    ]);
    let error = files.read().unwrap_err();
    assert!(error.file.ends_with("part.xml"), "{error}");
    assert_eq!(error.line, Some(4));
}

#[test]
fn no_file_is_included_twice_by_different_paths() {
    for second in ["part.xml", "./part.xml", "parts/../part.xml", "main.xml"] {
        let main =
            format!("<mujoco>\n<include file='part.xml'/>\n<include file='{second}'/></mujoco>");
        let files = Files::new(&[
            ("main.xml", &main),
            ("part.xml", "<m><option/></m>"),
            ("parts/other.xml", "<m/>"),
        ]);
        let error = files.read().unwrap_err();
        assert_eq!(error.line, Some(3), "{error}");
        assert!(error.message.contains("already included"), "{error}");
    }
}

#[test]
fn includes_cannot_recurse() {
    let files = Files::new(&[
        ("main.xml", "<mujoco><include file='a.xml'/></mujoco>"),
        ("a.xml", "<m><include file='b.xml'/></m>"),
        ("b.xml", "<m><include file='a.xml'/></m>"),
    ]);
    assert!(
        files
            .read()
            .unwrap_err()
            .message
            .contains("already included")
    );
}

#[test]
fn includes_of_nothing_are_refused() {
    for (include, message) in [
        ("<include/>", "\"file\" is required"),
        (
            "<include file='nowhere.xml'/>",
            "cannot find the file \"nowhere.xml\"",
        ),
        ("<include file='none.xml'/>", "holds no elements"),
        ("<include file='blank.xml'/>", "empty"),
        (
            "<include file='none.xml'><option/></include>",
            "cannot have children",
        ),
    ] {
        let main = format!("<mujoco>{include}</mujoco>");
        let files = Files::new(&[
            ("main.xml", &main),
            ("none.xml", "<m></m>"),
            ("blank.xml", ""),
        ]);
        let error = files.read().unwrap_err();
        assert!(error.message.contains(message), "{error}");
    }
}
