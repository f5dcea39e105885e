//! The tree: bodies, joints, dofs, and the geoms and sites on them.

use super::{NONE, Tables, starts};
use crate::codes::{Code, codes};
use clench_rigid::dynamics::gyroscopic::is_free_tree;
use clench_rigid::model::{JointKind, Model};

codes! {
    of JointKind {
        Free = "FREE",
        Ball = "BALL",
        Slide = "SLIDE",
        Hinge = "HINGE",
    }
}

impl Tables {
    pub(super) fn bodies(&mut self, m: &Model) {
        let (p, bodies) = (&m.params, &m.bodies);
        self.count("NBODY", bodies.len());
        self.words("BODY_PARENT", bodies.iter().map(|b| b.parent));
        self.words("BODY_ROOT", bodies.iter().map(|b| b.root));
        let mocap = |b: Option<usize>| b.unwrap_or(NONE as usize);
        self.words("BODY_MOCAP", bodies.iter().map(|b| mocap(b.mocap)));
        self.words("BODY_JNT", starts(bodies.iter().map(|b| b.joints.len())));
        self.words("BODY_DOF", starts(bodies.iter().map(|b| b.dofs.len())));
        self.words("BODY_GEOM", starts(bodies.iter().map(|b| b.geoms.len())));
        self.words("BODY_SITE", starts(bodies.iter().map(|b| b.sites.len())));
        self.body_levels(m);
        let vectors =
            |v: &[clench_math::Vec3<f64>]| Vec::from_iter(v.iter().flat_map(|v| v.to_array()));
        let quats =
            |q: &[clench_math::Quat<f64>]| Vec::from_iter(q.iter().flat_map(|q| q.to_array()));
        self.numbers("BODY_POS", vectors(&p.body_pos));
        self.numbers("BODY_QUAT", quats(&p.body_quat));
        self.numbers("BODY_IPOS", vectors(&p.body_ipos));
        self.numbers("BODY_IQUAT", quats(&p.body_iquat));
        self.numbers("BODY_MASS", p.body_mass.iter().copied());
        self.numbers("BODY_SUBTREEMASS", p.body_subtreemass.iter().copied());
        // Only constraints that are added at run time need the bodies' own.
        let slots = m.max_dynamic_constraints > 0;
        let weights = p.body_invweight0.iter().filter(|_| slots);
        self.numbers("BODY_INVWEIGHT0", weights.flatten().copied());
        self.numbers("BODY_INERTIA", vectors(&p.body_inertia));
        self.numbers("GEOM_POS", vectors(&p.geom_pos));
        self.numbers("GEOM_QUAT", quats(&p.geom_quat));
        self.numbers("GEOM_SIZE", vectors(&p.geom_size));
        self.words("SITE_BODY", m.sites.iter().map(|s| s.body));
        self.numbers("SITE_POS", vectors(&p.site_pos));
        self.numbers("SITE_QUAT", quats(&p.site_quat));
        self.numbers("JNT_POS", vectors(&p.jnt_pos));
        self.numbers("JNT_AXIS", vectors(&p.jnt_axis));
    }

    /// Adds the bodies by depth in the tree, level by level, and the children of each body, the last first.
    fn body_levels(&mut self, m: &Model) {
        let mut depths = vec![0; m.nbody()];
        let mut children = vec![Vec::new(); m.nbody()];
        for b in (1..m.nbody()).rev() {
            children[m.bodies[b].parent].push(b);
        }
        for b in 1..m.nbody() {
            depths[b] = depths[m.bodies[b].parent] + 1;
        }
        let mut levels = vec![Vec::new(); depths.iter().max().map_or(0, |&most| most + 1)];
        for (b, &depth) in depths.iter().enumerate() {
            levels[depth].push(b);
        }
        self.count("NBODY_LEVEL", levels.len());
        self.words("BODY_LEVEL", starts(levels.iter().map(Vec::len)));
        self.words("LEVEL_BODY", levels.concat());
        self.words("BODY_CHILD", starts(children.iter().map(Vec::len)));
        self.words("CHILD_BODY", children.concat());
    }

