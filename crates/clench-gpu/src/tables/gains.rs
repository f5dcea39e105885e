//! Gains and biases of actuators: their laws, and the coefficients of these.

use super::{TINY, Tables};
use crate::codes::{Code, codes, row};
use clench_rigid::model::{Actuator, BiasKind, GainKind, Model};

codes! {
    /// The laws of gains and biases.
    enum Law {
        Affine = "LAW_AFFINE",
        Muscle = "LAW_MUSCLE",
        Pid = "LAW_PID",
        DcMotor = "LAW_DC_MOTOR",
        Orientation = "LAW_ORIENTATION",
    }
}
row! {
    /// The coefficients of a + b length + c velocity.
    numbers AffineNumbers, "AFFINE" {
        constant: 1,
        length: 1,
        velocity: 1,
    }
}
row! {
    /// The constants of a muscle. See `dynamics/muscle.rs`.
    numbers MuscleNumbers, "MUSCLE" {
        strength: 1,
        resting_length: 1,
        /// The start of the scaled length.
        start: 1,
        lmin: 1,
        lmax: 1,
        vmax: 1,
        fpmax: 1,
        fvmax: 1,
    }
}
/// The numbers of a law: those of a muscle, which has the most.
const LAW_SIZE: usize = MuscleNumbers::SIZE;
impl Tables {
    pub(super) fn gains(&mut self, m: &Model) {
        let (p, each) = (&m.params, || m.actuators.iter().enumerate());
        self.codes::<Law>();
        self.row::<AffineNumbers>();
        self.row::<MuscleNumbers>();
        self.constant("LAW_SIZE", LAW_SIZE);
        let gain_law = |a: &Actuator| match a.gain {
            GainKind::Muscle => Law::Muscle,
            GainKind::Pid => Law::Pid,
            GainKind::DcMotor => Law::DcMotor,
            GainKind::So3 => Law::Orientation,
            GainKind::Fixed | GainKind::Affine | GainKind::User => Law::Affine,
        };
        self.words("GAIN_LAW", each().map(|(_, a)| gain_law(a).code()));
        let bias_law = |a: &Actuator| match a.bias {
            BiasKind::Muscle => Law::Muscle,
            BiasKind::DcMotor => Law::DcMotor,
            // The damping of an orientation servo is that of a velocity.
            BiasKind::None | BiasKind::Affine | BiasKind::So3 | BiasKind::User => Law::Affine,
        };
        self.words("BIAS_LAW", each().map(|(_, a)| bias_law(a).code()));
        let gain = |(u, a): (usize, &Actuator)| {
            let prm = &p.actuator_gainprm[u];
            match a.gain {
                GainKind::Muscle => muscle(m, u, prm),
                GainKind::Affine => affine([prm[0], prm[1], prm[2]]),
                // MuJoCo's default without a callback.
                GainKind::User => affine([1.0, 0.0, 0.0]),
                GainKind::Fixed | GainKind::DcMotor | GainKind::Pid | GainKind::So3 => {
                    affine([prm[0], 0.0, 0.0])
                }
            }
        };
        let bias = |(u, a): (usize, &Actuator)| {
            let prm = &p.actuator_biasprm[u];
            match a.bias {
                BiasKind::Muscle => muscle(m, u, prm),
                BiasKind::Affine => affine([prm[0], prm[1], prm[2]]),
                BiasKind::So3 => affine([prm[0], 0.0, prm[2]]),
                BiasKind::None | BiasKind::DcMotor | BiasKind::User => affine([0.0; 3]),
            }
        };
        self.numbers("ACTUATOR_GAIN", each().flat_map(gain));
        self.numbers("ACTUATOR_BIAS", each().flat_map(bias));
    }
}

/// Returns the numbers of a law, padded with zeros.
fn law(numbers: &[f64]) -> [f64; LAW_SIZE] {
    let mut all = [0.0; LAW_SIZE];
    all[..numbers.len()].copy_from_slice(numbers);
    all
}

fn affine([constant, length, velocity]: [f64; 3]) -> [f64; LAW_SIZE] {
    let row = AffineNumbers {
        constant: [constant],
        length: [length],
        velocity: [velocity],
    };
    law(&row.numbers())
}

fn muscle(m: &Model, u: usize, prm: &[f64; 10]) -> [f64; LAW_SIZE] {
    let [low, high, force, scale, lmin, lmax, vmax, fpmax, fvmax, _] = *prm;
    let [shortest, longest] = m.params.actuator_lengthrange[u];
    let resting = (longest - shortest) / (high - low).max(TINY);
    let derived = scale / m.params.actuator_acc0[u].max(TINY);
    let peak = if force < 0.0 { derived } else { force };
    let resting = resting.max(TINY);
    let row = MuscleNumbers {
        strength: [peak],
        resting_length: [resting],
        start: [low - shortest / resting],
        lmin: [lmin],
        lmax: [lmax],
        vmax: [vmax],
        fpmax: [fpmax],
        fvmax: [fvmax],
    };
    law(&row.numbers())
}
