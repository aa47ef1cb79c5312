//! The channel names that every part of Headland agrees on.

/// A channel that Headland knows, and what it holds.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Name, ending in its unit.
    pub name: &'static str,
    /// What it holds, with the sign convention.
    pub about: &'static str,
}

const fn known(name: &'static str, about: &'static str) -> Known {
    Known { name, about }
}

/// Every known channel. Headings and wind directions are clockwise from north; a wind direction is where it blows from.
pub const KNOWN: &[Known] = &[
    known("time_s", "time since the start of the run"),
    known("position_m", "distance along the path"),
    known("speed_m_s", "speed over ground along the path"),
    known("acceleration_m_s2", "dv/dt, gravity not included"),
    known("specific_force_m_s2", "forward accelerometer, gravity included"),
    known("vertical_acceleration_m_s2", "upward, gravity not included"),
    known("wheel_speed_m_s", "rolling radius times wheel speed"),
    known("heading_rad", "direction of travel, clockwise from north"),
    known("yaw_rate_rad_s", "rate of turn, clockwise"),
    known("curvature_per_m", "turn per metre of path, clockwise"),
    known("latitude_deg", "geodetic latitude"),
    known("longitude_deg", "geodetic longitude"),
    known("east_m", "position east of the origin"),
    known("north_m", "position north of the origin"),
    known("elevation_m", "height above the origin"),
    known("grade", "rise over horizontal distance"),
    known("pitch_rad", "nose up"),
    known("roll_rad", "right side down"),
    known("tractive_force_n", "net force of the driven wheels on the vehicle, forward"),
    known("drawbar_force_n", "pull of an implement or trailer on the vehicle, backward"),
    known("pto_power_w", "power taken by the power take-off"),
    known("hydraulic_power_w", "power taken by the remote hydraulics"),
    known("engine_speed_rad_s", "crankshaft speed"),
    known("engine_torque_n_m", "crankshaft torque, driving"),
    known("fuel_rate_kg_s", "fuel mass flow"),
    known("cvt_ratio", "engine speed over wheel speed"),
    known("motor_speed_rad_s", "electric motor speed"),
    known("motor_torque_n_m", "electric motor torque, driving"),
    known("battery_voltage_v", "terminal voltage"),
    known("battery_current_a", "terminal current, positive when discharging"),
    known("state_of_charge", "share of the capacity that is left, 0 to 1"),
    known("auxiliary_power_w", "electric power of everything but the drive"),
    known("wind_speed_m_s", "speed of the air over ground"),
    known("wind_direction_rad", "where the wind blows from, clockwise from north"),
    known("air_temperature_c", "ambient temperature"),
    known("oil_temperature_c", "driveline oil temperature"),
    known("tyre_pressure_pa", "inflation pressure above ambient"),
    known("payload_kg", "mass carried beyond the empty vehicle"),
    known("coasting", "1 in neutral, 0 driven"),
    known("brake", "1 braked, 0 not"),
];

/// Whether `name` is one of them.
pub fn is_known(name: &str) -> bool {
    KNOWN.iter().any(|known| known.name == name)
}
