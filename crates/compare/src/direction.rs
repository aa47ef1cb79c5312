//! Angles that wrap: a heading of 359° and one of 1° are 2° apart.

use std::f64::consts::TAU;

/// Words of a channel name that mean a direction on the compass. Pitch and roll are angles that do not wrap.
const COMPASS: &[&str] = &["heading", "direction", "course", "bearing", "azimuth", "yaw"];

/// One full turn in the unit of the channel; `None` where the channel is no direction.
pub fn full_turn(channel: &str) -> Option<f64> {
    let turn = if channel.ends_with("_rad") {
        TAU
    } else if channel.ends_with("_deg") {
        360.0
    } else {
        return None;
    };
    channel.split('_').any(|word| COMPASS.contains(&word)).then_some(turn)
}

/// The angle that is `value` but for full turns and lies within half a turn of `reference`.
pub fn nearest(value: f64, reference: f64, turn: f64) -> f64 {
    value + turn * ((reference - value) / turn).round()
}

/// The same directions without jumps: each within half a turn of the last one that is not NaN.
pub fn unwrapped(values: &[f64], turn: f64) -> Vec<f64> {
    let mut last: Option<f64> = None;
    values
        .iter()
        .map(|value| {
            let near = last.map_or(*value, |last| nearest(*value, last, turn));
            if near.is_finite() {
                last = Some(near);
            }
            near
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_wrap_and_rates_pitch_and_positions_do_not() {
        assert_eq!(full_turn("heading_rad"), Some(TAU));
        assert_eq!(full_turn("wind_direction_rad"), Some(TAU));
        assert_eq!(full_turn("gps_course_deg"), Some(360.0));
        for plain in ["yaw_rate_rad_s", "pitch_rad", "latitude_deg", "direction", "speed_m_s"] {
            assert_eq!(full_turn(plain), None, "{plain}");
        }
    }

    #[test]
    fn a_turn_through_north_is_continuous_and_a_gap_is_bridged() {
        let found = unwrapped(&[350.0, f64::NAN, 10.0, 30.0, 350.0], 360.0);
        assert_eq!((found[0], found[2], found[3], found[4]), (350.0, 370.0, 390.0, 350.0));
        assert!(found[1].is_nan());
        assert_eq!(nearest(1.0, 359.0, 360.0), 361.0);
    }
}
