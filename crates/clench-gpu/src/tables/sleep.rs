//! The trees that may sleep, and what couples them. Without the flag `sleep` the tables are empty.

use super::{NONE, Tables};
use crate::codes::row;
use clench_rigid::model::{Coupled, Model, SleepPolicy};
use clench_rigid::settings::StepSettings;
use clench_solver::Switch;

row! {
    /// The words of a kinematic tree.
    words SleeperWords, "SLEEPER" {
        qpos,
        qpos_end,
        dof,
        dof_end,
        body,
        body_end,
        /// The mocap body that carries it.
        mocap,
        /// Nonzero if it may not sleep.
        never,
    }
}
row! {
    /// The words of a tendon that acts on two trees, and wakes one by the other.
    words TieWords, "TIE" {
        tendon,
        first,
        second,
        /// Its limit and its dry friction, if it has them.
        limit,
        friction,
    }
}
row! {
    /// The words of two trees that an equality couples.
    words CoupleWords, "COUPLE" {
        equality,
        first,
        second,
    }
}

impl Tables {
    /// Adds the trees, and the tree of each body and dof. `limited` are the coordinates with limits, `rubbing` the
    /// sources of dry friction, `slots` the number of slots.
    pub(super) fn sleep(
        &mut self,
        m: &Model,
        s: &StepSettings,
        (limited, rubbing): (&[usize], &[usize]),
        slots: usize,
    ) {
        let sleeps = s.flags.sleep;
        let trees = if sleeps { &m.trees[..] } else { &[] };
        self.fixed_flag("SLEEP", sleeps);
        // Activations and delays change while trees sleep, and equalities and slots may wake trees in any step.
        let bare = m.actuators.is_empty() && m.equalities.is_empty() && slots == 0;
        let rests = bare && m.nhistory == 0 && m.nplastic == 0;
        self.fixed_flag("MAY_REST", sleeps && rests);
        self.flag("ISLANDS", s.solver.islands != Switch::Off);
        self.count("NTREE", trees.len());
        self.count("NASLEEP_POSE", if sleeps { m.nq + 7 * m.nmocap } else { 0 });
        self.row::<SleeperWords>();
        let sleepers = trees.iter().map(|tree| SleeperWords {
            qpos: tree.qpos.start,
            qpos_end: tree.qpos.end,
            dof: tree.dofs.start,
            dof_end: tree.dofs.end,
            body: tree.bodies.start,
            body_end: tree.bodies.end,
            mocap: tree.mocap.unwrap_or(NONE as usize),
            never: usize::from(tree.sleep == SleepPolicy::Never),
        });
        self.words("SLEEPERS", sleepers.flat_map(SleeperWords::words));
        let dofs = if sleeps { m.nv } else { 0 };
        self.words("DOF_TREE", (0..dofs).map(|i| m.tree.tree_of(i)));
        let bodies = if sleeps { m.nbody() } else { 0 };
        self.words("BODY_TREE", (0..bodies).map(|b| place_of(m, b)));
        let p = &m.params;
        self.numbers("SLEEP_TOLERANCE", [p.sleep_tolerance]);
        self.numbers("DOF_LENGTH", p.dof_length[..dofs].iter().copied());
        self.ties(m, sleeps, limited, rubbing);
        self.couples(m, sleeps);
    }

    /// Adds the tendons that wake one tree by another.
    fn ties(&mut self, m: &Model, sleeps: bool, limited: &[usize], rubbing: &[usize]) {
        let place = |list: &[usize], x: usize| list.iter().position(|&y| y == x);
        let tie = |t: usize| {
            let [first, second] = m.tendon_ties[t].filter(|_| sleeps)?;
            let limit = place(limited, m.joints.len() + t);
            let friction = place(rubbing, m.nv + t);
            (limit.is_some() || friction.is_some()).then_some(TieWords {
                tendon: t,
                first,
                second,
                limit: limit.unwrap_or(NONE as usize),
                friction: friction.unwrap_or(NONE as usize),
            })
        };
        let ties = Vec::from_iter((0..m.tendons.len()).filter_map(tie));
        self.row::<TieWords>();
        self.count("NTIE", ties.len());
        self.words("TIES", ties.into_iter().flat_map(TieWords::words));
    }

    /// Adds the trees that equalities couple, including those that are off.
    fn couples(&mut self, m: &Model, sleeps: bool) {
        let mut couples = Vec::new();
        let equalities = if sleeps { &m.equalities[..] } else { &[] };
        for (equality, target) in equalities.iter().map(|e| e.target).enumerate() {
            let places = match target.coupled() {
                Coupled::Points(bodies) | Coupled::Frames(bodies) => {
                    bodies.map(|b| place_of(m, b)).to_vec()
                }
                Coupled::Joints(follower, leader) => {
                    let joints = [Some(follower), leader].into_iter().flatten();
                    joints.map(|j| m.tree.tree_of(m.joints[j].dof)).collect()
                }
                Coupled::Tendons(follower, leader) => {
                    let tendons = [Some(follower), leader].into_iter().flatten();
                    let dofs = tendons.flat_map(|tendon| m.tendon_dofs.dofs(tendon));
                    dofs.map(|&dof| m.tree.tree_of(dof as usize)).collect()
                }
            };
            // A fixed body wakes nothing.
            let places = Vec::from_iter(places.into_iter().filter(|&place| place != m.ntree()));
            if let [first, ref others @ ..] = places[..] {
                let others = others.iter().filter(|&&second| second != first);
                couples.extend(others.map(|&second| CoupleWords {
                    equality,
                    first,
                    second,
                }));
            }
        }
        self.row::<CoupleWords>();
        self.count("NCOUPLE", couples.len());
        self.words("COUPLES", couples.into_iter().flat_map(CoupleWords::words));
    }
}

/// Returns the tree of a body; for others the number of trees if it is fixed, and one more if a mocap body carries it.
fn place_of(m: &Model, body: usize) -> usize {
    let others = m.ntree() + usize::from(!m.is_fixed(body));
    m.tree_of_body(body).unwrap_or(others)
}
