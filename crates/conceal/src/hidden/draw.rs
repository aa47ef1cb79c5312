//! Which causes a family can hide, what they need of a recording, and how large they are drawn: never on a grid.

use super::{Law, Spell, Unlisted};
use crate::dice::Dice;
use crate::family::{Family, Needs};
use crate::plan::Plan;
use std::f64::consts::TAU;

/// A cause that a family can hide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The family.
    pub family: Family,
    /// The law: the contract's id, with a variant where it has several.
    pub law: &'static str,
}

/// Laws of each family, with the shape that they have in the balance: two causes of one case differ in shape.
const COAST: [(&str, &str); 12] = [
    ("wind", "heading"),
    ("grade", "place odd"),
    ("grade_constant", "odd"),
    ("rotating_inertia", "acceleration"),
    ("mass", "acceleration"),
    ("rolling_resistance", "constant"),
    ("rolling_speed_law", "speed"),
    ("soft_ground", "place even"),
    ("multipass", "pass"),
    ("neutral_drag", "neutral"),
    ("brake_drag", "constant"),
    ("speed_threshold", "speed"),
];
const TRANSPORT: [(&str, &str); 19] = [
    ("wind", "heading"),
    ("grade", "place odd"),
    ("grade_constant", "odd"),
    ("rotating_inertia", "acceleration"),
    ("mass", "acceleration"),
    ("payload_change", "mass over time"),
    ("aerodynamic_drag", "speed"),
    ("rolling_speed_law", "speed"),
    ("soft_ground", "place even"),
    ("cornering_drag", "bends"),
    ("load_dependence", "load"),
    ("drawbar_load", "spell"),
    ("drawbar_load/spells", "spell"),
    ("braking", "brakes"),
    ("speed_threshold", "speed"),
    ("driveline_efficiency", "drive"),
    ("variator_loss", "drive"),
    ("shift_transient", "drive at a speed"),
    ("wheel_slip", "slip"),
];
const ELECTRIC: [(&str, &str); 14] = [
    ("wind", "heading"),
    ("grade", "place odd"),
    ("mass", "acceleration"),
    ("aerodynamic_drag", "speed"),
    ("soft_ground", "place even"),
    ("rolling_temperature/warm_up", "warm-up"),
    ("rolling_temperature/cold", "cold"),
    ("driveline_temperature", "warm-up"),
    ("braking", "brakes"),
    ("auxiliary_power/constant", "auxiliary"),
    ("auxiliary_power/switched", "auxiliary"),
    ("auxiliary_power/cold", "auxiliary"),
    ("battery_resistance", "battery"),
    ("regeneration_limit", "brakes"),
];
const FUEL: [(&str, &str); 13] = [
    ("engine_friction", "engine"),
    ("cold_start", "warm-up"),
    ("auxiliary_power/constant", "engine"),
    ("auxiliary_power/switched", "auxiliary"),
    ("variator_loss", "drive"),
    ("driveline_efficiency", "drive"),
    ("turbo_lag", "demand"),
    ("grade", "place odd"),
    ("mass", "acceleration"),
    ("wind", "heading"),
    ("aerodynamic_drag", "speed"),
    ("rolling_resistance", "constant"),
    ("drawbar_load/spells", "spell"),
];

fn laws(family: Family) -> &'static [(&'static str, &'static str)] {
    match family {
        Family::Coast => &COAST,
        Family::Transport => &TRANSPORT,
        Family::Electric => &ELECTRIC,
        Family::Fuel => &FUEL,
    }
}

/// Every family with every law that it can hide, in a shuffled order.
pub fn listed_of(dice: &mut Dice) -> Vec<Setting> {
    let of = |family: Family| laws(family).iter().map(move |(law, _)| Setting { family, law });
    let mut all: Vec<Setting> = Family::ALL.into_iter().flat_map(of).collect();
    dice.shuffle(&mut all);
    all
}

