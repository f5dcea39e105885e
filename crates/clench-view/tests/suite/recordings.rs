//! Pages with recordings return what was recorded; other pages are errors.

use clench::{Sim, load_str};
use clench_view::{Marks, Page, ReadError, RecordError, Recording, Scene};
use std::sync::Arc;

const MARKERS: [&str; 2] = [
    "<script id=\"recording\" type=\"application/json\">",
    "</script>",
];

fn page() -> Page {
    Page::of(format!("<html>{}</html>", MARKERS.concat())).expect("the page has a place for data")
}

#[test]
fn no_name_ends_the_data_or_hides_its_end() {
    let model = "<mujoco model='&lt;/script>'><worldbody><body name='&lt;!--&lt;script>'>
        <freejoint/><geom size='0.1'/></body></worldbody></mujoco>";
    let model = Arc::new(load_str(model).expect("the model is valid"));
    let mut sim = Sim::<f64>::new(Arc::clone(&model)).expect("the model can be simulated");
    let mut recording = Recording::new(Scene::new(&model), 1_000_000);
    let added = recording.append(&mut sim, &mut Marks::default());
    added.expect("the frame is below the limit");
    let mut html = Vec::new();
    let written = recording.write_html(&page(), &mut html);
    written.expect("memory can be written");
    let html = String::from_utf8(html).expect("the page is text");
    let (_, data) = html.split_once(MARKERS[0]).expect("the page has data");
    assert_eq!(data.find('<'), data.find(MARKERS[1]));
    let read = Recording::from_html(&html, 1_000_000).expect("the page is complete");
    assert!(read.is_of(Scene::new(&model)) && read.times() == [0.0]);
}

#[test]
fn data_of_another_form_is_an_error() {
    for data in [
        "[]",
        "1",
        "null",
        "\"a\"",
        "{}",
        "{\"frames\": []}",
        "{\"scene\": 1}",
        "{",
    ] {
        let html = MARKERS.join(data);
        let read = Recording::from_html(&html, 1_000_000);
        assert!(matches!(read, Err(ReadError::None)), "{data}");
    }
}

#[test]
fn a_small_limit_is_named() {
    let errors = [
        RecordError::Full(3, 0.0005).to_string(),
        ReadError::Full(0.0005).to_string(),
    ];
    assert!(
        errors
            .iter()
            .all(|error| error.contains("limit of 0.0005 MB")),
        "{errors:?}"
    );
}
