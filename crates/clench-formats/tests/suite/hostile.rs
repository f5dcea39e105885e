//! Malicious files: deep, wide, with misleading names, or short ones that request gigabytes. Each is an error with
//! location and reason, on a small stack and in little time.

use crate::assets::Folder;
use clench_formats::{LoadError, load_str, load_str_within, load_within};
use clench_rigid::{Budget, Model};
use std::time::{Duration, Instant};

/// Loads in a thread with a stack of 256 kB, as in some programs.
fn on_a_small_stack(text: String) -> Result<Model, LoadError> {
    std::thread::Builder::new()
        .stack_size(256 << 10)
        .spawn(move || load_str(&text))
        .unwrap()
        .join()
        .unwrap()
}

fn nested(open: &str, close: &str, depth: usize) -> String {
    let (open, close) = (open.repeat(depth), close.repeat(depth));
    format!("<mujoco><worldbody>{open}<geom size='1'/>{close}</worldbody></mujoco>")
}

#[track_caller]
fn refused(result: Result<Model, LoadError>, words: &[&str]) -> LoadError {
    let error = result.expect_err("it was accepted");
    let text = error.to_string();
    for word in words {
        assert!(text.contains(word), "no {word:?} in: {text}");
    }
    assert!(text.len() < 2000, "{} bytes of message", text.len());
    error
}

/// Returns a budget of `count` megabytes.
fn megabytes(count: u64) -> Budget {
    Budget {
        bytes: count << 20,
        ..Budget::default()
    }
}

#[test]
fn all_legal_levels_fit_into_a_small_stack() {
    for (open, close) in [
        ("<body>", "</body>"),
        ("<frame>", "</frame>"),
        ("<replicate count='1'>", "</replicate>"),
        ("<body><!--></body>-->", "</body>"),
    ] {
        // 500 levels, three of which are <mujoco>, <worldbody> and the geom.
        on_a_small_stack(nested(open, close, 497)).unwrap();
        refused(on_a_small_stack(nested(open, close, 498)), &["500 deep"]);
    }
    let classes: String = (0..497)
        .map(|i| format!("<default class='c{i}'>"))
        .collect();
    let ends = "</default>".repeat(497);
    let text = format!("<mujoco><default>{classes}{ends}</default></mujoco>");
    on_a_small_stack(text).unwrap();
}

#[test]
fn an_open_comment_hides_no_depth() {
    // `<!-->` opens a comment; the apparent end tag is inside of it.
    let text = nested("<body><!--></body>-->", "</body>", 20_000);
    refused(on_a_small_stack(text), &["500 deep"]);
    let text = "<body><!--></body>-->".repeat(20_000);
    refused(on_a_small_stack(text), &["not well-formed"]);
}

#[test]
fn includes_as_many_as_there_are_fit_into_a_small_stack() {
    let folder = Folder::new("includes");
    let count = 600;
    for i in 0..count {
        let next = i + 1;
        folder.write(
            &format!("{i}.xml"),
            format!("<m><include file='{next}.xml'/></m>"),
        );
    }
    folder.write(&format!("{count}.xml"), "<m><option timestep='0.5'/></m>");
    folder.write("model.xml", "<mujoco><include file='0.xml'/></mujoco>");
    let path = folder.0.join("model.xml");
    let thread = std::thread::Builder::new().stack_size(256 << 10);
    let model = thread.spawn(move || clench_formats::load(path)).unwrap();
    assert_eq!(model.join().unwrap().unwrap().params.timestep, 0.5);
}

#[test]
fn names_in_a_namespace_are_other_names() {
    let attribute =
        "<mujoco xmlns:x='urn:x'><worldbody>\n<geom x:size='3' size='1'/></worldbody></mujoco>";
    let error = refused(
        load_str(attribute),
        &["2: geom: unknown attribute \"x:size\""],
    );
    assert_eq!(error.line, Some(2));
    let element = "<mujoco xmlns:x='urn:x'><worldbody>\n<x:geom size='1'/></worldbody></mujoco>";
    refused(load_str(element), &["2: ", "unknown element <x:geom>"]);
    refused(
        load_str("<mujoco><option xml:space='preserve'/></mujoco>"),
        &["unknown attribute \"xml:space\""],
    );
    // MuJoCo ignores attributes of the root that have a prefix.
    load_str("<mujoco xml:space='preserve'/>").expect("MuJoCo takes it");
    // The same holds for an undeclared prefix, which is an error of XML itself but not of MuJoCo's parser.
    refused(
        load_str("<mujoco>\n<x:option/></mujoco>"),
        &["2: ", "unknown element <x:option>"],
    );
    // An unused declaration has no effect, and neither has one for names without a prefix.
    load_str("<mujoco xmlns='urn:x'><worldbody><geom size='1'/></worldbody></mujoco>").unwrap();
    load_str("<mujoco xmlns:x='urn:x'><worldbody><geom size='1'/></worldbody></mujoco>").unwrap();
}

