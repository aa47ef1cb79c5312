//! Writes down every step.

use crate::balance::Instant;
use crate::step::Machine;
use headland_plugin::Action;
use headland_trace::{Origin, Trace, TraceError};

/// Columns that grow row by row.
#[derive(Debug)]
pub(crate) struct Recorder {
    time_s: Vec<f64>,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    first_effect: usize,
}

const MOTION: [&str; 19] = [
    "position_m",
    "speed_m_s",
    "wheel_speed_m_s",
    "acceleration_m_s2",
    "effective_mass_kg",
    "elevation_m",
    "grade",
    "heading_rad",
    "east_m",
    "north_m",
    "tractive_force_n",
    "brake_force_n",
    "soil_resistance_n",
    "air_resistance_n",
    "slope_resistance_n",
    "drawbar_force_n",
    "pto_power_w",
    "hydraulic_power_w",
    "auxiliary_power_w",
];

/// Channels that are left out of a trace in which they are zero throughout.
const ONLY_IF_USED: [&str; 5] =
    ["brake_force_n", "drawbar_force_n", "pto_power_w", "hydraulic_power_w", "auxiliary_power_w"];

impl Recorder {
    pub fn new(machine: &Machine) -> Self {
        let mut names: Vec<String> = MOTION.map(str::to_owned).into();
        names.push("coasting".to_owned());
        names.extend(headland_plugin::Readings::NONE.channels().map(|(name, _)| name.to_owned()));
        names.extend(machine.layout.states.iter().map(|(name, _)| name.clone()));
        let first_effect = names.len();
        for effect in &machine.model.effects {
            for unit in EFFECT_UNITS {
                let name = format!("{}_{unit}", effect.name);
                // `auxiliary_power_w` is what all consumers take, not this effect alone.
                let taken = names.contains(&name);
                names.push(if taken { format!("{}_effect_{unit}", effect.name) } else { name });
            }
        }
        let columns = vec![Vec::new(); names.len()];
        Self { time_s: Vec::new(), names, columns, first_effect }
    }

    pub fn last_time_s(&self) -> Option<f64> {
        self.time_s.last().copied()
    }

    pub fn push(&mut self, machine: &Machine, instant: &Instant) {
        let place = instant.situation.place;
        let motion = [
            instant.situation.position_m,
            machine.speed_m_s(),
            instant.wheel_speed_m_s,
            instant.acceleration_m_s2,
            instant.effective_mass_kg,
            place.elevation_m,
            place.grade(),
            place.heading_rad,
            place.east_m,
            place.north_m,
            instant.delivery.force_n,
            instant.brake_n,
            instant.soil_n,
            -instant.air_n,
            instant.slope_n,
            instant.drawbar_n,
            instant.pto_power_w,
            instant.hydraulic_power_w,
            instant.auxiliary_power_w,
        ];
        self.time_s.push(machine.time_s);
        let readings = instant.delivery.readings.channels();
        let values = motion
            .into_iter()
            .chain([f64::from(u8::from(instant.situation.coasting))])
            .chain(readings.into_iter().map(|(_, value)| value))
            .chain(machine.states().iter().copied())
            .chain(machine.effect_actions().iter().flat_map(|action| effect_row(instant, action)));
        for (column, value) in self.columns.iter_mut().zip(values) {
            column.push(value);
        }
    }

    pub fn finish(self) -> Result<Trace, TraceError> {
        let mut trace = Trace::new(self.time_s)?;
        for (index, (name, values)) in self.names.into_iter().zip(self.columns).enumerate() {
            let absent = values.iter().all(|value| value.is_nan());
            let optional = ONLY_IF_USED.contains(&name.as_str()) || index >= self.first_effect;
            let unused = optional && values.iter().all(|value| *value == 0.0);
            if !absent && !unused {
                trace.push(name, values, Origin::Predicted)?;
            }
        }
        Ok(trace)
    }
}

/// What is written of an effect: net forward force, power, mass in inertia, friction torque, resistance.
const EFFECT_UNITS: [&str; 5] = ["n", "w", "kg", "n_m", "ohm"];

fn effect_row(instant: &Instant, action: &Action) -> [f64; EFFECT_UNITS.len()] {
    let way = if instant.situation.speed_m_s < 0.0 { -1.0 } else { 1.0 };
    [
        action.force_n - way * instant.resistance_n(action),
        instant.power_w(action),
        action.mass_kg + action.rotating_mass_kg,
        action.engine_friction_n_m,
        action.battery_resistance_ohm,
    ]
}
