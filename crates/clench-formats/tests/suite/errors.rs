//! Invalid files: every error has a location and a reason, and nothing panics.

use clench_formats::{LoadError, load, load_str, read_str};

fn rejected(text: &str) -> LoadError {
    match load_str(text) {
        Ok(_) => panic!("was accepted: {text}"),
        Err(error) => error,
    }
}

/// Checks line, element and message of the error in a model whose third line is `line`.
#[track_caller]
fn expect(line: &str, element: &str, message: &str) {
    let error = rejected(&format!(
        "<mujoco>\n<worldbody>\n{line}\n</worldbody>\n</mujoco>"
    ));
    assert_eq!(error.line, Some(3), "{error}");
    assert_eq!(error.element.as_deref(), Some(element), "{error}");
    assert!(error.message.contains(message), "{error}");
}

#[track_caller]
fn expect_section(line: &str, element: &str, message: &str) {
    expect(
        &format!("</worldbody> {line} <worldbody>"),
        element,
        message,
    );
}

#[test]
fn an_error_names_file_line_and_element() {
    let path = std::env::temp_dir().join(format!("clench-named-{}.xml", std::process::id()));
    std::fs::write(&path, "<mujoco>\n <worldbody>\n  <body><joint name='knee' axes='1 0 0'/></body>\n </worldbody>\n</mujoco>").unwrap();
    let error = load(&path).unwrap_err();
    std::fs::remove_file(&path).unwrap();
    let expected = format!(
        "{}:3: joint \"knee\": unknown attribute \"axes\"; did you mean \"axis\"?",
        path.display()
    );
    assert_eq!(error.to_string(), expected);
}

#[test]
fn files_that_are_no_models_are_refused() {
    let error = load("/nowhere/robot.xml").unwrap_err();
    assert_eq!(&*error.file, "/nowhere/robot.xml");
    assert!(error.message.contains("cannot read the file"), "{error}");
    assert!(
        load(std::env::temp_dir())
            .unwrap_err()
            .message
            .contains("cannot read the file")
    );
    assert!(rejected("").message.contains("empty"));
    assert!(rejected(" \n ").message.contains("empty"));
    assert!(rejected("not xml").message.contains("not well-formed"));
    assert!(rejected("<Mujoco/>").message.contains("<mujoco>"));
    assert!(rejected("<sdf/>").message.contains("<robot>"));
}

#[test]
fn broken_xml_is_located() {
    for text in [
        "<mujoco>\n<worldbody>\n<geom size='1'>\n</mujoco>",
        "<mujoco>\n<geom size='1' size='2'/>\n</mujoco>",
        "<mujoco>\n<geom size=1/>\n</mujoco>",
        "<mujoco>\n<option/>",
        "<!DOCTYPE m [<!ENTITY a 'b'>]>\n<mujoco model='&a;'/>",
    ] {
        let error = rejected(text);
        assert!(
            error.line.is_some() && error.message.contains("not well-formed"),
            "{text}: {error}"
        );
    }
}

#[test]
fn a_truncated_file_is_located_at_its_end() {
    for text in [
        "<mujoco>\n<worldbody>\n<geom si",
        "<mujoco>\n<option/>\n<worldbody>\n",
    ] {
        let error = rejected(text);
        assert_eq!(error.line, Some(3), "{error}");
        assert!(error.to_string().starts_with("line 3: "), "{error}");
    }
}

#[test]
fn bytes_that_are_not_utf8_stand_for_some_character() {
    let path = std::env::temp_dir().join(format!("clench-latin-{}.xml", std::process::id()));
    std::fs::write(&path, b"<mujoco>\n<!-- \xe9 -->\n</mujoco>").unwrap();
    let loaded = load(&path);
    std::fs::remove_file(&path).unwrap();
    loaded.unwrap();
}

