//! How the time of a step splits over its stages, as far as a plot can tell them apart.

use clench::rigid::profile::Profile;
use std::time::Duration;

/// What is plotted, in the order of a step, and the stages of a [`Profile`] that belong to it.
const GROUPS: [(&str, &[&str]); 6] = [
    (
        "kinematics",
        &["kinematics", "inertia", "mass factorization"],
    ),
    ("collision", &["collision broad", "collision narrow"]),
    ("forces", &["velocity", "forces"]),
    ("assembly", &["assembly"]),
    (
        "solve",
        &[
            "solve start",
            "hessian",
            "factorization",
            "direction",
            "line search",
            "evaluation",
            "solve rest",
        ],
    ),
    ("rest", &["sensors", "integration", "rows and checks"]),
];

/// The names of what is plotted, in the order of a step.
pub const STAGES: [&str; GROUPS.len()] = {
    let mut names = [""; GROUPS.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = GROUPS[index].0;
        index += 1;
    }
    names
};

/// The time of each of [`STAGES`]; of all threads together.
pub type StageTimes = [Duration; STAGES.len()];

/// Splits the time of steps by what clocks say that never stop.
#[derive(Clone, Debug, Default)]
pub struct StageClock {
    /// What they said last.
    before: StageTimes,
}

impl StageClock {
    /// What a step took in each stage, where so many were taken since the last call.
    pub fn since_last(&mut self, profile: &Profile, steps: u32) -> StageTimes {
        let mut now = StageTimes::default();
        for (name, time) in &profile.stages {
            let group = GROUPS.iter().position(|(_, stages)| stages.contains(name));
            now[group.unwrap_or(STAGES.len() - 1)] += *time;
        }
        let before = std::mem::replace(&mut self.before, now);
        std::array::from_fn(|k| now[k].saturating_sub(before[k]) / steps.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clench::Sim;
    use std::sync::Arc;

    #[test]
    fn every_stage_of_a_step_belongs_to_one_group() {
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
        let mut grouped: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, stages)| *stages)
            .copied()
            .collect();
        names.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(names, grouped);
        let sum: Duration = clock.since_last(&profile, 1).iter().sum();
        assert_eq!(sum, profile.total());
        assert!(sum > Duration::ZERO);
        // Nothing has happened since.
        assert_eq!(clock.since_last(&profile, 1), StageTimes::default());
    }
}