/// Two laws of different shape.
pub fn pair_of(family: Family, dice: &mut Dice) -> [&'static str; 2] {
    let laws = laws(family);
    let first = laws[dice.below(laws.len())];
    loop {
        let second = laws[dice.below(laws.len())];
        if second.1 != first.1 {
            return [first.0, second.0];
        }
    }
}

/// Laws that no list holds, with the families that can show them.
const UNLISTED: [(&str, &[Family]); 13] = {
    use Family::{Coast, Electric, Fuel, Transport};
    [
        ("unlisted/fading_wave", &[Coast, Transport]),
        ("unlisted/three_halves", &[Coast, Transport]),
        ("unlisted/sticking", &[Coast, Transport]),
        ("unlisted/lug", &[Coast, Transport]),
        ("unlisted/hysteresis", &[Transport]),
        ("unlisted/saturating", &[Coast, Transport]),
        ("unlisted/latch", &[Transport]),
        ("unlisted/stiffening", &[Transport, Electric]),
        ("unlisted/one_sided", &[Transport]),
        ("unlisted/product", &[Transport]),
        ("unlisted/clocked", &[Coast, Transport]),
        ("unlisted/fan_by_speed", &[Electric, Fuel]),
        ("unlisted/pump_by_change", &[Electric, Fuel]),
    ]
};

/// Unlisted laws in a shuffled order, each with the families that can hide it.
pub fn unlisted_of(dice: &mut Dice) -> Vec<Setting> {
    let of = |(law, families): &(&'static str, &'static [Family])| {
        let law = *law;
        families.iter().map(move |family| Setting { family: *family, law })
    };
    let mut all: Vec<Setting> = UNLISTED.iter().flat_map(of).collect();
    dice.shuffle(&mut all);
    all
}

/// An unlisted law that a family can hide.
pub fn unlisted_for(family: Family, dice: &mut Dice) -> &'static str {
    let fits: Vec<&'static str> =
        UNLISTED.iter().filter(|(_, families)| families.contains(&family)).map(|(law, _)| *law).collect();
    fits[dice.below(fits.len())]
}

/// What a law needs of the recording, so that it can show.
pub fn ask(law: &str, needs: &mut Needs, dice: &mut Dice) {
    match law {
        "wind" => (needs.heading, needs.calm) = (true, true),
        "grade" | "soft_ground" | "unlisted/fading_wave" | "unlisted/lug" => needs.position = true,
        "mass" => needs.certain.push("mass_kg"),
        "aerodynamic_drag" => needs.certain.push("drag_area_m2"),
        "rolling_resistance" | "brake_drag" | "unlisted/sticking" | "unlisted/saturating" => {
            needs.certain.push("coefficient");
        }
        "multipass" => needs.one_lane = true,
        "load_dependence" => {
            needs.ballast = true;
            needs.certain.push("coefficient");
        }
        "cornering_drag" | "unlisted/one_sided" => needs.bends = true,
        "wheel_slip" => needs.wheel_speed = true,
        // Without a force at the wheels, losses behind the engine are told from its own by nothing.
        "variator_loss" | "driveline_efficiency" | "turbo_lag" => needs.force = true,
        "braking" => needs.brake = dice.chance(0.5),
        "rolling_temperature/cold" | "auxiliary_power/cold" | "unlisted/stiffening" => {
            needs.temperatures = true;
        }
        "auxiliary_power/constant" => {
            needs.certain.extend(["standby_power_w", "accessory_power_w"]);
        }
        _ => {}
    }
}