#[test]
fn a_file_in_utf16_is_an_error_that_says_so() {
    let path = std::env::temp_dir().join(format!("clench-utf16-{}.xml", std::process::id()));
    for order in [u16::to_le_bytes, u16::to_be_bytes] {
        let units = "\u{feff}<mujoco/>".encode_utf16();
        std::fs::write(&path, Vec::from_iter(units.flat_map(order))).expect("a file");
        let error = load(&path).expect_err("not UTF-8");
        assert!(error.message.contains("UTF-16"), "{error}");
    }
    std::fs::remove_file(&path).expect("a file");
}

#[test]
fn nesting_has_a_bottom() {
    for depth in [600, 200_000] {
        let text = format!(
            "<mujoco><worldbody>{}{}</worldbody></mujoco>",
            "<body>".repeat(depth),
            "</body>".repeat(depth)
        );
        assert!(rejected(&text).message.contains("deep"));
        let open = rejected(&"<a>".repeat(depth));
        assert!(open.message.contains("not well-formed"), "{open}");
    }
}

#[test]
fn unknown_elements_and_attributes_are_refused() {
    expect(
        "<geoms/>",
        "geoms",
        "unknown element <geoms> in <worldbody>; did you mean \"geom\"?",
    );
    expect(
        "<body><joint typ='hinge'/></body>",
        "joint",
        "did you mean \"type\"?",
    );
    expect("<body class='a'/>", "body", "unknown attribute \"class\"");
    expect("<composite/>", "composite", "unknown element");
    expect_section(
        "<option apirate='100'/>",
        "option",
        "unknown attribute \"apirate\"",
    );
    expect_section(
        "<option Timestep='1'/>",
        "option",
        "did you mean \"timestep\"?",
    );
    expect_section(
        "<default><joint name='j'/></default>",
        "joint \"j\"",
        "cannot be given in a default",
    );
    expect_section("<option><flag/><flag/></option>", "flag", "only one");
}

#[test]
fn numbers_that_are_none_are_refused() {
    expect(
        "<geom size='1 a'/>",
        "geom",
        "\"a\" in size is not a finite number",
    );
    expect("<geom size='nan'/>", "geom", "not a finite number");
    expect("<geom size='inf'/>", "geom", "not a finite number");
    expect("<geom size='1e400'/>", "geom", "not a finite number");
    expect("<geom size='1,2'/>", "geom", "not a finite number");
    expect("<geom pos='1 2'/>", "geom", "pos needs 3 numbers, not 2");
    expect("<geom pos='1 2 3 4'/>", "geom", "more than 3");
    expect("<geom size='1 2 3 4'/>", "geom", "more than 3");
    expect("<geom condim='3.0'/>", "geom", "not a 32-bit integer");
    expect(
        "<geom group='99999999999'/>",
        "geom",
        "not a 32-bit integer",
    );
    expect("<geom condim='2'/>", "geom", "not 1, 3, 4 or 6");
    expect_section("<option iterations='-1'/>", "option", "negative");
    expect_section("<option timestep='0'/>", "option", "positive");
    expect_section("<option tolerance='-1'/>", "option", "tolerance");
    expect_section("<option impratio='0'/>", "option", "impratio");
    expect_section("<option viscosity='-1'/>", "option", "viscosity");
    expect_section("<compiler boundmass='-1'/>", "compiler", "boundmass");
    expect_section(
        "<option actuatorgroupdisable='31'/>",
        "option",
        "not in 0 to 30",
    );
    expect_section("<compiler eulerseq='xyq'/>", "compiler", "eulerseq");
}

