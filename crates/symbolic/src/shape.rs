//! Pure functions of one variable: what a law is made of.
//!
//! Each divides its variable by a scale of the same unit, so that its value is a pure number whatever the variable is.

use crate::lag::lagged;
use crate::latch::latched;
use crate::variable::{Checked, DRIVE, Enters, Kind};
use std::f64::consts::TAU;

/// A function of a variable u with a scale s and a centre c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// (u/s)^p; of |u| where p is not whole.
    Power(f64),
    /// |u/s|^p with a power that the data move
    FreePower(f64),
    /// sign(u) |u/s|^p
    SignedPower(f64),
    /// tanh(u/s)
    Tanh,
    /// |u| / (|u| + s)
    Saturation,
    /// 1 / (1 + |u|/s): as 1/u, and finite at rest.
    Hyperbola,
    /// 2 |u/s| / (1 + (u/s)²): greatest at s, as what eddy currents and slipping couplings pull with (Kloss, *Archiv für
    /// Elektrotechnik* 5, 1916).
    Peak,
    /// exp(−u/s)
    Decay,
    /// 1 − exp(−u/s): what grows towards a level.
    Rise,
    /// (u − c)/s: what is nought at a value of its own
    From,
    /// c/u − 1 of what is never nought: nought at a value of its own as well
    Under,
    /// max((u − c)/s, 0)^p, with a whole power p
    Above(u8),
    /// max((c − u)/s, 0)^p, with a whole power p
    Below(u8),
    /// ½ (1 + tanh((u − c)/s))
    Step,
    /// ½ (1 − tanh((u − c)/s)): what is there below alone, which the same above with a constant says in two terms
    StepDown,
    /// exp(−((u − c)/s)²)
    Bump,
    /// A switch: on from c upward until u is at c − s or below
    Latch,
    /// The same the other way: off from c upward, and on again from c − s down
    Unlatch,
    /// (u/s)^p as it is followed late, with a whole power p and a time constant [s] that the data move
    Lag(u8, f64),
    /// u/s less what follows it late, with a time constant [s] that the data move: what springs and dampers in a row do
    Ahead(f64),
    /// sin(2π u/s + φ)
    Wave,
    /// On and off again and again: ½ (1 + tanh(k (sin(2π (u − c)/s) − l))), with the level l that the data move; on for
    /// the share arccos(l)/π of the time
    Pulse(f64),
    /// sin(n u + φ) of an angle
    Harmonic(u8),
    /// u of a gate
    On,
    /// 1 − u of a gate
    Off,
}

/// A constant inside a shape that the data may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Free {
    Scale,
    Centre,
    Power,
    Level,
    Lag,
}

/// What turns with the sign of a variable, and saturates beyond this share of its greatest size, is nearly in proportion to it.
pub(crate) const STRAIGHT: f64 = 0.5;

/// How steeply a pulse goes on and off: within a hundredth of its period.
pub const EDGE: f64 = 20.0;

impl Shape {
    /// Which constants are free.
    pub fn free(self) -> &'static [Free] {
        match self {
            Self::Tanh
            | Self::Saturation
            | Self::Hyperbola
            | Self::Peak
            | Self::Decay
            | Self::Rise
            | Self::Wave => &[Free::Scale],
            Self::FreePower(_) => &[Free::Power],
            Self::From | Self::Under | Self::Above(_) | Self::Below(_) => &[Free::Centre],
            Self::Step | Self::StepDown | Self::Bump | Self::Latch | Self::Unlatch => {
                &[Free::Centre, Free::Scale]
            }
            Self::Pulse(_) => &[Free::Centre, Free::Scale, Free::Level],
            Self::Lag(..) | Self::Ahead(_) => &[Free::Lag],
            _ => &[],
        }
    }

    /// Whether it has a phase: then it is two columns, a sine and a cosine.
    pub fn has_phase(self) -> bool {
        matches!(self, Self::Wave | Self::Harmonic(_))
    }

    /// Whether it comes again and again.
    pub fn repeats(self) -> bool {
        matches!(self, Self::Wave | Self::Pulse(_))
    }

    /// Whether a scale stands in it.
    pub fn has_scale(self) -> bool {
        !matches!(self, Self::Harmonic(_) | Self::On | Self::Off | Self::Under)
    }

    /// Whether a centre stands in it.
    pub fn has_centre(self) -> bool {
        self.free().contains(&Free::Centre)
    }
}

