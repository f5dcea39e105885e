//! The profile of a run adds up, and distinguishes the pairs of the narrow phase by kind.

use crate::program::{model, simulate, summary};
use serde_json::Value;

/// Returns the summary of half a second of an arm next to a box.
fn profile(words: &str) -> Value {
    summary(&simulate(
        &model("arm_and_box"),
        &format!("--json --profile --time 0.5 {words}"),
        &[],
    ))
}

fn sum(rows: &Value, key: &str) -> f64 {
    let rows = rows.as_array().unwrap().iter();
    rows.map(|row| row[key].as_f64().unwrap()).sum()
}

#[test]
fn pairs_take_part_of_the_narrow_phase_and_make_the_contacts() {
    for words in ["", "--envs 16 --threads 1"] {
        let figures = profile(words);
        let (stages, pairs) = (&figures["profile"], &figures["pairs"]);
        let narrow = stages.as_array().unwrap().iter();
        let narrow = narrow.filter(|row| row["stage"] == "collision narrow");
        let narrow: f64 = narrow
            .map(|row| row["microseconds"].as_f64().unwrap())
            .sum();
        let spent = sum(pairs, "microseconds");
        assert!(
            spent > 0.0 && spent <= narrow,
            "{words}: {spent} of {narrow}"
        );
        let (near, touching) = (sum(pairs, "near"), sum(pairs, "touching"));
        assert!(
            touching > 0.0 && touching <= near,
            "{words}: {touching} of {near}"
        );
        // A touching pair makes at least one contact.
        let contacts = figures["contacts_mean"].as_f64().unwrap();
        assert!(touching <= contacts, "{words}: {touching} of {contacts}");
        let boxes = serde_json::json!(["box", "box"]);
        let mut rows = pairs.as_array().unwrap().iter();
        let rests = rows.any(|row| row["kinds"] == boxes && row["touching"].as_f64() >= Some(1.0));
        assert!(rests, "{words}: the box rests on the table: {pairs}");
    }
}
