//! The terms that are tried: every shape of every variable on a coarse grid of constants, and products of two.
//!
//! The grid only has to lead into the basin of the best constants, which are polished afterwards.

use crate::shape::{Factor, STRAIGHT, Shape};
use crate::term::Term;
use crate::variable::{ACCELERATION, Checked, DRIVE, Enters, Kind, PRESSURE};

/// Powers of a size. Sources of the halves: rolling in soil and flow through gaps have such exponents.
pub(crate) const POWERS: [f64; 5] = [0.5, 1.0, 1.5, 2.0, 3.0];
/// Where powers start that the data move.
const FREE_POWERS: [f64; 2] = [1.25, 2.5];
/// Powers of what sets in beyond a threshold.
const HINGES: [u8; 2] = [1, 2];
/// Scales of curved shapes, as shares of the greatest value.
const SCALES: [f64; 5] = [0.06, 0.14, 0.3, 0.7, 1.5];
/// Centres, as shares of the spread.
const CENTRES: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Widths of bumps, as shares of the spread.
const WIDTHS: [f64; 3] = [0.05, 0.12, 0.3];
/// Widths of steps, as shares of the spread.
const EDGES: [f64; 2] = [0.02, 0.12];
/// Time constants of what follows late [s].
const LAGS_S: [f64; 5] = [3.0, 6.0, 15.0, 40.0, 100.0];
/// Powers of what is followed.
const FOLLOWED: [u8; 2] = [1, 2];
/// Turns of an angle in one turn of the vehicle: wind and slope have one, a crown or furrows two.
const HARMONICS: [u8; 2] = [1, 2];

/// Single terms, and products of two variables. Waves are not here: they are scanned.
pub(crate) fn dictionary(variables: &[Checked]) -> Vec<Term> {
    let mut terms: Vec<Term> = Vec::new();
    for index in 0..variables.len() {
        terms.extend(full(variables, index).into_iter().map(Term::of));
    }
    for one in 0..variables.len() {
        for other in one + 1..variables.len() {
            for first in short(variables, one) {
                for second in short(variables, other) {
                    terms.extend(Term::product(first, second));
                }
            }
        }
    }
    terms
}

/// What may shape the amplitude of a wave of a variable.
pub(crate) fn envelopes(variables: &[Checked], wave: usize) -> Vec<Factor> {
    let mut all = Vec::new();
    for (index, of) in variables.iter().enumerate() {
        let make = |shape, scale, centre| Factor { variable: index, shape, scale, centre };
        match of.known.kind {
            Kind::Size => {
                all.extend([1.0, 2.0].map(|p| make(Shape::Power(p), of.round_size(), 0.0)));
                all.push(make(Shape::Decay, 0.3 * of.size(), 0.0));
                all.push(make(Shape::Hyperbola, 0.3 * of.size(), 0.0));
            }
            Kind::Coordinate if index == wave => {
                all.extend([0.12, 0.4].map(|share| make(Shape::Decay, share * of.size(), 0.0)));
                all.extend(
                    [0.25, 0.5, 0.75]
                        .map(|share| make(Shape::Bump, 0.2 * of.spread(), of.low + share * of.spread())),
                );
            }
            Kind::Coordinate | Kind::Way => all.push(make(Shape::Decay, 0.3 * of.size(), 0.0)),
            Kind::Gate => all.extend([Shape::On, Shape::Off].map(|shape| make(shape, 1.0, 0.0))),
            _ => {}
        }
    }
    all
}

/// What may shape what a switch turns on: a fan that catches takes power by its speed.
pub(crate) fn switched(variables: &[Checked]) -> Vec<Factor> {
    const SWITCHED: [f64; 3] = [1.0, 2.0, 3.0];
    let sizes = variables.iter().enumerate().filter(|(_, of)| of.known.kind == Kind::Size);
    let powers = |(variable, of): (usize, &Checked)| {
        let scale = of.round_size();
        SWITCHED.map(|p| Factor { variable, shape: Shape::Power(p), scale, centre: 0.0 })
    };
    sizes.flat_map(powers).collect()
}

