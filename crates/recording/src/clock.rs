//! Dates and clock times as logs write them.

use crate::describe::DateOrder;

/// Seconds of a day.
pub(crate) const DAY_S: f64 = 86_400.0;

/// Seconds since midnight of `HH:MM:SS`, with a fraction, `AM` or `PM`, or `MM:SS.f`.
pub(crate) fn clock_s(text: &str) -> Option<f64> {
    let text = text.trim();
    let upper = text.to_ascii_uppercase();
    let (digits, half) = match upper.strip_suffix("AM").or_else(|| upper.strip_suffix("PM")) {
        Some(digits) => (digits.trim(), upper.ends_with("PM").then_some(12.0).or(Some(0.0))),
        None => (upper.as_str(), None),
    };
    let parts: Vec<&str> = digits.split(':').collect();
    let seconds = |text: &str| {
        let text = text.replace(',', ".");
        text.starts_with(|c: char| c.is_ascii_digit()).then(|| text.parse::<f64>().ok()).flatten()
    };
    let whole = |text: &str| text.parse::<u32>().ok().map(f64::from);
    let (hours, minutes, seconds) = match parts[..] {
        [hours, minutes, rest] => (whole(hours)?, whole(minutes)?, seconds(rest)?),
        [minutes, rest] if rest.contains(['.', ',']) && half.is_none() => {
            (0.0, whole(minutes)?, seconds(rest)?)
        }
        _ => return None,
    };
    if hours >= 25.0 || minutes >= 60.0 || seconds >= 61.0 {
        return None;
    }
    let hours = match half {
        Some(_) if !(1.0..=12.0).contains(&hours) => return None,
        Some(half) => hours % 12.0 + half,
        None => hours,
    };
    Some(hours * 3600.0 + minutes * 60.0 + seconds)
}

/// Seconds from 1970-01-01 to the start of the day of a date: `2023-10-23`, `23.10.2023`, `10/23/2023` with its order.
pub(crate) fn date_s(text: &str, order: Option<DateOrder>) -> Option<f64> {
    let parts: Vec<&str> = text.trim().split(['-', '/', '.']).collect();
    let [a, b, c] = parts[..] else { return None };
    let (year, month, day) = match order.or_else(|| order_of(text))? {
        DateOrder::Ymd => (a, b, c),
        DateOrder::Dmy => (c, b, a),
        DateOrder::Mdy => (c, a, b),
    };
    let (mut year, month, day): (i64, u32, u32) =
        (year.parse().ok()?, month.parse().ok()?, day.parse().ok()?);
    if (0..100).contains(&year) {
        year += 2000;
    }
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let length = match month {
        4 | 6 | 9 | 11 => 30,
        2 if leap => 29,
        2 => 28,
        _ => 31,
    };
    if !(1..=12).contains(&month) || !(1..=length).contains(&day) {
        return None;
    }
    Some(days(year, month, day) as f64 * DAY_S)
}

/// The order that a date shows by itself; `None` where day and month could be either.
pub(crate) fn order_of(text: &str) -> Option<DateOrder> {
    let parts: Vec<&str> = text.trim().split(['-', '/', '.']).collect();
    let [a, b, _] = parts[..] else { return None };
    let (first, second): (u32, u32) = (a.parse().ok()?, b.parse().ok()?);
    if a.len() == 4 {
        Some(DateOrder::Ymd)
    } else if text.contains('.') || first > 12 {
        Some(DateOrder::Dmy)
    } else if second > 12 {
        Some(DateOrder::Mdy)
    } else {
        None
    }
}

/// Seconds from 1970-01-01 UTC of a date and a clock time in one cell; an offset such as `+02:00` is taken off.
pub(crate) fn date_time_s(text: &str, order: Option<DateOrder>) -> Option<f64> {
    let text = text.trim();
    let (date, clock) = text.split_once(['T', ' '])?;
    let clock = clock.trim();
    let (clock, zone_s) = match clock.strip_suffix(['Z', 'z']) {
        Some(clock) => (clock, 0.0),
        None => match clock.rfind(['+', '-']) {
            Some(at) => (&clock[..at], zone_s(&clock[at..])?),
            None => (clock, 0.0),
        },
    };
    Some(date_s(date, order)? + clock_s(clock.trim())? - zone_s)
}

fn zone_s(text: &str) -> Option<f64> {
    let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
    let digits: String = text.chars().filter(char::is_ascii_digit).collect();
    let hours: f64 = digits.get(..2)?.parse().ok()?;
    let minutes: f64 = digits.get(2..4).map_or(Some(0.0), |minutes| minutes.parse().ok())?;
    Some(sign * (hours * 3600.0 + minutes * 60.0))
}

/// Days from 1970-01-01 in the Gregorian calendar, counted in years that begin in March so that the leap day is last.
fn days(year: i64, month: u32, day: u32) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let before_months = (153 * i64::from(month) + 2) / 5;
    let before_years = 365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    // 719 468 days lie between 0000-03-01 and 1970-01-01.
    before_years + before_months + i64::from(day) - 1 - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_from_1970() {
        assert_eq!(date_s("1970-01-01", None), Some(0.0));
        assert_eq!(date_s("2000-03-01", None), Some(11_017.0 * DAY_S));
        assert_eq!(date_time_s("2023-10-23 06:50:50", None), Some(1_698_043_850.0));
        assert_eq!(date_time_s("2023-10-23T08:50:50.250+02:00", None), Some(1_698_043_850.25));
        assert_eq!(date_time_s("2023-10-23T06:50:50Z", None), Some(1_698_043_850.0));
    }

    #[test]
    fn the_order_of_a_date_is_seen_or_asked_for() {
        assert_eq!(date_s("23.10.2023", None), date_s("2023-10-23", None));
        assert_eq!(date_s("10/23/2023", None), date_s("2023-10-23", None));
        assert_eq!(date_s("03/04/2021", None), None);
        assert_eq!(date_s("03/04/2021", Some(DateOrder::Mdy)), date_s("2021-03-04", None));
        assert_eq!(date_s("03/04/2021", Some(DateOrder::Dmy)), date_s("2021-04-03", None));
    }

    #[test]
    fn what_is_no_date_is_refused() {
        for text in ["90/02/2032", "30/00/2006", "2023-02-29", "2023-13-01", "yesterday", "12:30"] {
            assert_eq!(date_s(text, Some(DateOrder::Mdy).filter(|_| text.contains('/'))), None, "{text}");
        }
        assert!(date_s("2024-02-29", None).is_some());
    }

    #[test]
    fn clocks_are_read_in_every_spelling() {
        assert_eq!(clock_s("01:02:03"), Some(3723.0));
        assert_eq!(clock_s("01:02:03.5"), Some(3723.5));
        assert_eq!(clock_s("02:03.5"), Some(123.5));
        assert_eq!(clock_s("12:00:01 AM"), Some(1.0));
        assert_eq!(clock_s("1:00:00 pm"), Some(46_800.0));
        for text in ["12:30", "12:60:00", "1:2:-3", "x:0:0", "13:00:00 PM", ""] {
            assert_eq!(clock_s(text), None, "{text}");
        }
    }
}