/// A shape of one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factor {
    /// Index of the variable.
    pub variable: usize,
    pub shape: Shape,
    /// In the unit of the variable.
    pub scale: f64,
    /// In the unit of the variable.
    pub centre: f64,
}

/// What a shape is along a run: one column, or a sine and a cosine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Columns {
    pub first: Vec<f64>,
    pub cosine: Option<Vec<f64>>,
}

impl Columns {
    pub fn one(first: Vec<f64>) -> Self {
        Self { first, cosine: None }
    }

    pub fn phased(both: impl Iterator<Item = (f64, f64)>) -> Self {
        let (first, cosine) = both.unzip();
        Self { first, cosine: Some(cosine) }
    }

    /// With the amplitudes of sine and cosine, and else with the one that there is.
    pub fn sized(self, share: &[f64]) -> Vec<f64> {
        let Self { mut first, cosine } = self;
        for value in &mut first {
            *value *= share[0];
        }
        for (value, cosine) in first.iter_mut().zip(cosine.iter().flatten()) {
            *value += share[1] * cosine;
        }
        first
    }
}

/// Whether the formula takes the absolute value: where a root of a negative number would stand, or where a law of size
/// meets values of both signs.
fn takes_size(shape: Shape, of: &Checked) -> bool {
    // A drive loses both ways, whether or not it was seen to hold back.
    let lost = of.known.name == DRIVE;
    let both = of.negative && of.known.kind != Kind::Level || lost;
    match shape {
        Shape::Power(p) => p.fract() != 0.0 || (both && p.rem_euclid(2.0) == 1.0),
        Shape::FreePower(_) => true,
        Shape::Saturation | Shape::Hyperbola | Shape::Peak => of.negative || lost,
        Shape::Decay | Shape::Rise | Shape::Latch | Shape::Unlatch => both,
        Shape::Lag(p, _) => both && p % 2 == 1,
        Shape::Tanh => lost && !of.negative || of.enters == Enters::BySize,
        Shape::Above(_) => of.enters == Enters::BySize,
        _ => false,
    }
}

impl Factor {
    /// Whether another wave is this one or a harmonic of it.
    pub fn has_harmonic(&self, other: &Self) -> bool {
        /// Waves of edges that can be told beside the first.
        const HIGHEST: f64 = 7.0;
        /// Share of an order by which two periods may miss each other.
        const ABOUT: f64 = 0.03;
        let order = self.scale / other.scale;
        let nearest = order.round();
        self.variable == other.variable
            && (1.0..=HIGHEST).contains(&nearest)
            && (order - nearest).abs() < ABOUT * nearest
    }

