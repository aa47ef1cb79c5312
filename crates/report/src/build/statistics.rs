//! What was estimated, and how well.

use crate::number::pretty_unit;
use crate::{Axis, Cell, Cumulative, Heat, Plot, Steps, Table};
use headland_units::unit_of_name;

/// The share of `values` that is at most each of them, with a band of plus and minus a half width, cut at 0 and 1.
///
/// Each distribution is a name, its values (missing ones are left out) and the half width of its band, which is 0 for no
/// band.
pub fn cumulative_probability(axis: Axis, distributions: &[(&str, &[f64], f64)]) -> Plot {
    let steps = distributions
        .iter()
        .map(|(name, values, half_width)| {
            let mut x: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
            x.sort_by(f64::total_cmp);
            let samples = x.len() as f64;
            let probability: Vec<f64> = (1..=x.len()).map(|rank| rank as f64 / samples).collect();
            let band = (*half_width > 0.0).then(|| {
                let shifted =
                    |by: f64| probability.iter().map(|p| (p + by).clamp(0.0, 1.0)).collect::<Vec<_>>();
                (shifted(-half_width), shifted(*half_width))
            });
            Steps { name: (*name).to_owned(), x, probability, band }
        })
        .collect();
    let title = format!("Cumulative probability of {}", axis.label);
    Plot::new(title, Cumulative { axis, steps })
}

/// A parameter that was estimated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameter {
    /// Its name, ending in its unit.
    pub name: String,
    /// What was known before; NaN where nothing was.
    pub prior: f64,
    /// The estimate.
    pub value: f64,
    /// Lower and upper end of its 95 % interval.
    pub ci95: (f64, f64),
}

/// A table of parameters with their 95 % intervals, each in the unit that ends its name.
pub fn parameter_table(title: &str, parameters: &[Parameter]) -> Table {
    let with_prior = parameters.iter().any(|parameter| parameter.prior.is_finite());
    let mut columns = vec![Axis::new("parameter", ""), Axis::new("unit", "")];
    if with_prior {
        columns.push(Axis::new("before", ""));
    }
    columns.push(Axis::new("estimate (95 % interval)", ""));
    let rows = parameters
        .iter()
        .map(|parameter| {
            let unit =
                unit_of_name(&parameter.name).map_or_else(String::new, |unit| pretty_unit(&unit.symbol));
            let (lower, upper) = parameter.ci95;
            let mut row = vec![Cell::from(Axis::of(&parameter.name).label), Cell::from(unit)];
            if with_prior {
                row.push(Cell::Number(parameter.prior));
            }
            row.push(Cell::Interval { value: parameter.value, lower, upper });
            row
        })
        .collect();
    Table { title: title.to_owned(), columns, rows }
}

/// A heat map of the correlation between parameters, called by their names without unit, `matrix[row][column]` from -1 to 1.
pub fn correlation(names: &[&str], matrix: &[Vec<f64>]) -> Plot {
    let names: Vec<String> = names.iter().map(|name| Axis::of(name).label).collect();
    let heat = Heat {
        axis: Axis::new("correlation", ""),
        columns: names.clone(),
        rows: names,
        values: matrix.to_vec(),
        limit: 1.0,
    };
    Plot::new("Correlation of the estimates", heat)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;

    #[test]
    fn the_probability_counts_values_and_its_band_ends_at_0_and_1() {
        let values = [3.0, 1.0, f64::NAN, 2.0, 4.0];
        let plot = cumulative_probability(Axis::of("speed_m_s"), &[("r1", &values, 0.3)]);
        let Kind::Cumulative(Cumulative { steps, .. }) = plot.kind else { panic!("no distribution") };
        assert_eq!(steps[0].x, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(steps[0].probability, [0.25, 0.5, 0.75, 1.0]);
        let (low, high) = steps[0].band.clone().unwrap();
        assert_eq!((low[0], high[3]), (0.0, 1.0));
        assert!((low[1] - 0.2).abs() < 1e-12 && (high[1] - 0.8).abs() < 1e-12);
    }

    #[test]
    fn a_table_without_priors_has_no_column_for_them() {
        let mut parameter =
            Parameter { name: "drag_area_m2".to_owned(), prior: f64::NAN, value: 5.0, ci95: (4.8, 5.2) };
        let table = parameter_table("fit", std::slice::from_ref(&parameter));
        assert_eq!(table.columns.len(), 3);
        assert_eq!(table.rows[0][..2], [Cell::from("drag area"), Cell::from("m²")]);
        parameter.prior = 6.0;
        assert_eq!(parameter_table("fit", &[parameter]).columns.len(), 4);
    }
}
