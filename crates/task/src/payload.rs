//! What a machine carries: between nothing and its capacity.

use headland_plugin::Refusal;

/// A payload may miss its bounds by the rounding of a located end, as a share of the capacity.
const SLACK: f64 = 1e-9;

/// Why a payload that changes at a rate cannot go on doing so.
pub(crate) fn trouble(payload_kg: f64, rate_kg_s: f64, capacity_kg: f64) -> Option<String> {
    let slack_kg = SLACK * capacity_kg;
    if payload_kg > capacity_kg + slack_kg && rate_kg_s > 0.0 {
        return Some(format!(
            "it is full: {capacity_kg} kg are all that it holds; let the phase end where its payload has risen"
        ));
    }
    if payload_kg < -slack_kg && rate_kg_s < 0.0 {
        return Some("it is empty; let the phase end where its payload has fallen".to_owned());
    }
    None
}

/// Refuses a payload that does not fit.
pub(crate) fn check_initial(initial_kg: f64, capacity_kg: f64) -> Result<(), Refusal> {
    if (0.0..=capacity_kg).contains(&initial_kg) {
        return Ok(());
    }
    Err(Refusal {
        parameter: "initial_kg".to_owned(),
        found: initial_kg.to_string(),
        expected: format!("0 to the capacity, {capacity_kg}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_would_go_on_beyond_a_bound_is_trouble() {
        assert_eq!(trouble(900.0, 5.0, 900.0), None);
        assert!(trouble(900.1, 5.0, 900.0).unwrap().contains("full"));
        assert_eq!(trouble(900.1, -5.0, 900.0), None);
        assert!(trouble(-0.1, -5.0, 900.0).unwrap().contains("empty"));
        assert!(check_initial(901.0, 900.0).is_err() && check_initial(0.0, 900.0).is_ok());
    }
}