    pub(super) fn joints(&mut self, m: &Model) {
        let joints = &m.joints;
        self.codes::<JointKind>();
        self.count("NJNT", joints.len());
        self.count("NQ", m.nq);
        self.words("JNT_KIND", joints.iter().map(|j| j.kind.code()));
        self.words("JNT_BODY", joints.iter().map(|j| j.body));
        self.words("JNT_QPOS", joints.iter().map(|j| j.qpos));
        self.words("JNT_DOF", joints.iter().map(|j| j.dof).chain([m.nv]));
        let free_trees = Vec::from_iter((0..joints.len()).filter(|&j| is_free_tree(m, j)));
        self.count("NFREE_TREE", free_trees.len());
        self.words("FREE_TREE_JNT", free_trees);
        self.numbers("QPOS0", m.params.qpos0.iter().copied());
        self.numbers("QPOS_SPRING", m.params.qpos_spring.iter().copied());
    }

    /// Adds dofs, the pattern of the mass matrix, and the dofs that move each body.
    pub(super) fn dofs(&mut self, m: &Model) {
        let (tree, nv) = (&m.tree, m.nv);
        self.count("NV", nv);
        self.count("NNZ", tree.nnz());
        self.words("DOF_BODY", m.dofs.iter().map(|d| d.body));
        self.words("DOF_JNT", m.dofs.iter().map(|d| d.joint));
        self.words("TREE_START", (0..=nv).map(|i| tree.row_start(i)));
        let pivots =
            (0..nv).flat_map(|i| tree.row(i).iter().map(move |_| tree.row_start(i + 1) - 1));
        self.words("TREE_PIVOT", pivots);
        let columns = (0..nv).flat_map(|i| tree.row(i));
        self.words("TREE_DOF", columns.map(|&j| j as usize));
        let mut below = vec![Vec::new(); nv];
        for i in 0..nv {
            let above = tree.row(i).iter().filter(|&&j| j as usize != i);
            above.for_each(|&j| below[j as usize].push(i));
        }
        self.words("BELOW_START", starts(below.iter().map(Vec::len)));
        let places = (0..nv).flat_map(|i| {
            let depth = tree.row(i).len() - 1;
            below[i].iter().map(move |&k| tree.row_start(k) + depth)
        });
        self.words("BELOW_PLACE", places);
        self.words("BELOW_DOF", below.concat());
        let mut levels = vec![Vec::new(); (0..nv).map(|i| tree.row(i).len()).max().unwrap_or(0)];
        (0..nv).for_each(|i| levels[tree.row(i).len() - 1].push(i));
        let longest = |level: &Vec<usize>| level.iter().map(|&i| below[i].len()).max();
        let turns = levels.iter().filter_map(longest).sum::<usize>();
        self.flag("DOF_BY_DOF", nv < turns);
        self.count("NLEVEL", levels.len());
        self.words("LEVEL_START", starts(levels.iter().map(Vec::len)));
        self.words("LEVEL_DOF", levels.concat());
        let words = nv.div_ceil(32);
        let mut masks = vec![0; m.nbody() * words];
        for (mask, body) in masks.chunks_exact_mut(words.max(1)).zip(&m.bodies) {
            let moving = body.last_dof.map_or(&[][..], |last| tree.row(last));
            for &dof in moving {
                mask[dof as usize / 32] |= 1 << (dof % 32);
            }
        }
        self.count("MASK_WORDS", words);
        self.words("DOF_MASK", masks);
        let invweight0 = &m.params.dof_invweight0;
        self.numbers("DOF_INVWEIGHT0", invweight0.iter().copied());
    }

    pub(super) fn geoms(&mut self, m: &Model) {
        self.count("NGEOM", m.geoms.len());
        self.words("GEOM_KIND", m.geoms.iter().map(|g| g.kind.code()));
        self.words("GEOM_BODY", m.geoms.iter().map(|g| g.body));
    }
}