#[test]
fn quadratic_growth_with_the_file_is_limited() {
    let start = Instant::now();
    let attributes: String = (0..50_000).map(|i| format!(" a{i}=''")).collect();
    refused(
        load_str(&format!("<mujoco>\n<option{attributes}/></mujoco>")),
        &["2: ", "more than 200 attributes"],
    );
    let namespaces: String = (0..150).map(|i| format!(" xmlns:a{i}='{i}'")).collect();
    refused(
        load_str(&format!("<mujoco{namespaces}/>")),
        &["more than 20 declarations"],
    );
    let classes: String = (0..30_000)
        .map(|i| format!("<default class='some_class_{i}'/>"))
        .collect();
    load_str(&format!("<mujoco><default>{classes}</default></mujoco>")).unwrap();
    // Equals signs outside of attributes do not count.
    let line = "=".repeat(500);
    load_str(&format!("<mujoco><!-- {line} --><worldbody/></mujoco>")).unwrap();
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn messages_cut_long_values() {
    let long = "n".repeat(20_000);
    let world = |inside: &str| format!("<mujoco><worldbody>\n{inside}</worldbody></mujoco>");
    let start = Instant::now();
    for text in [
        world(&format!("<geom {long}='1'/>")),
        world(&format!("<geom material='{long}'/>")),
        world(&format!("<geom class='{long}'/>")),
        world(&format!("<geom size='{long}'/>")),
        world(&format!("<geom type='{long}'/>")),
        world(&format!("<geom name='{long}' mesh='{long}'/>")),
        world(&format!("<{long}/>")),
        world(&format!("<body name='{long}'><joint/></body>")),
        world(&format!(
            "<geom name='{long}' size='1'/><geom name='{long}' size='1'/>"
        )),
    ] {
        refused(load_str(&text), &["2: ", "[... "]);
    }
    // Both names are long, and many names are known.
    let materials: String = (0..50)
        .map(|i| format!("<material name='{i}{long}'/>"))
        .collect();
    refused(
        load_str(&format!(
            "<mujoco><asset>{materials}</asset><worldbody><geom material='{long}'/></worldbody></mujoco>"
        )),
        &["there is no material"],
    );
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn height_fields_share_one_budget() {
    let fields: String = (0..40)
        .map(|i| format!("<hfield name='h{i}' nrow='4096' ncol='4096' size='1 1 1 1'/>\n"))
        .collect();
    let text = format!("<mujoco><asset>\n{fields}</asset></mujoco>");
    let error = refused(load_str(&text), &["hfield \"h5\"", "bytes", "--budget"]);
    assert_eq!(error.line, Some(7));
    // One field is within a budget of its own, but not within a smaller one.
    let one =
        "<mujoco><asset><hfield name='h' nrow='1024' ncol='1024' size='1 1 1 1'/></asset></mujoco>";
    load_str_within(one, megabytes(40)).unwrap();
    refused(
        load_str_within(one, megabytes(20)),
        &["hfield \"h\"", "20971520"],
    );
    let huge = one.replace("1024", "2147483647");
    refused(load_str(&huge), &["hfield \"h\"", "bytes"]);
}

#[test]
fn made_meshes_are_counted() {
    let fine = "<mesh name='m' builtin='supersphere' params='1000 1 1'/>";
    let text = |mesh: &str| format!("<mujoco><asset>\n{mesh}</asset></mujoco>");
    refused(
        load_str_within(&text(fine), megabytes(100)),
        &["2: mesh \"m\"", "bytes"],
    );
    load_str_within(&text(&fine.replace("1000", "50")), megabytes(100)).unwrap();
}

#[test]
fn pictures_are_counted_before_they_are_unpacked() {
    let folder = Folder::new("picture");
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 4000, 4000);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![0; 16_000_000]).unwrap();
    writer.finish().unwrap();
    folder.write("flat.png", bytes);
    folder.write(
        "model.xml",
        "<mujoco><asset>\n<hfield file='flat.png' size='1 1 1 1'/></asset></mujoco>",
    );
    let loaded = load_within(folder.0.join("model.xml"), megabytes(200));
    refused(loaded, &["model.xml:2: hfield", "flat.png", "bytes"]);
}

