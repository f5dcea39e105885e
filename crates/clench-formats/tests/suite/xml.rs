//! XML as TinyXML, MuJoCo's parser, reads it. Each of these files loads in MuJoCo 4.0.0.

use clench_formats::read_str;

#[track_caller]
fn loads(text: &str) {
    let model = read_str(text);
    assert!(model.is_ok(), "{text}: {:?}", model.err());
}

#[test]
fn comments_may_hold_dashes() {
    loads("<mujoco><!-- a -- b --><!-----></mujoco>");
    loads("<!----- models -----><mujoco/>");
}

#[test]
fn text_before_the_model_is_ignored() {
    loads("\u{feff}<mujoco/>");
    loads(" \n<?xml version='1.0'?>\n<mujoco/>");
    loads("<!DOCTYPE mujoco>\n<mujoco/>");
    loads("<?foo bar?><mujoco/>");
}

#[test]
fn elements_after_the_model_do_not_count() {
    loads("<mujoco/><mujoco/>");
    loads("<mujoco/><!-- a -- b -->");
    assert!(read_str("<mujoco/>text").is_err());
}

#[test]
fn a_file_ends_at_a_nul() {
    loads("<mujoco/>\n\0");
    loads("<mujoco/>\0text");
    assert!(read_str("<mujoco>\0</mujoco>").is_err());
}

#[test]
fn text_between_elements_does_not_count() {
    loads(
        "<mujoco>a & b<worldbody>x<body name='b'>y</body></worldbody><![CDATA[ <foo> ]]></mujoco>",
    );
}

#[test]
fn values_may_hold_marks() {
    let name = |value: &str| {
        read_str(&format!("<mujoco model=\"{value}\"/>"))
            .unwrap()
            .name
    };
    assert_eq!(name("a & b"), "a & b");
    assert_eq!(name("a < b > c"), "a < b > c");
    assert_eq!(name("&foo;&lt;&#65;&#x42;"), "&foo;<AB");
    assert_eq!(name("it's"), "it's");
}

#[test]
fn attributes_may_touch() {
    let text = "<mujoco><worldbody><geom name=\"a\"size=\"1\"type='box'pos=\"1 & 2\"/></worldbody></mujoco>";
    let error = read_str(text).unwrap_err();
    assert!(error.message.contains("pos"), "{error}");
}

#[test]
fn the_root_may_name_its_schema() {
    loads(
        "<mujoco xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance' xsi:noNamespaceSchemaLocation='mjcf.xsd'/>",
    );
}

#[test]
fn prefixes_need_no_declaration() {
    let robot = |root: &str| {
        format!(
            "<robot{root}>\n<link name='a'/><link name='b'><inertial><mass value='1'/>
             <inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>
             <drake:joint name='k' type='fixed'/><joint name='j' type='revolute'>
             <parent link='a'/><child link='b'/><limit drake:acceleration='2' lower='-1' upper='1'/></joint></robot>"
        )
    };
    for root in ["", " name='r'", " xml:lang='en' name='a:b'", " foo:bar='1'"] {
        let read = clench_formats::load_str(&robot(root)).expect("MuJoCo loads it");
        assert_eq!(read.joints.len(), 1, "{root}");
    }
    loads("<mujoco xsi:noNamespaceSchemaLocation='mjcf.xsd'/>");
    let error = read_str("<mujoco>\n<worldbody><a:geom/></worldbody></mujoco>");
    assert_eq!(error.expect_err("MuJoCo refuses it").line, Some(2));
}

#[test]
fn line_numbers_are_preserved() {
    let text = "<mujoco>\n<!-- a -- \n b -->\n<worldbody>\n<geom size='x'/></worldbody></mujoco>";
    assert_eq!(read_str(text).unwrap_err().line, Some(5));
}

#[test]
fn malformed_files_stay_errors() {
    for text in [
        "<mujoco><!-- a -- b --><worldbody></mujoco>",
        "<mujoco><!-- a -- b --><worldbody/>",
        "<mujoco><!-- a -- b --><worldbody",
        "<mujoco><!-- a -- b --><worldbody a=\"",
        "<mujoco><!-- a -- b",
        "<mujoco model=a/><!-- a -- b -->",
        "<mujoco><!-- a -- b --><?xml version='1.0'?></mujoco>",
    ] {
        let error = read_str(text).expect_err(text);
        assert!(error.message.contains("well-formed"), "{error}");
    }
}
