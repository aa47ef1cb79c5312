//! What parameters do to what is asked: the greatest first.

use super::{Content, asked};
use crate::page::short;
use headland_batch::Effect;
use headland_report::{Axis, Bar, Bars, Plot, Section};

/// Parameters of one plot.
const SHOWN: usize = 15;
/// Share of a result that a parameter has to change to be shown.
const LEAST: f64 = 5e-4;
/// Measures that are shown.
const MEASURES: usize = 2;
/// Plots of a page.
const PLOTS: usize = 12;

impl Content<'_> {
    /// A tornado for each variant and measure.
    pub(super) fn sensitivity(&self) -> Option<Section> {
        if self.summary.effects.is_empty() {
            return None;
        }
        let columns = self.plan.columns();
        let mut section = Section::new("What the parameters do").words(
            "Change of a result when one parameter goes to the least and to the greatest of its values and the others stay. \
             Parameters that were varied one by one are held against the run in the middle; of those that were swept or \
             sampled together it is the slope of a plane through all runs, over half of the range to either side.",
        );
        let mut plots = 0;
        for index in asked(self.plan, self.summary).into_iter().take(MEASURES) {
            for variant in 0..self.plan.comparison.variants.len() {
                let mut effects: Vec<&Effect> = self
                    .summary
                    .effects
                    .iter()
                    .filter(|effect| effect.variant == variant && size(effect, index) > LEAST)
                    .collect();
                if effects.is_empty() || plots == PLOTS {
                    continue;
                }
                let idle = self.idle(variant, index, &columns);
                effects.sort_by(|one, other| size(other, index).total_cmp(&size(one, index)));
                effects.truncate(SHOWN);
                let title = format!("{}: {}", self.axis(index).label, self.variant(variant));
                let plot = Plot::new(super::capital(&title), tornado(&effects, index, &columns));
                section = section.with(if idle.is_empty() { plot } else { plot.words(idle) });
                plots += 1;
            }
        }
        (plots > 0).then_some(section)
    }

    /// What was moved and changes so little that it is not drawn.
    fn idle(&self, variant: usize, index: usize, columns: &[&str]) -> String {
        let effects = self.summary.effects.iter();
        let idle: Vec<String> = effects
            .filter(|effect| effect.variant == variant && size(effect, index) <= LEAST)
            .map(|effect| label(effect, columns))
            .collect();
        if idle.is_empty() {
            return String::new();
        }
        format!("Less than {} %: {}.", 100.0 * LEAST, idle.join("; "))
    }
}

fn size(effect: &Effect, index: usize) -> f64 {
    let (low, high) = effect.changes[index];
    low.abs().max(high.abs())
}

/// The parameter that was moved, and between which values.
fn label(effect: &Effect, columns: &[&str]) -> String {
    let path = columns.get(effect.parameter).copied().unwrap_or("");
    let mut ends = path.rsplit('.');
    let name = ends.next().unwrap_or(path);
    let owner = ends.next().map_or(String::new(), |owner| format!("{owner}."));
    format!("{owner}{name}: {} to {}", short(effect.ends.0), short(effect.ends.1))
}

fn tornado(effects: &[&Effect], index: usize, columns: &[&str]) -> Bars {
    let side = |name: &str, of: fn(&(f64, f64)) -> f64| Bar {
        name: name.to_owned(),
        values: effects.iter().map(|effect| 100.0 * of(&effect.changes[index])).collect(),
        error: None,
    };
    Bars {
        categories: effects.iter().map(|effect| label(effect, columns)).collect(),
        axis: Axis::new("change", "%"),
        bars: vec![side("at the least value", |one| one.0), side("at the greatest value", |one| one.1)],
        stacked: true,
        horizontal: true,
    }
}
