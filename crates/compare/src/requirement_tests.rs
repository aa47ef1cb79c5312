//! Requirements as people write them.

use super::*;

fn read(text: &str) -> Requirement {
    text.parse().unwrap()
}

fn refusal(text: &str) -> String {
    text.parse::<Requirement>().unwrap_err().to_string()
}

#[test]
fn a_requirement_reads_as_it_is_written() {
    let found = read("speed_m_s rmse < 0.2");
    assert_eq!(
        (found.channel.as_str(), found.metric, found.relation),
        ("speed_m_s", Metric::Rmse, Relation::Less)
    );
    assert_eq!(found.limit, 0.2);
    assert_eq!(found.to_string(), "speed_m_s rmse < 0.2 m/s");
    assert_eq!(read("  speed_m_s   ISO18571>=.8").relation, Relation::GreaterOrEqual);
    assert_eq!(read(&found.to_string()), found);
    for (metric, word) in Metric::ALL {
        assert_eq!(read(&format!("speed_m_s {word} <= 1e-1")).metric, metric);
    }
}

#[test]
fn a_limit_in_another_unit_is_converted() {
    assert!((read("speed_m_s rmse < 0.72 km/h").limit - 0.2).abs() < 1e-15);
    assert!((read("fuel_rate_kg_s total < 5 %").limit - 0.05).abs() < 1e-15);
    assert!((read("speed_m_s nrmse < 3%").limit - 0.03).abs() < 1e-15);
    assert!((read("speed_m_s lag <= 200 ms").limit - 0.2).abs() < 1e-15);
    assert!((read("air_temperature_c bias < 9 °F").limit - 5.0).abs() < 1e-12);
    assert!((read("course_deg bias < 0.1 rad").limit - 5.729_578).abs() < 1e-6);
    assert!((read("air_temperature_c bias < 2 K").limit - 2.0).abs() < 1e-12);
}

#[test]
fn what_is_no_requirement_is_refused_with_the_reason() {
    assert!(refusal("speed_m_s rmse 0.2").contains("it has no < <= > or >="));
    assert!(refusal("rmse < 0.2").contains("1 words stand before `<`"));
    assert!(refusal("speed_m_s rsme < 0.2").contains("no metric is named `rsme`; did you mean `rmse`?"));
    assert!(refusal("speed_m_s quality < 0.2").contains("`quality`; known: bias, rmse"));
    assert!(refusal("speed_m_s rmse < low").contains("`low` is no number"));
    assert!(refusal("speed_m_s rmse <").contains("`` is no number"));
    assert!(refusal("speed_m_s rmse < -1").contains("its limit -1 is not"));
    assert!(refusal("speed_m_s rmse < NaN").contains("its limit NaN is not"));
    assert!(refusal("speed_m_s rmse < 2 kg").contains("`kg` of its limit does not fit, expected m/s"));
    assert!(refusal("speed_m_s nrmse < 2 m/s").contains("expected a pure number or %"));
    assert!(refusal("speed_m_s rmse < 2 parsec").contains("`parsec`"));
}

#[test]
fn limits_include_what_they_say() {
    assert!(!Relation::Less.holds(1.0, 1.0) && Relation::LessOrEqual.holds(1.0, 1.0));
    assert!(!Relation::Greater.holds(1.0, 1.0) && Relation::GreaterOrEqual.holds(1.0, 1.0));
    assert!(!Relation::Less.holds(f64::NAN, 1.0) && !Relation::GreaterOrEqual.holds(f64::NAN, 1.0));
}
