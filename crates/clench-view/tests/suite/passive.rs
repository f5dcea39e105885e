//! A viewer for a loop of the user's own.

use crate::server::{connect, page, say};
use clench::{Sim, load_str};
use clench_view::interaction::Interaction;
use clench_view::{PassiveViewer, ServerOptions};
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

#[test]
fn a_paused_loop_that_does_not_wait_takes_the_requested_steps() {
    let model = Arc::new(load_str("<mujoco/>").expect("valid"));
    let mut sim = Sim::<f64>::new(model).expect("valid");
    let paused = Interaction::new(true);
    let mut viewer = PassiveViewer::start(&ServerOptions::default(), page(), paused, &mut sim)
        .expect("a server");
    let mut socket = connect(viewer.server());
    let mut steps = 0;
    let mut iterate = |viewer: &mut PassiveViewer| {
        viewer.sync(&mut sim).expect("valid");
        if !viewer.paused() {
            sim.step().expect("valid");
            steps += 1;
        }
        sleep(Duration::from_millis(2));
        steps
    };
    assert_eq!(iterate(&mut viewer), 0);
    say(&mut socket, r#"{"do": "step", "count": 3}"#);
    assert!((0..5000).any(|_| iterate(&mut viewer) == 3));
    for _ in 0..20 {
        assert_eq!(iterate(&mut viewer), 3);
    }
    assert!(viewer.paused() && viewer.interaction.paused);
    viewer.set_paused(false);
    assert_eq!(iterate(&mut viewer), 4);
}
