//! The fields of a state, one per line. Memory, rows of batches, checks, copies, and the names in files and in Python
//! follow from this table.

/// Passes the table to the macro `$then`: groups of lines
///
/// ```text
/// /// What it is (how many).
/// name set_name: Kind, Size, Bound;
/// ```
///
/// with one of the [kinds](crate::state::kind), the [size](crate::state::Size) that is the number of elements, the
/// limit of its numbers, and the name of its setter in Python. The groups define the access by a step: it reads and
/// writes `moving` fields; it only reads `inputs`; `occasional` inputs are mostly zero, and then cost nothing. The
/// time, always in double precision, is separate.
#[doc(hidden)]
#[macro_export]
macro_rules! state_fields {
    ($then:ident) => {
        $then! {
            moving {
                /// Position coordinates (nq): m, rad, and unit quaternions, w first.
                qpos set_qpos: Number, Positions, Near;
                /// Velocities (nv), m/s or rad/s.
                qvel set_qvel: Number, Dofs, Near;
                /// Activations of actuators (na).
                act set_act: Number, Activations, Finite;
                /// Rest positions of yielding springs (nplastic): the position of a slide or hinge joint, the
                /// orientation of a ball joint (a unit quaternion, w first), the ends of a tendon's dead band. Joints
                /// first, in order.
                plastic set_plastic: Number, Plastic, Finite;
                /// Buffers of past values of delayed actuators and sensors (nhistory). Each has one number, then the
                /// times of its samples relative to the present, s, oldest first, then their values.
                history set_history: Number, History, Finite;
                /// Acceleration of the previous step, the starting point of the solver (nv), m/s² or rad/s².
                qacc_warmstart set_qacc_warmstart: Number, Dofs, Finite;
                /// Sleep counters of trees (ntree with the flag ``sleep``, else none): negative for an awake tree, from
                /// -11 for a moving one to -1 for one that has come to rest; else the index of the next tree of the
                /// sleeping island, in a cycle.
                tree_asleep set_tree_asleep: Integer, Trees, Finite;
                /// Positions of sleeping trees, then position and orientation of each mocap body after the last step
                /// (nq + 7 nmocap with the flag ``sleep``, else none). A tree that is elsewhere wakes.
                pose_asleep set_pose_asleep: Number, AsleepPose, Finite;
                /// Stick references of pairs of geoms (max_stick_pairs, 9; none without the option ``stiction``): both
                /// geoms, each plus one (0 in empty slots, which follow the others), then position, m, and orientation
                /// (unit quaternion, w first) of the second geom's body in the frame of the first one's.
                stick_references set_stick_references: Reference, StickReferences, Finite;
                /// Displacements of dry friction from where it stuck: dofs, then tendons (nv + ntendon with the option
                /// ``stiction``, else none), m or rad.
                stick_friction set_stick_friction: Number, StickFriction, Finite;
            }
            inputs {
                /// Controls of actuators (nu).
                ctrl set_ctrl: Number, Actuators, Finite;
                /// Forces that the user applies along degrees of freedom (nv), N or N m.
                qfrc_applied set_qfrc_applied: Number, Dofs, Finite;
                /// Positions of mocap bodies (nmocap, 3), m.
                mocap_pos set_mocap_pos: Vector, MocapBodies, Finite;
                /// Orientations of mocap bodies (nmocap, 4), unit quaternions, w first.
                mocap_quat set_mocap_quat: Quaternion, MocapBodies, Finite;
                /// True for each active equality constraint (neq).
                eq_active set_eq_active: Truth, Equalities, Finite;
            }
            occasional {
                /// Forces, N, then torques, N m, that the user applies to bodies at their centres of mass, world axes
                /// (nbody, 6).
                xfrc_applied set_xfrc_applied: Wrench, Bodies, Finite;
                /// Kind of the constraint in each slot for constraints that are added at run time
                /// (max_dynamic_constraints): 1 a connect, 2 a weld; other slots are empty.
                dynamic_kind set_dynamic_kind: Integer, DynamicConstraints, Finite;
                /// Serial number that the constraint of each slot received when it was added
                /// (max_dynamic_constraints); handles identify it by this.
                dynamic_serial set_dynamic_serial: Integer, DynamicConstraints, Finite;
                /// First body of each slot (max_dynamic_constraints); an index beyond the model's bodies disables it.
                dynamic_body1 set_dynamic_body1: Integer, DynamicConstraints, Finite;
                /// Second body of each slot, likewise (max_dynamic_constraints).
                dynamic_body2 set_dynamic_body2: Integer, DynamicConstraints, Finite;
                /// Anchors in the frames of the first bodies (max_dynamic_constraints, 3), m.
                dynamic_anchor1 set_dynamic_anchor1: Vector, DynamicConstraints, Finite;
                /// Anchors in the frames of the second bodies (max_dynamic_constraints, 3), m.
                dynamic_anchor2 set_dynamic_anchor2: Vector, DynamicConstraints, Finite;
                /// Orientation of the second body in the frame of the first that each weld holds
                /// (max_dynamic_constraints, 4), a unit quaternion, w first.
                dynamic_quat set_dynamic_quat: Quaternion, DynamicConstraints, Finite;
            }
        }
    };
}