    /// Its value where the variable, or its size where it takes that, is u: the sine, and the cosine where it has a phase. What it
    /// remembers it has from [`Factor::along`] alone.
    fn value(&self, u: f64) -> (f64, f64) {
        let Self { scale: s, centre: c, .. } = *self;
        let value = match self.shape {
            Shape::Power(p) if p.fract() == 0.0 =>
            {
                #[expect(clippy::cast_possible_truncation, reason = "the menu holds small whole powers")]
                (u / s).powi(p as i32)
            }
            Shape::Power(p) | Shape::FreePower(p) => (u / s).powf(p),
            Shape::SignedPower(p) => (u / s).abs().powf(p) * if u == 0.0 { 0.0 } else { u.signum() },
            Shape::Tanh => (u / s).tanh(),
            Shape::Saturation => u / (u + s),
            Shape::Hyperbola => 1.0 / (1.0 + u / s),
            Shape::Peak => 2.0 * (u / s) / (1.0 + (u / s).powi(2)),
            Shape::Decay => (-u / s).exp(),
            Shape::Rise => 1.0 - (-u / s).exp(),
            Shape::From => (u - c) / s,
            Shape::Under => c / u - 1.0,
            Shape::Above(p) => ((u - c) / s).max(0.0).powi(i32::from(p)),
            Shape::Below(p) => ((c - u) / s).max(0.0).powi(i32::from(p)),
            Shape::Step => 0.5 * (1.0 + ((u - c) / s).tanh()),
            Shape::StepDown => 0.5 * (1.0 - ((u - c) / s).tanh()),
            Shape::Bump => (-((u - c) / s).powi(2)).exp(),
            Shape::Latch => f64::from(u8::from(u >= c)),
            Shape::Unlatch => f64::from(u8::from(u < c)),
            Shape::Lag(p, _) => (u / s).powi(i32::from(p)),
            Shape::Ahead(_) => u / s,
            Shape::Wave => return (TAU * u / s).sin_cos(),
            Shape::Pulse(level) => 0.5 * (1.0 + (EDGE * ((TAU * (u - c) / s).sin() - level)).tanh()),
            Shape::Harmonic(n) => return (f64::from(n) * u).sin_cos(),
            Shape::On => u,
            Shape::Off => 1.0 - u,
        };
        (value, 0.0)
    }

