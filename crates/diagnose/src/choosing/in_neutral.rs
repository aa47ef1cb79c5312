//! What drag in neutral and the ground say alike. Where the fitted runs coast throughout, with one mass, a drag of the driveline
//! F₀ + F₁ v, a level of rolling resistance with a part that grows with speed, and a dragging brake with that part are sums of
//! the same regressors: what was usual before decides between them, and no recording does.

use crate::balances::gram::Reduced;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::trial::Trial;
use crate::choosing::search::{Accepted, Rival};
use crate::choosing::state::{Part, Stand, State};

/// Drag that is there in neutral alone.
const NEUTRAL: &str = "neutral_drag";
/// What is the same at all speeds.
const LEVELS: [&str; 3] = ["rolling_resistance", "brake_drag", "drawbar_load"];
/// What grows with speed.
const GROWING: &str = "rolling_speed_law";
/// Sums of regressors are the same where one leaves no more than this of the other: masses that differ by a few per cent and
/// any stretch with a force that drives leave more.
const LEFT: f64 = 1e-3;

impl State<'_> {
    /// Names beside drag in neutral what says the same of the ground, and beside the ground the drag in neutral.
    pub fn named_in_neutral(&self, best: &Stand, accepted: &mut [Accepted]) {
        let family = |part: &&Part| self.is_drag_of_coasting(&part.trial);
        let (own, others): (Vec<Part>, Vec<Part>) =
            best.parts.iter().cloned().partition(|part| family(&part));
        if own.is_empty() {
            return;
        }
        let Some(reduced) = self.reduced(&best.noises, &[]) else { return };
        let effect: Vec<(usize, f64)> = own
            .iter()
            .flat_map(|part| &part.trial.columns)
            .map(|column| (*column, best.value(*column)))
            .collect();
        for trials in self.drags_of_coasting(&own) {
            let columns: Vec<usize> = trials.iter().flat_map(|trial| trial.columns.clone()).collect();
            let covered = covered(&reduced, &effect, &columns);
            if covered < 1.0 - LEFT {
                continue;
            }
            let instead = trials.iter().map(|trial| Part { trial: (*trial).clone(), spread: None });
            let parts: Vec<Part> = others.iter().cloned().chain(instead).collect();
            let Some(stand) = self.settle(&parts, &best.noises) else { continue };
            if self.impossible(&stand.parts, &stand.estimate) {
                continue;
            }
            for one in accepted.iter_mut().filter(|one| self.is_drag_of_coasting(&one.trial)) {
                for trial in &trials {
                    let named = |rival: &Rival| self.case.causes[rival.cause].id == self.id(trial);
                    if self.id(&one.trial) != self.id(trial) && !one.rivals.iter().any(named) {
                        one.rivals.push(Rival {
                            cause: trial.cause,
                            gain: one.gain + stand.score - best.score,
                            squared_correlation: covered,
                            free: self.free_beside(&stand),
                        });
                    }
                }
            }
        }
    }

    /// Whether a cause is a drag that coast-downs with one mass show by its sum with others: one value in all runs.
    fn is_drag_of_coasting(&self, trial: &Trial) -> bool {
        let cause = self.cause(trial);
        let plain = cause.form == Form::Parameters && cause.window().is_none() && cause.run.is_none();
        let id = cause.id;
        plain && (id == NEUTRAL || LEVELS.contains(&id) || id == GROWING && is_straight(cause, trial))
    }

    /// Sets of trials that could say what `own` does: of the ground, where those are of the driveline in neutral, and the other
    /// way round.
    fn drags_of_coasting(&self, own: &[Part]) -> Vec<Vec<&Trial>> {
        let of = |id: &str| -> Vec<&Trial> {
            let able = |trial: &&Trial| self.id(trial) == id && self.is_drag_of_coasting(trial);
            self.pool.trials.iter().filter(able).collect()
        };
        if !own.iter().any(|part| self.id(&part.trial) == NEUTRAL) {
            return of(NEUTRAL)
                .into_iter()
                .filter(|trial| trial.terms.len() > 1)
                .map(|one| vec![one])
                .collect();
        }
        let (levels, growing) = (LEVELS.map(of), of(GROWING));
        let levels = || levels.iter().flat_map(|trials| trials.iter().copied());
        // A force alone is a level, and what grows with speed alone needs one only to begin at nought.
        let has = |name: &str| {
            let of = |part: &&Part| self.id(&part.trial) == NEUTRAL;
            let mut terms = own.iter().filter(of).flat_map(|part| {
                part.trial.terms.iter().map(|term| self.cause(&part.trial).terms[*term].name)
            });
            terms.any(|own| own == name)
        };
        match (has("force_n"), has("viscous_n_s_m")) {
            (true, true) => {
                levels().flat_map(|level| growing.iter().map(move |law| vec![level, *law])).collect()
            }
            (true, false) => levels().map(|level| vec![level]).collect(),
            _ => growing.iter().map(|law| vec![*law]).collect(),
        }
    }
}

/// Whether a trial of a law of speed grows with speed alone.
fn is_straight(cause: &Cause, trial: &Trial) -> bool {
    trial.terms.iter().all(|term| cause.terms[*term].name == "linear")
}

/// Share of an effect, columns with their values, that other columns together can say.
fn covered(reduced: &Reduced, effect: &[(usize, f64)], columns: &[usize]) -> f64 {
    let whole: f64 = effect
        .iter()
        .flat_map(|one| effect.iter().map(move |other| (one, other)))
        .map(|((one, a), (other, b))| a * b * reduced.matrix[(*one, *other)])
        .sum();
    let cross = nalgebra::DVector::from_iterator(
        columns.len(),
        columns.iter().map(|own| effect.iter().map(|(one, a)| a * reduced.matrix[(*own, *one)]).sum()),
    );
    let products = nalgebra::DMatrix::from_fn(columns.len(), columns.len(), |row, column| {
        reduced.matrix[(columns[row], columns[column])]
    });
    match products.cholesky() {
        Some(cholesky) if whole > 0.0 => cross.dot(&cholesky.solve(&cross)) / whole,
        _ => 0.0,
    }
}