/// Draws a law for a plan.
#[allow(clippy::too_many_lines, reason = "one line or two for each law")]
pub fn draw(law: &str, plan: &Plan, dice: &mut Dice) -> Law {
    let mass = plan.vehicle.mass_kg;
    let weight = mass * plan.vehicle.gravity_m_s2;
    let electric = plan.vehicle.electric.is_some();
    let coast = plan.family == "coast";
    let share = plan.vehicle.ground.share(0.0);
    let fuel = plan.vehicle.engine.is_some();
    let (slow, fast) = if electric {
        (6.0, 20.0)
    } else if coast {
        (2.5, 7.5)
    } else {
        (4.0, 11.0)
    };
    let seconds = plan.runs.first().map_or(60.0, |run| run.stop.after_s.min(170.0));
    // A force of one to six per cent of the weight on soft ground, less on the road.
    let force_n = weight * if coast { dice.log_within(0.006, 0.03) } else { dice.log_within(0.004, 0.015) };
    match law {
        "wind" => Law::Wind { speed_m_s: dice.within(4.0, 12.0), from_rad: dice.within(0.0, TAU) },
        "grade" => {
            let long = if electric {
                (250.0, 1100.0)
            } else if coast {
                (45.0, 130.0)
            } else {
                (90.0, 350.0)
            };
            let steep = if coast { (0.006, 0.02) } else { (0.006, 0.025) };
            let mut wave = || {
                (dice.log_within(steep.0, steep.1), dice.log_within(long.0, long.1), dice.within(0.0, TAU))
            };
            Law::Grade { waves: vec![wave(), wave()] }
        }
        "grade_constant" => Law::GradeConstant { grade: dice.sign() * dice.log_within(0.004, 0.025) },
        "rotating_inertia" => Law::RotatingInertia { rotating_mass_kg: mass * dice.within(0.03, 0.12) },
        "mass" => Law::Mass { extra_mass_kg: mass * dice.sign() * dice.within(0.04, 0.14) },
        "payload_change" => {
            let from_s = dice.within(5.0, 20.0);
            let to_s = from_s + dice.within(15.0, 32.0);
            Law::PayloadChange { from_s, to_s, mass_kg: mass * dice.sign() * dice.within(0.1, 0.3) }
        }
        "aerodynamic_drag" => Law::AerodynamicDrag {
            extra_area_m2: plan.vehicle.drag_area_m2
                * if electric { dice.within(0.25, 0.7) } else { dice.within(0.5, 1.6) },
        },
        "rolling_resistance" => {
            Law::RollingResistance { coefficient: share * dice.sign() * dice.within(0.08, 0.3) }
        }
        "rolling_speed_law" => Law::RollingSpeedLaw {
            linear: share * dice.sign() * dice.within(0.12, 0.5),
            reference_speed_m_s: dice.within(0.4, 0.7) * (slow + fast),
        },
        "rolling_temperature/warm_up" => Law::TyreWarmUp {
            cold_coefficient: dice.within(0.003, 0.01),
            time_constant_s: dice.within(30.0, 90.0),
        },
        "rolling_temperature/cold" => {
            Law::TyreCold { coefficient_per_k: dice.within(1.5e-4, 5e-4), reference_temperature_c: 20.0 }
        }
        "soft_ground" => {
            let (first, last, length) = if electric {
                (400.0, 2000.0, (80.0, 300.0))
            } else if coast {
                (70.0, 175.0, (12.0, 35.0))
            } else {
                (100.0, 500.0, (30.0, 90.0))
            };
            let half_wheelbase_m = if electric { 1.3 } else { 1.7 };
            let mut patches = Vec::new();
            for index in 0..=dice.below(2) {
                let width = last - first;
                let from = first + width * (0.5 * index as f64 + dice.within(0.05, 0.3));
                patches.push((from, from + dice.within(length.0, length.1), force_n * 1.6 / weight));
            }
            Law::SoftGround { patches, half_wheelbase_m }
        }
        "multipass" => {
            Law::Multipass { coefficient: share * dice.within(0.15, 0.5), factor: dice.within(0.6, 0.9) }
        }
        "neutral_drag" => Law::NeutralDrag {
            force_n: force_n * 0.7,
            viscous_n_s_m: if dice.chance(0.6) { force_n * dice.within(0.02, 0.1) } else { 0.0 },
        },
        "driveline_temperature" => Law::DrivelineTemperature {
            cold_force_n: dice.within(20.0, 70.0),
            cold_viscous_n_s_m: dice.within(2.0, 6.0),
            time_constant_s: dice.within(30.0, 90.0),
        },
        "brake_drag" => Law::BrakeDrag { force_n },
        "braking" => Law::Braking {
            spells: spells(plan, dice, (2, 4), (1.2, 3.0), (0.04 * weight, 0.14 * weight), seconds),
        },
        "cornering_drag" => Law::CorneringDrag {
            // So that the tightest bend at the middle speed costs some per cent of the weight.
            cornering_stiffness_n_per_rad: weight * dice.within(0.7, 2.5),
        },
        "load_dependence" => Law::LoadDependence {
            coefficient: share,
            exponent: if dice.chance(0.5) { dice.within(0.3, 0.7) } else { dice.within(1.4, 2.2) },
            reference_mass_kg: mass,
        },
        "drawbar_load" => {
            let from_s = dice.within(6.0, 25.0);
            let to_s = from_s + dice.within(10.0, 28.0);
            let linear_n_s_m = if dice.chance(0.5) { force_n * dice.within(0.03, 0.15) } else { 0.0 };
            Law::DrawbarLoad { force_n: force_n * 1.5, linear_n_s_m, from_s, to_s }
        }
        "drawbar_load/spells" => Law::DrawbarSpells {
            spells: spells(plan, dice, (1, 3), (5.0, 16.0), (0.008 * weight, 0.035 * weight), seconds),
        },
        "speed_threshold" => Law::SpeedThreshold {
            force_n: force_n * 1.3,
            threshold_m_s: dice.within(1.2 * slow, 0.75 * fast),
            width_m_s: dice.log_within(0.05, 0.25) * fast,
        },
        "driveline_efficiency" => Law::DrivelineEfficiency { loss: dice.log_within(0.03, 0.15) },
        "variator_loss" => {
            Law::VariatorLoss { loss: dice.within(0.08, 0.28), node_m_s: dice.within(1.1 * slow, 0.8 * fast) }
        }
        "shift_transient" => Law::ShiftTransient {
            force_n: force_n * dice.within(2.0, 5.0),
            speed_m_s: dice.within(1.1 * slow, 0.8 * fast),
            width_m_s: dice.within(0.15, 0.5),
        },
        "wheel_slip" => Law::WheelSlip { coefficient: dice.log_within(0.05, 0.5) },
        // A fan of a tractor takes ten times what a car's heater does; both are on the electric side of the model.
        "auxiliary_power/constant" => {
            Law::AuxiliaryConstant { power_w: dice.log_within(300.0, 3500.0) * if fuel { 3.0 } else { 1.0 } }
        }
        "auxiliary_power/switched" => {
            let (low, high) = if fuel { (2500.0, 14_000.0) } else { (700.0, 4500.0) };
            let length = if fuel { (8.0, 25.0) } else { (15.0, 45.0) };
            Law::AuxiliarySwitched { spells: spells(plan, dice, (1, 3), length, (low, high), seconds) }
        }
        "auxiliary_power/cold" => Law::AuxiliaryByCold {
            freezing_power_w: dice.within(800.0, 3500.0),
            balance_temperature_c: dice.within(14.0, 21.0),
        },
        "battery_resistance" => Law::BatteryResistance { resistance_ohm: dice.within(0.04, 0.2) },
        "engine_friction" => Law::EngineFriction { torque_n_m: dice.log_within(12.0, 70.0) },
        "cold_start" => Law::ColdStart {
            cold_torque_n_m: dice.log_within(25.0, 110.0),
            time_constant_s: dice.within(20.0, 90.0),
        },
        "turbo_lag" => Law::TurboLag {
            time_constant_s: dice.within(0.5, 2.5),
            unboosted_power_w: mass * dice.within(2.5, 5.0),
        },
        "regeneration_limit" => {
            let no_speed_m_s = dice.within(0.8, 2.5);
            Law::RegenerationLimit {
                power_w: dice.log_within(4000.0, 14_000.0),
                no_speed_m_s,
                full_speed_m_s: no_speed_m_s + dice.within(1.0, 3.0),
            }
        }
        _ => Law::Other(unlisted(law, plan, force_n, (slow, fast), dice)),
    }
}