/// As infinities they would be saved as text that cannot be read again.
#[test]
fn numbers_that_are_too_large_for_single_precision_are_refused() {
    let too_large = |name: &str| format!("in {name} is too large for single precision");
    expect(
        "<geom size='1' rgba='0 1e40 0 1'/>",
        "geom",
        &too_large("rgba"),
    );
    let section = |inside: &str, element: &str, name: &str| {
        let text = format!("<asset>{inside}</asset>");
        expect_section(&text, element, &too_large(name));
    };
    section(
        "<mesh name='m' vertex='1e39 0 0  0 1 0  0 0 1  0 0 0'/>",
        "mesh \"m\"",
        "vertex",
    );
    section(
        "<hfield name='h' nrow='2' ncol='2' size='1 1 1 1' elevation='0 1e39 0 1'/>",
        "hfield \"h\"",
        "elevation",
    );
    section(
        "<material name='m' shininess='1e39'/>",
        "material \"m\"",
        "shininess",
    );
    section(
        "<material name='m' texrepeat='1e39'/>",
        "material \"m\"",
        "texrepeat",
    );
    expect_section(
        "<worldbody><camera focal='1e39 1' sensorsize='1 1' resolution='8 8'/></worldbody>",
        "camera",
        &too_large("focal"),
    );
    expect_section(
        "<worldbody><camera focalpixel='1e38 1' sensorsize='1e3 1' resolution='8 8'/></worldbody>",
        "camera",
        "a length of the lens is too large for single precision",
    );
}

#[test]
fn unknown_keywords_are_refused() {
    expect("<geom type='ball'/>", "geom", "type is \"ball\"");
    expect(
        "<body><joint limited='True'/></body>",
        "joint",
        "not one of false, true, auto",
    );
    expect_section(
        "<option solver='newton'/>",
        "option",
        "not one of Newton, CG, PGS",
    );
    expect_section(
        "<option><flag contact='false'/></option>",
        "flag",
        "not one of disable, enable",
    );
}

#[test]
fn contradictory_and_missing_values_are_refused() {
    expect(
        "<body quat='1 0 0 0' euler='0 0 0'/>",
        "body",
        "cannot both be given",
    );
    expect("<body quat='0 0 0 0'/>", "body", "zero");
    expect("<body axisangle='0 0 0 1'/>", "body", "too short");
    expect(
        "<geom type='capsule' fromto='0 0 0 0 0 0' size='1'/>",
        "geom",
        "coincide",
    );
    expect(
        "<geom type='capsule' fromto='0 0 0 1 0 0' pos='1 0 0' size='1'/>",
        "geom",
        "cannot both",
    );
    expect(
        "<geom fromto='0 0 0 1 0 0' size='1'/>",
        "geom",
        "fromto needs a capsule",
    );
    expect("<joint/>", "joint", "the world cannot have joints");
    expect(
        "<body><inertial pos='0 0 0'/></body>",
        "inertial",
        "\"mass\" is required",
    );
    expect("<attach body='a'/>", "attach", "\"prefix\" is required");
    expect("<attach prefix='a'/>", "attach", "either model, or a body");
    expect(
        "<attach body='a' frame='b' prefix='p'/>",
        "attach",
        "cannot both",
    );
    expect(
        "<attach body='a' prefix='p'/>",
        "attach",
        "no body \"a\" before",
    );
    expect(
        "<attach model='arm' prefix='p'/>",
        "attach",
        "no model \"arm\"",
    );
    let nested = "<replicate count='2000'><replicate count='2000'/></replicate>";
    expect(nested, "replicate", "more than 500000 elements");
    expect(
        "<replicate count='2000000000'/>",
        "replicate",
        "more than 500000 elements",
    );
    expect(
        "<body><replicate count='2'><joint/></replicate></body>",
        "joint",
        "cannot be repeated",
    );
    expect(
        "<geom size='1' material='steel'/>",
        "geom",
        "no material \"steel\"",
    );
    expect_section(
        "<equality><connect body1='a'/></equality>",
        "connect",
        "\"anchor\" is required",
    );
    expect_section(
        "<equality><connect site1='a'/></equality>",
        "connect",
        "together",
    );
    expect_section(
        "<equality><weld body1='a' site1='b' site2='c'/></equality>",
        "weld",
        "cannot both",
    );
    expect_section("<equality><weld/></equality>", "weld", "must be given");
    expect_section("<tendon><fixed/></tendon>", "fixed", "at least one joint");
}