/// Everything that one variable can be.
fn full(variables: &[Checked], index: usize) -> Vec<Factor> {
    let of = &variables[index];
    let make = |shape, scale, centre| Factor { variable: index, shape, scale, centre };
    let mut all = Vec::new();
    let curved = |all: &mut Vec<Factor>, shapes: &[Shape], size: f64| {
        for shape in shapes {
            all.extend(SCALES.map(|share| make(*shape, share * size, 0.0)));
        }
    };
    let edges = |all: &mut Vec<Factor>| {
        for share in CENTRES {
            let centre = of.low + share * of.spread();
            for power in HINGES {
                all.push(make(Shape::Above(power), of.round_size(), centre));
                all.push(make(Shape::Below(power), of.round_size(), centre));
            }
            all.extend(WIDTHS.map(|width| make(Shape::Bump, width * of.spread(), centre)));
            for step in [Shape::Step, Shape::StepDown] {
                all.extend(EDGES.map(|width| make(step, width * of.spread(), centre)));
            }
        }
    };
    // Where a switch goes on and off: every two of the centres that are far enough apart.
    let latches = |all: &mut Vec<Factor>| {
        let at = |share: f64| of.low + share * of.spread();
        for (place, on) in CENTRES.into_iter().enumerate() {
            all.extend(
                CENTRES[..place].iter().map(|off| make(Shape::Latch, (on - off) * of.spread(), at(on))),
            );
        }
    };
    // No longer than half the longest run: what is slower is a drift.
    let late = |all: &mut Vec<Factor>, scale: f64, powers: &[u8]| {
        for lag_s in LAGS_S.into_iter().filter(|lag_s| 2.0 * lag_s < of.lasts_s()) {
            all.extend(powers.iter().map(|power| make(Shape::Lag(*power, lag_s), scale, 0.0)));
            all.push(make(Shape::Ahead(lag_s), scale, 0.0));
        }
    };
    match of.known.kind {
        Kind::Coordinate if of.enters == Enters::Within => edges(&mut all),
        Kind::Size | Kind::Coordinate => {
            all.extend(POWERS.map(|p| make(Shape::Power(p), of.round_size(), 0.0)));
            all.extend(FREE_POWERS.map(|p| make(Shape::FreePower(p), of.round_size(), 0.0)));
            let bends = [Shape::Tanh, Shape::Saturation, Shape::Hyperbola, Shape::Decay, Shape::Rise];
            curved(&mut all, &bends, of.size());
            edges(&mut all);
            if of.known.kind == Kind::Size {
                curved(&mut all, &[Shape::Peak], of.size());
                latches(&mut all);
                late(&mut all, of.round_size(), &FOLLOWED);
            }
        }
        Kind::Way => {
            curved(&mut all, &[Shape::Hyperbola, Shape::Decay, Shape::Rise], of.size());
            for share in CENTRES {
                let centre = of.low + share * of.spread();
                all.extend(EDGES.map(|width| make(Shape::Step, width * of.spread(), centre)));
            }
        }
        Kind::Level => {
            all.push(make(Shape::Power(1.0), of.round_size(), 0.0));
            curved(&mut all, &[Shape::Decay], of.spread());
            edges(&mut all);
            latches(&mut all);
        }
        Kind::Signed if of.enters == Enters::Bent => all.extend(bent(of, index)),
        Kind::Signed => {
            all.extend([0.5, 1.0, 2.0].map(|p| make(Shape::Power(p), of.round_size(), 0.0)));
            if of.enters == Enters::BySize {
                all.extend(beyond(of, index));
                return all;
            }
            if of.negative {
                all.extend([1.0, 2.0].map(|p| make(Shape::SignedPower(p), of.round_size(), 0.0)));
            }
            // Where a speed is held, the noise of the force decides on the sign of an acceleration.
            if of.known.name != ACCELERATION {
                curved(&mut all, &[Shape::Tanh], of.size());
            }
            if of.negative {
                curved(&mut all, &[Shape::Saturation], of.size());
            }
            // What the drive has warmed, and a coupling that locks above a force.
            if of.known.name == DRIVE {
                late(&mut all, of.round_size(), &FOLLOWED);
                for share in CENTRES {
                    let centre = of.low + share * of.spread();
                    all.extend(EDGES.map(|width| make(Shape::Step, width * of.spread(), centre)));
                }
            }
            all.extend(
                CENTRES.map(|share| make(Shape::Above(1), of.round_size(), of.low + share * of.spread())),
            );
        }
        Kind::Angle => all.extend(HARMONICS.map(|n| make(Shape::Harmonic(n), 1.0, 0.0))),
        Kind::Weight => all.extend(weighed(of, index)),
        Kind::Gate => {
            all.push(make(Shape::On, 1.0, 0.0));
            late(&mut all, 1.0, &FOLLOWED[..1]);
        }
    }
    all
}

