//! Tables and numbers in Markdown.

use crate::page::short;
use headland_calibrate::statistics::mean;

/// A table; the first column is text, the others are numbers.
pub fn table(columns: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let names: Vec<String> = columns.iter().map(|name| (*name).to_owned()).collect();
    let rule: Vec<String> =
        (0..columns.len()).map(|at| if at == 0 { "---".to_owned() } else { "---:".to_owned() }).collect();
    let body: String = rows.iter().map(|row| line(row)).collect();
    format!("{}{}{body}", line(&names), line(&rule))
}

/// A share in per cent with its sign.
pub fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:+.1}", 100.0 * share).replace('-', "−"))
}

/// `before → after`.
pub fn change(before: f64, after: f64) -> String {
    format!("{} → {}", short(before), short(after))
}

/// Slope of the line through points, and their correlation.
pub fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let (mx, my) = (mean(x), mean(y));
    let sum = |one: &[f64], m: f64, other: &[f64], n: f64| -> f64 {
        one.iter().zip(other).map(|(a, b)| (a - m) * (b - n)).sum()
    };
    let (xx, xy, yy) = (sum(x, mx, x, mx), sum(x, mx, y, my), sum(y, my, y, my));
    (xy / xx, xy / (xx * yy).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_points_on_it_has_its_slope_and_correlation_one() {
        let (slope, correlation) = line(&[0.0, 1.0, 3.0], &[1.0, -1.0, -5.0]);
        assert!((slope + 2.0).abs() < 1e-12 && (correlation + 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_table_has_a_rule_below_its_head() {
        let text = table(&["run", "error"], &[vec!["a".to_owned(), percent(Some(-0.0512))]]);
        assert_eq!(text, "| run | error |\n| --- | ---: |\n| a | −5.1 |\n");
    }
}