#[test]
fn unknown_names_are_refused() {
    expect("<geom class='x'/>", "geom", "no default class \"x\"");
    expect(
        "<body childclass='mian'/>",
        "body",
        "did you mean \"main\"?",
    );
    for section in [
        "<actuator><motor joint='nobody'/></actuator>",
        "<equality><weld body1='nobody'/></equality>",
        "<contact><pair geom1='nobody' geom2='nobody'/></contact>",
        "<contact><exclude body1='nobody' body2='nobody'/></contact>",
        "<tendon><fixed><joint joint='nobody' coef='1'/></fixed></tendon>",
    ] {
        let error = rejected(&format!("<mujoco>\n{section}\n</mujoco>"));
        assert_eq!(error.line, Some(2), "{error}");
        assert!(error.message.contains("nobody"), "{error}");
    }
}

#[test]
fn classes_with_bad_names_are_refused() {
    expect_section("<default class='x'/>", "default", "called \"main\"");
    expect_section("<default><default/></default>", "default", "needs a class");
    expect_section(
        "<default><default class='a'/><default class='a'/></default>",
        "default",
        "exists already",
    );
}

#[test]
fn errors_of_the_model_are_located_too() {
    let error =
        rejected("<mujoco><worldbody>\n<body name='ghost'>\n<joint/></body></worldbody></mujoco>");
    assert_eq!(error.line, Some(2), "{error}");
    assert!(error.message.contains("mass"), "{error}");
}

#[test]
fn a_site_with_the_volume_of_a_mesh_needs_one() {
    expect(
        "<site type='mesh'/>",
        "unnamed site of body \"world\"",
        "must refer to a mesh",
    );
}

#[test]
fn what_is_not_supported_yet_is_an_error_that_says_so() {
    let later = "not supported yet";
    for (line, element) in [
        ("<geom type='sdf' mesh='m'/>", "geom"),
        ("<flexcomp/>", "flexcomp"),
    ] {
        expect(line, element, later);
    }
    for (line, element) in [
        ("<sensor><plugin/></sensor>", "plugin"),
        ("<deformable><flex/></deformable>", "flex"),
        ("<extension><plugin/></extension>", "plugin"),
        ("<equality><flex/></equality>", "flex"),
        ("<option><flag speculative='enable'/></option>", "flag"),
    ] {
        expect_section(line, element, later);
    }
}

#[test]
fn unsupported_combinations_with_the_integrator_discrete_are_refused() {
    for (options, words) in [
        ("<option integrator='discrete' solver='PGS'/>", "PGS"),
        (
            "<option integrator='discrete'><flag sleep='enable' island='disable'/></option>",
            "islands",
        ),
    ] {
        let error = read_str(&format!("<mujoco>\n{options}</mujoco>")).expect_err("refused");
        assert_eq!(error.line, Some(2), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
    read_str("<mujoco><option integrator='discrete' solver='CG'/></mujoco>").unwrap();
}

#[test]
fn speculative_contacts_are_refused_with_the_reason() {
    let text = "<mujoco><option>\n<flag speculative='enable'/></option></mujoco>";
    let error = read_str(text).expect_err("not there yet");
    assert_eq!(error.line, Some(2), "{error}");
    assert!(error.to_string().contains("may still change"), "{error}");
}

#[test]
fn unsupported_attributes_without_effect_are_accepted() {
    read_str(
        "<mujoco>
           <option><flag ipc='disable' invdiscrete='enable'/></option>
         </mujoco>",
    )
    .unwrap();
}

#[test]
fn a_place_in_a_text_is_a_line() {
    let model = load_str("<mujoco>\n<worldbody><body/></worldbody></mujoco>").expect("valid");
    let place = model.bodies[1].origin.as_ref().expect("it is known");
    assert_eq!(place.to_string(), "line 2");
}
