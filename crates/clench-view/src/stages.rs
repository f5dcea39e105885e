//! The stages of a step that the page plots. Each is the sum of some stages of a [`Profile`].

use clench::rigid::profile::Profile;
use std::time::Duration;

/// The plotted stages, in the order of a step.
pub const STAGES: [&str; 6] = [
    "kinematics",
    "collision",
    "forces",
    "assembly",
    "solve",
    "rest",
];

/// The stages of a [`Profile`] that sum to each of [`STAGES`].
const PARTS: [&[&str]; STAGES.len()] = [
    &["kinematics", "inertia", "mass factorization"],
    &["collision broad", "collision narrow"],
    &["velocity", "forces"],
    &["assembly"],
    &[
        "solve start",
        "hessian",
        "factorization",
        "direction",
        "line search",
        "evaluation",
        "solve rest",
    ],
    &["sensors", "integration", "rows and checks"],
];

/// The time of each of [`STAGES`], summed over all threads.
pub type StageTimes = [Duration; STAGES.len()];

/// Converts the cumulative totals of a [`Profile`] into the time of a step.
#[derive(Clone, Debug, Default)]
pub struct StageClock {
    /// The totals at the last call.
    last_totals: StageTimes,
}

impl StageClock {
    /// Returns the mean time of each stage over the `steps` taken since the last call.
    pub fn mean_since_last(&mut self, profile: &Profile, steps: u32) -> StageTimes {
        let mut totals = StageTimes::default();
        for (name, time) in &profile.stages {
            let stage = PARTS.iter().position(|parts| parts.contains(name));
            totals[stage.unwrap_or(STAGES.len() - 1)] += *time;
        }
        let before = std::mem::replace(&mut self.last_totals, totals);
        std::array::from_fn(|k| totals[k].saturating_sub(before[k]) / steps.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clench::Sim;
    use std::sync::Arc;

    #[test]
    fn every_stage_of_a_profile_is_part_of_one_that_is_plotted() {
        let text = "<mujoco>
             <worldbody>
               <geom type='plane' size='1 1 1'/>
               <body pos='0 0 .09'>
                 <freejoint/>
                 <geom size='.1'/>
               </body>
             </worldbody>
           </mujoco>";
        let model = clench::load_str(text).expect("a good model");
        let mut sim = Sim::<f64>::new(Arc::new(model)).expect("a simulation");
        sim.run_clocks(true);
        let mut clock = StageClock::default();
        for _ in 0..4 {
            sim.step().expect("a good step");
        }
        let profile = sim.profile();
        let mut names: Vec<&str> = profile.stages.iter().map(|(name, _)| *name).collect();
        let mut parts = PARTS.concat();
        names.sort_unstable();
        parts.sort_unstable();
        assert_eq!(names, parts);
        let sum: Duration = clock.mean_since_last(&profile, 1).iter().sum();
        assert_eq!(sum, profile.total());
        assert!(sum > Duration::ZERO);
        // No step was taken since.
        assert_eq!(clock.mean_since_last(&profile, 1), StageTimes::default());
    }
}
