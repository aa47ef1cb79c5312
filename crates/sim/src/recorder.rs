//! Writes down every step.

use crate::balance::Instant;
use crate::step::Machine;
use headland_plugin::Action;
use headland_trace::{Origin, Trace, TraceError};

/// Columns that grow row by row.
#[derive(Debug)]
pub(crate) struct Recorder {
    time_s: Vec<f64>,
    columns: Vec<Column>,
    /// What a carriage writes.
    row: Vec<f64>,
    /// How many rows there will be, as far as that is known.
    expected: usize,
}

/// A channel that takes no memory as long as nothing is in it.
#[derive(Debug)]
struct Column {
    name: String,
    /// Whether it is left out where it is zero throughout.
    only_if_used: bool,
    /// Whether nobody reads it.
    unread: bool,
    /// NaN throughout so far, or zero throughout where that counts as unused; `None` once `values` holds everything.
    idle: Option<f64>,
    values: Vec<f64>,
}

impl Column {
    /// Adds a value where `rows` are there already.
    fn push(&mut self, value: f64, rows: usize, expected: usize) {
        if self.unread {
            return;
        }
        if let Some(idle) = self.idle {
            if value.is_nan() && (idle.is_nan() || rows == 0) {
                return;
            }
            if self.only_if_used && value == 0.0 && (idle == 0.0 || rows == 0) {
                self.idle = Some(0.0);
                return;
            }
            self.values.reserve_exact(expected.max(rows + 1));
            self.values.resize(rows, idle);
            self.idle = None;
        }
        self.values.push(value);
    }
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
        if let Some(axles) = &machine.model.axles {
            names.push("slip".to_owned());
            for axle in 1..=axles.list().len() {
                names.extend(AXLE_CHANNELS.map(|what| format!("axle_{axle}_{what}")));
            }
        }
        if let Some(carriage) = &machine.carriage {
            names.extend(carriage.channels());
        }
        let first_effect = names.len();
        for effect in &machine.model.effects {
            for unit in EFFECT_UNITS {
                let name = format!("{}_{unit}", effect.name);
                // `auxiliary_power_w` is what all consumers take, not this effect alone.
                let taken = names.contains(&name);
                names.push(if taken { format!("{}_effect_{unit}", effect.name) } else { name });
            }
        }
        let column = |(index, name): (usize, String)| Column {
            only_if_used: ONLY_IF_USED.contains(&name.as_str()) || index >= first_effect,
            name,
            unread: false,
            idle: Some(f64::NAN),
            values: Vec::new(),
        };
        Self {
            time_s: Vec::new(),
            columns: names.into_iter().enumerate().map(column).collect(),
            row: Vec::new(),
            expected: 0,
        }
    }

    /// The same with room for so many rows.
    pub fn expecting(mut self, rows: usize) -> Self {
        self.time_s.reserve_exact(rows);
        self.expected = rows;
        self
    }

    /// The same with these channels alone; all of them where none are named.
    pub fn only(mut self, names: Option<&[&str]>) -> Self {
        if let Some(names) = names {
            for column in &mut self.columns {
                column.unread = !names.contains(&column.name.as_str());
            }
        }
        self
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
            machine.acceleration_m_s2(instant),
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
            instant.drawbar_n - instant.pushed_n,
            instant.pto_power_w,
            instant.hydraulic_power_w,
            instant.auxiliary_power_w,
        ];
        let (rows, expected) = (self.time_s.len(), self.expected);
        self.time_s.push(machine.time_s);
        // Group by group: one loop over a chain of them costs as much as the arithmetic of a step.
        let mut columns = self.columns.iter_mut();
        for (value, column) in motion.into_iter().zip(columns.by_ref()) {
            column.push(value, rows, expected);
        }
        let coasting = f64::from(u8::from(instant.situation.coasting));
        let readings = instant.delivery.readings.channels().map(|(_, value)| value);
        if let Some(column) = columns.next() {
            column.push(coasting, rows, expected);
        }
        for (value, column) in readings.into_iter().zip(columns.by_ref()) {
            column.push(value, rows, expected);
        }
        for (value, column) in machine.states().iter().zip(columns.by_ref()) {
            column.push(*value, rows, expected);
        }
        if machine.model.axles.is_some() {
            let slip = std::iter::once(instant.slip);
            let axles = machine.axle_states().iter().flat_map(|axle| {
                [axle.load_n, axle.slip, axle.traction_n, axle.resistance_n, axle.sinkage_m]
            });
            for (value, column) in slip.chain(axles).zip(columns.by_ref()) {
                column.push(value, rows, expected);
            }
        }
        if let Some(carriage) = &machine.carriage {
            self.row.clear();
            carriage.write(&mut self.row);
            for (value, column) in self.row.iter().zip(columns.by_ref()) {
                column.push(*value, rows, expected);
            }
        }
        let effects = machine.effect_actions().iter().flat_map(|action| effect_row(instant, action));
        for (value, column) in effects.zip(columns) {
            column.push(value, rows, expected);
        }
    }

    pub fn finish(self) -> Result<Trace, TraceError> {
        let mut trace = Trace::new(self.time_s)?;
        for column in self.columns.into_iter().filter(|column| column.idle.is_none()) {
            trace.push(column.name, column.values, Origin::Predicted)?;
        }
        Ok(trace)
    }
}

/// What is written of an axle.
const AXLE_CHANNELS: [&str; 5] = ["load_n", "slip", "traction_n", "resistance_n", "sinkage_m"];

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