fn unlisted(law: &str, plan: &Plan, force_n: f64, (slow, fast): (f64, f64), dice: &mut Dice) -> Unlisted {
    let coast = plan.family == "coast";
    let power_w = dice.log_within(800.0, 4000.0) * if plan.family == "fuel" { 4.0 } else { 1.0 };
    let force_n = force_n * 1.5;
    let speed_m_s = 0.5 * (slow + fast) * dice.within(0.8, 1.2);
    match law {
        "unlisted/fading_wave" => Unlisted::FadingWave {
            force_n: force_n * 1.5,
            wavelength_m: if coast { dice.within(25.0, 70.0) } else { dice.within(50.0, 180.0) },
            phase_rad: dice.within(0.0, TAU),
            fade_m: if coast { dice.within(100.0, 250.0) } else { dice.within(250.0, 600.0) },
        },
        "unlisted/three_halves" => Unlisted::ThreeHalves { force_n, speed_m_s },
        "unlisted/sticking" => Unlisted::Sticking { force_n: 2.0 * force_n, speed_m_s: 0.4 * speed_m_s },
        "unlisted/lug" => Unlisted::Lug { force_n: force_n * 2.0, wavelength_m: dice.within(7.0, 16.0) },
        "unlisted/hysteresis" => Unlisted::Hysteresis { force_n, acceleration_m_s2: dice.within(0.15, 0.4) },
        "unlisted/latch" => {
            let on_m_s = dice.within(0.55, 0.8) * fast;
            Unlisted::Latch { force_n, on_m_s, off_m_s: on_m_s * dice.within(0.4, 0.7) }
        }
        "unlisted/stiffening" => Unlisted::Stiffening {
            force_n,
            speed_m_s,
            middle_c: dice.within(2.0, 14.0),
            width_k: dice.within(1.5, 5.0),
        },
        "unlisted/one_sided" => Unlisted::OneSided { force_n, side_m_s2: dice.within(0.4, 0.9) },
        "unlisted/product" => {
            Unlisted::Product { force_n, speed_m_s, drive_n: plan.vehicle.mass_kg * dice.within(0.4, 0.7) }
        }
        "unlisted/clocked" => {
            let period_s = if coast { dice.within(2.0, 4.5) } else { dice.within(6.0, 20.0) };
            Unlisted::Clocked { force_n, period_s, phase_s: dice.within(0.0, period_s) }
        }
        "unlisted/fan_by_speed" => Unlisted::FanBySpeed { power_w, speed_m_s },
        "unlisted/pump_by_change" => {
            Unlisted::PumpByChange { power_w, acceleration_m_s2: dice.within(0.3, 0.6) }
        }
        _ => Unlisted::Saturating { force_n: force_n * 1.3, speed_m_s: 0.4 * speed_m_s },
    }
}

/// Spells of each run, apart from each other and from both ends.
fn spells(
    plan: &Plan,
    dice: &mut Dice,
    number: (usize, usize),
    length_s: (f64, f64),
    amount: (f64, f64),
    seconds: f64,
) -> Vec<Spell> {
    let mut all = Vec::new();
    for run in 0..plan.runs.len() {
        let count = number.0 + dice.below(number.1 - number.0 + 1);
        let slot = (seconds - 6.0) / count as f64;
        for index in 0..count {
            let length = dice.within(length_s.0, length_s.1).min(0.7 * slot);
            let from_s = 3.0 + slot * index as f64 + dice.within(0.0, slot - length);
            all.push(Spell {
                run,
                from_s,
                to_s: from_s + length,
                amount: dice.log_within(amount.0, amount.1),
            });
        }
    }
    all
}