    /// Its variable along a run, or the size of that where it takes it.
    pub fn argument<'a>(&self, run: &'a [f64], of: &Checked) -> impl Iterator<Item = f64> + use<'a> {
        let size = takes_size(self.shape, of);
        run.iter().map(move |u| if size { u.abs() } else { *u })
    }

    /// Its values along a run, at times [s] that what it remembers goes by: the sine, and the cosine where it has a phase.
    pub fn along(&self, run: &[f64], time_s: &[f64], of: &Checked) -> Columns {
        let argument = || self.argument(run, of);
        let values = || argument().map(|u| self.value(u).0);
        match self.shape {
            Shape::Latch | Shape::Unlatch => {
                let on = latched(argument(), self.centre, self.centre - self.scale);
                Columns::one(if self.shape == Shape::Latch {
                    on
                } else {
                    on.iter().map(|on| 1.0 - on).collect()
                })
            }
            Shape::Lag(_, lag_s) => Columns::one(lagged(values(), time_s, lag_s)),
            Shape::Ahead(lag_s) => {
                let late = lagged(values(), time_s, lag_s);
                Columns::one(values().zip(late).map(|(value, late)| value - late).collect())
            }
            shape if shape.has_phase() => Columns::phased(argument().map(|u| self.value(u))),
            _ => Columns::one(values().collect()),
        }
    }

    /// As text, with the names of its scale, centre, phase, and power, level or lag.
    pub fn text(&self, of: &Checked, [scale, centre, phase, power]: [&str; 4]) -> String {
        let name = of.known.name;
        let u = if takes_size(self.shape, of) { format!("abs({name})") } else { name.to_owned() };
        match self.shape {
            Shape::Power(1.0) | Shape::SignedPower(1.0) => format!("({u} / {scale})"),
            Shape::Power(p) => format!("({u} / {scale})^{p}"),
            Shape::FreePower(_) => format!("({u} / {scale})^{power}"),
            Shape::SignedPower(p) => format!("sign({u}) * abs({u} / {scale})^{p}"),
            Shape::Tanh => format!("tanh({u} / {scale})"),
            Shape::Saturation => format!("({u} / ({u} + {scale}))"),
            Shape::Hyperbola => format!("(1 / (1 + {u} / {scale}))"),
            Shape::Peak => format!("(2 * ({u} / {scale}) / (1 + ({u} / {scale})^2))"),
            Shape::Decay => format!("exp(-{u} / {scale})"),
            Shape::Rise => format!("(1 - exp(-{u} / {scale}))"),
            Shape::From => format!("(({u} - {centre}) / {scale})"),
            Shape::Under => format!("({centre} / {u} - 1)"),
            Shape::Above(1) => format!("max(({u} - {centre}) / {scale}, 0)"),
            Shape::Below(1) => format!("max(({centre} - {u}) / {scale}, 0)"),
            Shape::Above(p) => format!("max(({u} - {centre}) / {scale}, 0)^{p}"),
            Shape::Below(p) => format!("max(({centre} - {u}) / {scale}, 0)^{p}"),
            Shape::Step => format!("0.5 * (1 + tanh(({u} - {centre}) / {scale}))"),
            Shape::StepDown => format!("0.5 * (1 - tanh(({u} - {centre}) / {scale}))"),
            Shape::Bump => format!("exp(-(({u} - {centre}) / {scale})^2)"),
            Shape::Latch => format!("latched({u}, {centre}, {centre} - {scale})"),
            Shape::Unlatch => format!("(1 - latched({u}, {centre}, {centre} - {scale}))"),
            Shape::Lag(1, _) => format!("lagged({u} / {scale}, {power})"),
            Shape::Lag(p, _) => format!("lagged(({u} / {scale})^{p}, {power})"),
            Shape::Ahead(_) => format!("(({u} - lagged({u}, {power})) / {scale})"),
            Shape::Wave => format!("sin({TAU} * {u} / {scale} + {phase})"),
            Shape::Pulse(_) => {
                format!("0.5 * (1 + tanh({EDGE} * (sin({TAU} * ({u} - {centre}) / {scale}) - {power})))")
            }
            Shape::Harmonic(1) => format!("sin({u} + {phase})"),
            Shape::Harmonic(n) => format!("sin({n} * {u} + {phase})"),
            Shape::On => u,
            Shape::Off => format!("(1 - {u})"),
        }
    }

    /// A free constant on the scale on which it is moved: the logarithm of a scale, a centre as a share of the spread,
    /// a wave as cycles over the spread, and the begin of a pulse in cycles.
    pub fn inner(&self, free: Free, of: &Checked) -> f64 {
        match free {
            Free::Scale if self.shape.repeats() => of.spread() / self.scale,
            Free::Centre if self.shape.repeats() => self.centre / self.scale,
            Free::Scale => self.scale.ln(),
            Free::Centre => (self.centre - of.low) / of.spread(),
            Free::Power => self.power(),
            Free::Level => self.level(),
            Free::Lag => self.lag_s().ln(),
        }
    }

    /// Sets a free constant; what leaves the sensible range is held at its end.
    pub fn set_inner(&mut self, free: Free, inner: f64, of: &Checked) {
        /// A wave has at least this many cycles: slower ones are slopes.
        const FEWEST_CYCLES: f64 = 0.4;
        /// Scales, as shares of the spread: below the first nothing is resolved, above the second it is a straight line.
        const SCALES: (f64, f64) = (0.01, 3.0);
        /// A step or a bump is as wide as this share of the finest wave at least.
        const FINER: f64 = 0.25;
        /// Centres, as shares of the spread.
        const CENTRES: (f64, f64) = (-0.1, 1.1);
        /// What is nought at a value may never have come there.
        const NOUGHTS: (f64, f64) = (-3.0, 4.0);
        /// Powers: below the first a constant, above the second a wall.
        const POWERS: (f64, f64) = (0.2, 6.0);
        /// Levels: beyond it a pulse is on, or off, for less than a tenth of its period.
        const MOST_LEVEL: f64 = 0.95;
        /// A lag that is shorter is a sensor's, and what is ahead of it an acceleration [s].
        const SHORTEST_S: f64 = 2.0;
        /// And one that is longer than this share of the longest run is a drift.
        const LONGEST: f64 = 1.0;
        match free {
            Free::Scale if self.shape.repeats() => {
                self.scale = (of.spread() / inner.max(FEWEST_CYCLES)).max(of.finest);
            }
            Free::Scale => {
                let largest = match (of.known.kind, of.enters) {
                    (_, Enters::Bent) => STRAIGHT * of.size(),
                    (Kind::Level, _) => SCALES.1 * of.spread(),
                    _ => SCALES.1 * of.size(),
                };
                let smallest = (SCALES.0 * of.spread()).max(FINER * of.finest);
                self.scale = inner.exp().clamp(smallest, largest.max(smallest));
            }
            Free::Centre if self.shape.repeats() => self.centre = inner * self.scale,
            Free::Centre => {
                let nought = matches!(self.shape, Shape::From | Shape::Under);
                let (low, high) = if nought { NOUGHTS } else { CENTRES };
                let centre = of.low + of.spread() * inner.clamp(low, high);
                self.centre = match self.shape {
                    Shape::Above(_) | Shape::Step if of.enters == Enters::Bent => centre.max(0.0),
                    Shape::Below(_) | Shape::StepDown if of.enters == Enters::Bent => centre.min(0.0),
                    _ => centre,
                };
            }
            Free::Power => self.shape = Shape::FreePower(inner.clamp(POWERS.0, POWERS.1)),
            Free::Level => self.shape = Shape::Pulse(inner.clamp(-MOST_LEVEL, MOST_LEVEL)),
            Free::Lag => {
                let longest_s = (LONGEST * of.lasts_s()).max(SHORTEST_S);
                let lag_s = inner.exp().clamp(SHORTEST_S, longest_s);
                self.shape = match self.shape {
                    Shape::Lag(p, _) => Shape::Lag(p, lag_s),
                    _ => Shape::Ahead(lag_s),
                };
            }
        }
    }

    /// How far a free constant may move in one step, on its inner scale.
    pub fn longest_step(&self, free: Free) -> f64 {
        match free {
            Free::Scale if self.shape.repeats() => 0.25,
            Free::Scale | Free::Lag => 0.7,
            Free::Centre => 0.15,
            Free::Power => 0.5,
            Free::Level => 0.3,
        }
    }

    /// What it costs to write it down: itself, and every constant that was free.
    pub fn complexity(&self) -> usize {
        1 + self.shape.free().len() + usize::from(self.shape.has_phase())
    }

    /// What it is, without its constants: variable, shape, exponent. What steps down is what steps up, less a constant, and so is a switch the other way.
    pub fn family(&self) -> (usize, String) {
        let shape = match self.shape {
            Shape::FreePower(_) => Shape::FreePower(1.0),
            Shape::Pulse(_) => Shape::Pulse(0.0),
            Shape::Lag(p, _) => Shape::Lag(p, 0.0),
            Shape::Ahead(_) => Shape::Ahead(0.0),
            Shape::StepDown => Shape::Step,
            Shape::Unlatch => Shape::Latch,
            other => other,
        };
        (self.variable, format!("{shape:?}"))
    }

    /// The level that the data moved; 0 where there is none.
    pub fn level(&self) -> f64 {
        if let Shape::Pulse(level) = self.shape { level } else { 0.0 }
    }

    /// The time constant that the data moved [s]; 0 where there is none.
    pub fn lag_s(&self) -> f64 {
        if let Shape::Lag(_, lag_s) | Shape::Ahead(lag_s) = self.shape { lag_s } else { 0.0 }
    }

    /// The power that the data moved; 1 where there is none.
    pub fn power(&self) -> f64 {
        if let Shape::FreePower(power) = self.shape { power } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What goes on and off every 3.7 s for half of it has a wave of 3.7 s in it, one of a third of that, of a fifth.
    #[test]
    fn a_wave_has_harmonics() {
        let wave = |variable, scale| Factor { variable, shape: Shape::Wave, scale, centre: 0.0 };
        let first = wave(0, 3.7);
        assert!([3.7, 1.235, 0.745].into_iter().all(|scale| first.has_harmonic(&wave(0, scale))));
        assert!([7.4, 2.9, 0.2].into_iter().all(|scale| !first.has_harmonic(&wave(0, scale))));
        assert!(!first.has_harmonic(&wave(1, 3.7)), "of another variable");
    }
}
