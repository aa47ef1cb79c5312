//! Channels of single wheels and axles, as the rigid body names them: `axle_1_left_load_n`, `axle_1_load_n`.

/// A channel of a wheel or of an axle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OfWheel<'a> {
    /// `axle_1_left`, or `axle_1`.
    pub part: &'a str,
    /// `load_n`.
    pub what: &'a str,
    /// Whether it is of one wheel, not of a whole axle.
    pub single: bool,
}

/// What a channel says, and of which wheel; `None` for a channel of the whole vehicle.
pub(crate) fn of_wheel(channel: &str) -> Option<OfWheel<'_>> {
    let begin = channel.find("axle_")?;
    let number = begin + "axle_".len();
    let digits = channel[number..].bytes().take_while(u8::is_ascii_digit).count();
    let rest = channel[number + digits..].strip_prefix('_').filter(|_| digits > 0)?;
    let axle = &channel[..number + digits];
    for side in ["left", "right", "middle"] {
        if let Some(what) = rest.strip_prefix(side).and_then(|rest| rest.strip_prefix('_')) {
            return Some(OfWheel { part: &channel[..axle.len() + 1 + side.len()], what, single: true });
        }
    }
    Some(OfWheel { part: axle, what: rest, single: false })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_says_of_which_wheel_or_axle_it_is() {
        let left = OfWheel { part: "axle_12_left", what: "slip_angle_rad", single: true };
        assert_eq!(of_wheel("axle_12_left_slip_angle_rad"), Some(left));
        let whole = OfWheel { part: "axle_1", what: "load_n", single: false };
        assert_eq!(of_wheel("axle_1_load_n"), Some(whole));
        let other = OfWheel { part: "trailer_axle_1_right", what: "load_n", single: true };
        assert_eq!(of_wheel("trailer_axle_1_right_load_n"), Some(other));
        for none in ["speed_m_s", "axle_load_n", "axle_1"] {
            assert_eq!(of_wheel(none), None, "{none}");
        }
    }
}
