//! Faults of sensors that a model can tell.

use super::cause::{Cause, cause};
use super::term::{Term, linear, positive};
use super::{Around, SLIPS};
use crate::balances::balance::Kind;

/// Every fault of a sensor that a diagnosis knows, by a model or by the channel itself.
pub const ARTEFACTS: [&str; 9] = [
    "latency",
    "speed_scale",
    "force_scale",
    "accelerometer_bias",
    "accelerometer_tilt",
    "clock_drift",
    "quantisation",
    "dropout",
    "stuck_channel",
];

/// Clocks that run apart by more than this share of the time are broken.
const MOST_DRIFT: f64 = 0.03;

/// A sensor that is wrong by more than this share has another unit, or is broken.
pub const MOST_SCALE: f64 = 0.4;
/// No speed is wrong by a larger share: satellites are right to a hundredth, a wheel's radius is known to 2 to 4 %, and another
/// size of tyre makes a tenth. What asks for more is another cause, whose law of speed a longer way of measuring would draw too.
pub const MOST_SPEED_SCALE: f64 = 0.15;

/// Adds the faults that these channels can have.
pub fn sensors(all: &mut Vec<Cause>, around: &Around) {
    let artefact = |id, balances, term: Term, equation, words, experiment| {
        cause(id, balances, vec![term], equation, &[], words, experiment).artefact()
    };
    if around.drives {
        all.push(
            artefact(
                "latency",
                &[Kind::Motion],
                linear("latency_s", "s", 0.1).within(-1.5, 3.0),
                "y(t) = x(t − δ)",
                "speed that arrives late",
                "brake once hard with an accelerometer beside it",
            )
            // A late signal is not linear in its latency, so it is tried at several.
            .shaped(vec![vec![0.05], vec![0.2], vec![0.6], vec![-0.2]]),
        );
        all.push(
            artefact(
                "clock_drift",
                &[Kind::Motion],
                linear("rate", "1", 0.003).within(-MOST_DRIFT, MOST_DRIFT),
                "y(t) = x(t − r t)",
                "a clock of the speed's logger that runs apart from the others",
                "give both loggers one sharp event at the begin and one at the end of a run",
            )
            // As a latency, at several sizes.
            .shaped(vec![vec![0.001], vec![0.004], vec![0.012], vec![-0.001], vec![-0.004]]),
        );
        all.push(artefact(
            "force_scale",
            &[Kind::Motion, Kind::Battery, Kind::Fuel],
            linear("scale", "1", 0.05).within(-MOST_SCALE, MOST_SCALE),
            "F_measured = (1 + k) F",
            "a force sensor with a wrong scale",
            "hang a known weight on it, or tow with a load cell",
        ));
    }
    all.push(artefact(
        "speed_scale",
        &[Kind::Motion, Kind::Slip, Kind::Battery, Kind::Fuel],
        linear("scale", "1", 0.03).within(-MOST_SPEED_SCALE, MOST_SPEED_SCALE),
        "v_measured = (1 + k) v",
        "a speed sensor with a wrong scale",
        "drive a measured mile",
    ));
    all.push(artefact(
        "accelerometer_bias",
        &[Kind::Parity],
        linear("bias_m_s2", "m/s²", 0.15),
        "f_measured = f + b",
        "an accelerometer with an offset",
        "stand level, and turn around on the spot",
    ));
    all.push(artefact(
        "accelerometer_tilt",
        &[Kind::Parity],
        linear("tilt_rad", "rad", 0.015),
        "f_measured = f + g sin ε",
        "an accelerometer that is mounted at a tilt",
        "stand level, and turn around on the spot",
    ));
    let turned = around.channels.iter().any(|name| name == "wheel_speed_m_s");
    let balances: &'static [Kind] = if turned { SLIPS } else { &[Kind::Slip] };
    // Where an implement may pull and nobody knows how much, the motion tells of a part of the force only.
    let slope = positive("coefficient", "1", if around.pulls { 0.15 } else { 0.4 });
    let slips = |terms: Vec<Term>, equation: &'static str, words: &'static str| {
        cause(
            "wheel_slip",
            balances,
            terms,
            equation,
            &["tractive_force_n"],
            words,
            "pull two loads at one speed",
        )
    };
    all.push(slips(vec![slope], "s = k F / N", "slip of the driven wheels"));
    let bends = vec![slope, positive("quadratic", "1", 2.0 * slope.scale)];
    all.push(slips(
        bends,
        "s = (k + k₂ |F| / N) F / N",
        "slip of the driven wheels that grows faster than the pull",
    ));
}