/// Replicas are refused before they are created: these files would fill the memory and never finish.
#[test]
fn replicas_are_counted() {
    let geoms = "<geom size='1'/>".repeat(60);
    let world = |inside: &str| format!("<mujoco><worldbody>\n{inside}\n</worldbody></mujoco>");
    refused(
        load_str(&world(&format!(
            "<replicate count='100000'>{geoms}</replicate>"
        ))),
        &["2: replicate", "500000 elements", "--budget"],
    );
    // Counts of nested replicas multiply, even if the replicas are empty.
    let inside = |what: &str| {
        format!("<replicate count='2000'><replicate count='2000'>{what}</replicate></replicate>")
    };
    refused(load_str(&world(&inside(""))), &["2: replicate", "elements"]);
    refused(load_str(&world(&inside("<camera/>"))), &["2: ", "elements"]);
    refused(
        load_str(&world("<replicate count='2147483647'/>")),
        &["elements"],
    );
    // Replicas append a suffix to names, which counts too.
    let long = "s".repeat(1_000_000);
    refused(
        load_str(&world(&format!(
            "<replicate count='100000' sep='{long}'><site name='a'/></replicate>"
        ))),
        &["2: replicate", "bytes"],
    );
    refused(
        load_str(&world(&format!(
            "<replicate count='100000'><geom size='1' name='{long}'/></replicate>"
        ))),
        &["2: replicate", "bytes"],
    );
    // A reasonable count is accepted.
    let ten = world("<replicate count='10'><geom size='1'/></replicate>");
    let few = Budget {
        elements: 15,
        ..Budget::default()
    };
    refused(load_str_within(&ten, few), &["15 elements"]);
    assert_eq!(
        load_str_within(&ten, few.times(2.0)).unwrap().geoms.len(),
        10
    );
}

#[test]
fn elements_and_classes_are_counted() {
    let few = Budget {
        elements: 1000,
        ..Budget::default()
    };
    let geoms = "<geom size='1'/>\n".repeat(1000);
    let text = format!("<mujoco><worldbody>\n{geoms}</worldbody></mujoco>");
    let error = refused(load_str_within(&text, few), &["1000 elements"]);
    assert_eq!(error.line, Some(1000));
    // Each class stores the defaults of every kind of element.
    let classes: String = (0..1000)
        .map(|i| format!("<default class='c{i}'/>\n"))
        .collect();
    let text = format!("<mujoco><default>\n{classes}</default></mujoco>");
    refused(load_str_within(&text, megabytes(1)), &["default", "bytes"]);
    // Each class would store the long name of its parent.
    let long = "m".repeat(100_000);
    let text = format!("<mujoco><default><geom mesh='{long}'/>{classes}</default></mujoco>");
    refused(load_str_within(&text, megabytes(64)), &["default", "bytes"]);
}

#[test]
fn matrices_and_keyframes_are_counted_before_they_are_made() {
    let bodies = |count: usize| "<body><freejoint/><geom size='1'/></body>".repeat(count);
    let keys = format!(
        "<mujoco><size nkey='10000'/><worldbody>{}</worldbody></mujoco>",
        bodies(1000)
    );
    refused(
        load_str_within(&keys, megabytes(64)),
        &["keyframe", "10000", "bytes"],
    );
    let small = Budget {
        matrix: 1000,
        ..Budget::default()
    };
    let chain = nested("<body><joint/><geom size='1'/>", "</body>", 60);
    refused(
        load_str_within(&chain, small),
        &["mass matrix", "1830", "1000"],
    );
    let motors = "<motor joint='j'/>".repeat(20);
    let text = format!(
        "<mujoco><worldbody>{}<body><joint name='j'/><geom size='1'/></body></worldbody><actuator>{motors}</actuator></mujoco>",
        bodies(10)
    );
    refused(
        load_str_within(&text, small),
        &["moment arms", "1220", "1000"],
    );
    load_str_within(&text, small.times(2.0)).unwrap();
}

#[test]
fn files_are_counted_as_they_are_read() {
    let folder = Folder::new("long");
    let long = " ".repeat(2 << 20);
    folder.write("model.xml", format!("<mujoco>{long}</mujoco>"));
    let path = folder.0.join("model.xml");
    refused(load_within(&path, megabytes(1)), &["model.xml", "bytes"]);
    clench_formats::load(&path).unwrap();
    folder.write("parts/x.obj", long);
    folder.write(
        "model.xml",
        "<mujoco><asset>\n<mesh file='parts/x.obj'/></asset></mujoco>",
    );
    refused(
        load_within(&path, megabytes(1)),
        &["model.xml:2: mesh", "bytes"],
    );
}

#[test]
fn a_singular_mass_matrix_is_found_at_its_joint() {
    // The second of two slides along one axis moves only the body that the first one moves already.
    let text = "<mujoco><worldbody><body name='cart'>
        <joint name='first' type='slide' axis='1 0 0'/>
        <joint name='second' type='slide' axis='1 0 0'/>
        <geom size='1'/>
    </body></worldbody></mujoco>";
    let words = &[
        "2: joint \"first\" of body \"cart\"",
        "not positive definite",
        "(dof 0)",
    ];
    refused(load_str(text), words);
}

/// A model that resets whenever it diverges would never finish the search.
#[test]
fn a_length_range_that_diverges_is_an_error_with_autoreset_too() {
    let file = "<mujoco>
          <compiler><lengthrange accel='1e15'/></compiler>
          <option><flag autoreset='enable'/></option>
          <worldbody><body><joint name='a' type='slide'/><geom size='0.1'/></body></worldbody>
          <actuator><muscle name='pull' joint='a'/></actuator>
        </mujoco>";
    let words = ["actuator \"pull\"", "length range", "diverged"];
    refused(load_str(file), &words);
}