/// What goes in proportion to all of a weight, or to what is loaded.
fn weighed(of: &Checked, index: usize) -> [Factor; 2] {
    [(Shape::Power(1.0), 0.0), (Shape::From, of.low)].map(|(shape, centre)| Factor {
        variable: index,
        shape,
        scale: of.round_size(),
        centre,
    })
}

/// What sets in beyond a force of the drive, whichever way it acts: iron that saturates. Nothing of another variable.
fn beyond(of: &Checked, index: usize) -> Vec<Factor> {
    let from = |(power, share): (u8, f64)| {
        let (scale, centre) = (of.round_size(), share * of.size());
        Factor { variable: index, shape: Shape::Above(power), scale, centre }
    };
    let each = HINGES.into_iter().flat_map(|power| CENTRES.map(|share| (power, share)));
    if of.known.name == DRIVE { each.map(from).collect() } else { Vec::new() }
}

/// What bends: on one side of a value alone that lies on that side of nought, without end or up to a level, and what turns with the
/// sign and saturates.
fn bent(of: &Checked, index: usize) -> Vec<Factor> {
    let make = |shape, scale, centre| Factor { variable: index, shape, scale, centre };
    let centres = CENTRES.map(|share| of.low + share * of.spread());
    let one_sided = centres.into_iter().map(|centre| {
        make(if centre > 0.0 { Shape::Above(1) } else { Shape::Below(1) }, of.round_size(), centre)
    });
    let width = EDGES[0] * of.spread();
    let apart = centres.into_iter().filter(|centre| centre.abs() > 2.0 * width);
    let steps =
        apart.map(|centre| make(if centre > 0.0 { Shape::Step } else { Shape::StepDown }, width, centre));
    let turns = SCALES
        .into_iter()
        .filter(|share| of.negative && *share < STRAIGHT)
        .map(|share| make(Shape::Tanh, share * of.size(), 0.0));
    one_sided.chain(steps).chain(turns).collect()
}

/// What one variable can be beside another.
fn short(variables: &[Checked], index: usize) -> Vec<Factor> {
    let of = &variables[index];
    let make = |shape, scale, centre| Factor { variable: index, shape, scale, centre };
    let at = |share: f64| of.low + share * of.spread();
    let mut all = Vec::new();
    match of.known.kind {
        Kind::Size => {
            all.extend([1.0, 2.0].map(|p| make(Shape::Power(p), of.round_size(), 0.0)));
            all.extend([0.1, 0.35].map(|share| make(Shape::Decay, share * of.size(), 0.0)));
            all.extend([0.1, 0.4].map(|share| make(Shape::Tanh, share * of.size(), 0.0)));
            all.push(make(Shape::Above(1), of.round_size(), at(0.5)));
            all.extend([0.25, 0.5, 0.75].map(|share| make(Shape::Bump, 0.12 * of.spread(), at(share))));
        }
        Kind::Coordinate => {
            if of.enters != Enters::Within {
                all.push(make(Shape::Power(1.0), of.round_size(), 0.0));
                all.extend([0.07, 0.25, 0.8].map(|share| make(Shape::Decay, share * of.size(), 0.0)));
            }
            all.extend([0.25, 0.5, 0.75].map(|share| make(Shape::Step, 0.03 * of.spread(), at(share))));
            all.extend(
                [0.15, 0.38, 0.62, 0.85].map(|share| make(Shape::Bump, 0.12 * of.spread(), at(share))),
            );
        }
        Kind::Way => all.extend([0.07, 0.25, 0.8].map(|share| make(Shape::Decay, share * of.size(), 0.0))),
        Kind::Level => {
            all.push(make(Shape::Power(1.0), of.round_size(), 0.0));
            all.push(make(Shape::From, of.round_size(), at(0.5)));
            // A tyre's patch of contact grows as its pressure falls.
            if of.known.name == PRESSURE {
                all.push(make(Shape::Under, 1.0, at(0.5)));
            }
            all.push(make(Shape::Decay, 0.4 * of.spread(), 0.0));
            // Grease that stiffens below a temperature, and not above it.
            all.extend([Shape::Above(1), Shape::Below(1)].map(|shape| make(shape, of.round_size(), at(0.5))));
            all.extend([Shape::Step, Shape::StepDown].map(|step| make(step, 0.05 * of.spread(), at(0.5))));
        }
        Kind::Signed if of.enters == Enters::Bent => {}
        Kind::Signed => {
            all.push(make(Shape::Power(1.0), of.round_size(), 0.0));
            if of.negative && of.enters != Enters::BySize {
                all.push(make(Shape::SignedPower(1.0), of.round_size(), 0.0));
                // One side alone: a wheel that rubs in bends one way.
                all.extend([Shape::Above(1), Shape::Below(1)].map(|shape| make(shape, of.round_size(), 0.0)));
            }
            all.push(make(Shape::Power(2.0), of.round_size(), 0.0));
            // Between what bearings take and what currents warm.
            if of.known.name == DRIVE {
                all.push(make(Shape::FreePower(1.5), of.round_size(), 0.0));
            }
        }
        Kind::Angle => all.push(make(Shape::Harmonic(1), 1.0, 0.0)),
        Kind::Weight => all.extend(weighed(of, index)),
        Kind::Gate => all.extend([Shape::On, Shape::Off].map(|shape| make(shape, 1.0, 0.0))),
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Law, write};
    use crate::polish::Polished;
    use crate::problem::{AsTheyAre, Bench, Problem, Target};
    use crate::variable::Variable;
    use headland_effect::Expression;
    use headland_plugin::{Air, Place, Registry, Situation};
    use nalgebra::DMatrix;

    /// Every variable changes, at a pace of its own.
    fn situations() -> Vec<Situation> {
        let one = |index: i32| {
            let k = f64::from(index);
            Situation {
                time_s: 0.5 * k,
                position_m: 3.0 * k - 20.0,
                speed_m_s: 5.0 + 4.0 * (0.3 * k).sin(),
                acceleration_m_s2: (0.13 * k).cos(),
                tractive_force_n: 4000.0 * (0.11 * k).sin(),
                mass_kg: 12_000.0 + 10.0 * k,
                gravity_m_s2: 9.8 + 1e-4 * k,
                place: Place {
                    elevation_m: 100.0 + (0.2 * k).sin(),
                    sin_slope: 0.05 * (0.21 * k).cos(),
                    sin_roll: 0.06 * (0.23 * k).cos(),
                    heading_rad: 0.1 * k,
                    curvature_per_m: 0.02 * (0.17 * k).sin(),
                    ..Place::default()
                },
                air: Air {
                    density_kg_m3: 1.2 - 1e-3 * k,
                    wind_speed_m_s: 3.0,
                    wind_from_rad: 0.4 + 0.05 * k,
                    temperature_c: -4.0 + 0.3 * k,
                },
                drag_area_m2: 6.0 + 0.01 * k,
                coasting: index % 3 == 0,
                braking: index % 5 == 0,
                engine_speed_rad_s: Some(120.0 + 0.7 * k),
                oil_temperature_c: Some(35.0 + 0.2 * k),
                state_of_charge: Some(0.9 - 0.004 * k),
                tyre_pressure_pa: Some(1.6e5 - 700.0 * k),
                pto_power_w: 2e4 + 300.0 * k,
                hydraulic_power_w: 4e3 + 90.0 * k,
                ..Situation::default()
            }
        };
        (0..64).map(one).collect()
    }

    /// They go straight on from the first.
    fn way_m(at: &Situation) -> f64 {
        at.position_m + 20.0
    }

    fn value(name: &str, at: &Situation) -> f64 {
        let wind = at.air.wind_from_rad - at.place.heading_rad;
        match name {
            "v" => at.speed_m_s,
            "acceleration" => at.acceleration_m_s2,
            "F_drive" => at.tractive_force_n,
            "engine_speed" => at.engine_speed_rad_s.unwrap_or(f64::NAN),
            "x" => at.position_m,
            "way" => way_m(at),
            "t" => at.time_s,
            "heading" => at.place.heading_rad,
            "kappa" => at.place.curvature_per_m,
            "slope" => at.place.sin_slope,
            "elevation" => at.place.elevation_m,
            "temperature" => at.air.temperature_c,
            "oil_temperature" => at.oil_temperature_c.unwrap_or(f64::NAN),
            "state_of_charge" => at.state_of_charge.unwrap_or(f64::NAN),
            "roll" => at.place.sin_roll,
            "pto_power" => at.pto_power_w,
            "hydraulic_power" => at.hydraulic_power_w,
            "tyre_pressure" => at.tyre_pressure_pa.unwrap_or(f64::NAN),
            "m" => at.mass_kg,
            "g" => at.gravity_m_s2,
            "N" => at.mass_kg * at.gravity_m_s2 * at.place.cos_slope(),
            "rho" => at.air.density_kg_m3,
            "area" => at.drag_area_m2,
            "coasting" => f64::from(u8::from(at.coasting)),
            "braking" => f64::from(u8::from(at.braking)),
            "headwind" => at.air.wind_speed_m_s * wind.cos(),
            _ => at.air.wind_speed_m_s * wind.sin(),
        }
    }

    fn told(law: crate::law::Written) -> Law {
        let crate::law::Written { text, constants, prediction } = law;
        Law { text, constants, prediction, terms: 1, ..Law::default() }
    }

    /// What goes with the sign of an acceleration is a mass, or comes late.
    #[test]
    fn what_enters_by_its_size_does_so_whichever_sign_it_has() {
        let runs = vec![vec![-1.0, 0.4, 2.0, -0.3]];
        let variable = |enters| Variable {
            name: "acceleration".to_owned(),
            unit: "m/s²".to_owned(),
            runs: runs.clone(),
            twin: None,
            finest: 0.0,
            enters,
        };
        let values = |enters: Enters| -> Vec<(f64, f64)> {
            let variables = [variable(enters)];
            let times_s = [vec![0.0, 1.0, 2.0, 3.0]];
            let checked = crate::variable::check(&variables, &times_s, &[true], Target::Power).unwrap();
            let factors = full(&checked, 0);
            factors
                .iter()
                .map(|factor| {
                    let both = factor.along(&[0.7, -0.7], &[0.0, 1.0], &checked[0]).first;
                    (both[0], both[1])
                })
                .collect()
        };
        assert!(
            values(Enters::BySize).len() > 2
                && values(Enters::BySize).iter().all(|(ahead, back)| ahead == back)
        );
        assert!(values(Enters::Freely).iter().any(|(ahead, back)| ahead != back));
    }

    /// On one side of nought alone, and never in proportion from one side to the other.
    #[test]
    fn what_bends_says_nothing_of_a_mass() {
        let variables = [Variable {
            name: "acceleration".to_owned(),
            unit: "m/s²".to_owned(),
            runs: vec![vec![-1.0, 0.4, 2.0, -0.3]],
            twin: None,
            finest: 0.0,
            enters: Enters::Bent,
        }];
        let times_s = [vec![0.0, 1.0, 2.0, 3.0]];
        let checked = crate::variable::check(&variables, &times_s, &[true], Target::Force).unwrap();
        let factors = full(&checked, 0);
        assert!(factors.len() > 5 && short(&checked, 0).is_empty());
        for mut factor in factors {
            let of = |factor: &Factor| factor.along(&[-0.9, 0.0, 0.9], &[0.0, 1.0, 2.0], &checked[0]).first;
            let [behind, nought, ahead] = of(&factor)[..] else { panic!() };
            let none = |value: f64| value.abs() < 0.02;
            let one_sided = none(behind) || none(ahead) || factor.shape == Shape::Tanh;
            assert!(none(nought) && one_sided, "{factor:?}");
            // The data move a centre no further than nought.
            if factor.shape.has_centre() {
                let far = if [Shape::Above(1), Shape::Step].contains(&factor.shape) { -0.1 } else { 1.1 };
                factor.set_inner(crate::shape::Free::Centre, far, &checked[0]);
                assert_eq!(factor.centre, 0.0);
            }
        }
    }

    /// The effect checks every unit of its formula, so what it reads has units that fit.
    #[test]
    fn every_term_has_units_that_fit_and_runs_with_its_own_numbers() {
        let situations = situations();
        let variables: Vec<Variable> = crate::known_variables()
            .map(|(name, unit)| Variable {
                name: name.to_owned(),
                unit: unit.to_owned(),
                runs: vec![situations.iter().map(|at| value(name, at)).collect()],
                twin: None,
                finest: 0.0,
                enters: Enters::Freely,
            })
            .collect();
        let residual = vec![vec![0.0; situations.len()]];
        let times_s = [situations.iter().map(|at| at.time_s).collect()];
        let problem = Problem {
            variables: &variables,
            times_s: &times_s,
            target: Target::Power,
            rows: &AsTheyAre,
            residual: &residual,
            nuisances: &[],
            fit: &[true],
        };
        let bench = Bench::new(&problem).unwrap();
        assert_eq!(bench.variables.len(), variables.len());
        let mut registry = Registry::new();
        registry.effect::<Expression>();
        let mut terms = dictionary(&bench.variables);
        for wave in [1, 2] {
            let sine = Factor { variable: wave, shape: Shape::Wave, scale: 7.3, centre: 0.0 };
            terms.push(Term::of(sine));
            terms.push(Term::of(Factor { shape: Shape::Pulse(0.3), centre: 1.7, ..sine }));
            terms.extend(
                envelopes(&bench.variables, wave).into_iter().filter_map(|one| Term::product(one, sine)),
            );
        }
        assert!(terms.len() > 1000);
        for term in terms {
            let amplitudes = if term.width() == 2 { vec![30.0, -40.0] } else { vec![-30.0] };
            let count = amplitudes.len() + term.free().len();
            let law = Polished { terms: vec![term], amplitudes, ..Polished::nothing(&bench) };
            let law = told(write(&bench, &law, &DMatrix::identity(count, count), 1));
            let parameters =
                format!("(auxiliary_power: \"{}\", constants: {})", law.text, law.constants_text());
            let effect = registry.effects.build("expression", &parameters, std::path::Path::new("."));
            let effect = effect.unwrap_or_else(|error| panic!("{parameters}: {error}"));
            let names: Vec<&str> = effect.states().iter().map(|state| state.name).collect();
            let mut states = vec![0.0; names.len()];
            let lag_s = law.constants.iter().find(|one| one.name.starts_with("lag")).map(|one| one.value);
            // dy/dt = (u − y)/τ says what it follows.
            let follows = |lag_s: f64| {
                let of = |at: &Situation| {
                    let mut rates = vec![0.0; names.len()];
                    effect.act(at, &vec![0.0; names.len()], &mut rates);
                    rates[0] * lag_s
                };
                crate::lag::lagged(situations.iter().map(of), &times_s[0], lag_s)
            };
            let followed = lag_s.map(follows);
            for (index, (at, told)) in situations.iter().zip(&law.prediction[0]).enumerate() {
                for (state, name) in states.iter_mut().zip(&names) {
                    match (*name, &followed) {
                        ("way_m", _) => *state = way_m(at),
                        ("lagged", Some(followed)) => *state = followed[index],
                        _ => {}
                    }
                }
                effect.decide(at, &mut states);
                let found = effect.act(at, &states, &mut vec![0.0; states.len()]).auxiliary_power_w;
                // Where a switch goes over between two samples both are means.
                if names.contains(&"latched") && (told / law.constants[0].value).fract() != 0.0 {
                    continue;
                }
                assert!((found - told).abs() <= 1e-9 * told.abs().max(1.0), "{parameters}: {found}, {told}");
            }
        }
    }
}
