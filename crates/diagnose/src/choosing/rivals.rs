//! What could stand in the place of a cause: other causes, other sets, and the same function by another name.

use crate::balances::balance::Kind;
use crate::balances::gram::Column;
use crate::causes::catalogue::{Cause, Form, LawText};
use crate::causes::trial::Trial;
use crate::choosing::conclude::Side;
use crate::choosing::search::{Accepted, Beside, Found, OTHER_WORDS, Rival, TOLERANCE, worth};
use crate::choosing::state::{Stand, State};
use crate::law::nameable::way_is_place;
use crate::runs::places::in_one_place;
use headland_calibrate::statistics::{median, quantile_of_sorted, sorted};

/// A squared correlation below which a cause does not stand for another one.
const UNLIKE: f64 = 0.02;

/// Where something is as good as a cause anyway, what comes close to it is named as well: odds of one to a hundred and fifty.
pub const TOLERANCE_IN_DOUBT: f64 = 5.0;

/// A shape was moved to where it suits best, which ln p does not count: so much it is worth by chance.
const PER_SHAPE: f64 = 1.5;

/// A map of places that says this much of what a course of each run says stands beside it.
const OF_PLACES: f64 = 0.7;

/// A map of the ground that is the same everywhere.
const LEVEL: &str = "rolling_resistance";

/// What blows, and what it blows at.
const WIND: &str = "wind";
const AIR: &str = "aerodynamic_drag";

/// What pulls for a while.
const PULL: &str = "drawbar_load";

/// The other name of a function of the path, where it has one: driven one way alone, slopes and softer ground are the same.
pub fn twin(id: &str) -> Option<&'static str> {
    match id {
        "grade" => Some("soft_ground"),
        "soft_ground" => Some("grade"),
        _ => None,
    }
}

impl State<'_> {
    /// Causes that explain as much in the place of one.
    pub fn rivals(&self, best: &Stand, side: &Side) -> Vec<Rival> {
        let (id, Some(lesser)) = (self.id(&side.part.trial), &side.lesser) else { return Vec::new() };
        // What the air does was made in the wind that was found: without it, it would blow there still, by another area.
        let blows = id == WIND && self.case.has_built();
        if blows && lesser.parts.iter().any(|part| self.id(&part.trial) == AIR) {
            return Vec::new();
        }
        let Some(reduced) = self.reduced(&best.noises, &lesser.parts) else { return Vec::new() };
        let mut rivals: Vec<Rival> = Vec::new();
        let mut doubtful = false;
        for other in &side.contests {
            let Some(own) = other.stand.parts.last() else { continue };
            let listed = rivals.iter().any(|rival| self.case.causes[rival.cause].id == self.id(&own.trial));
            let moved = self.shapes(&side.part.trial).saturating_sub(self.shapes(&own.trial));
            let behind = best.score - other.stand.score - PER_SHAPE * moved as f64;
            let one_way = self.is_place_told_one_way(&side.part.trial, &own.trial);
            let gain = other.stand.score - lesser.score;
            let shared = gain > OF_PLACES * (best.score - lesser.score)
                && self.is_place_for_course(&side.part.trial, &own.trial);
            let alike = behind < TOLERANCE_IN_DOUBT || one_way || shared;
            if self.id(&own.trial) == id
                || listed
                || !alike
                || self.is_course_beside(&side.part.trial, &own.trial)
            {
                continue;
            }
            doubtful |= behind < TOLERANCE || one_way || shared;
            let correlation = reduced.squared_correlation(
                &side.part.trial.columns,
                &own.trial.columns,
                &lesser.used,
                &self.sd(),
            );
            rivals.push(Rival {
                cause: own.trial.cause,
                gain,
                squared_correlation: correlation,
                free: self.free_beside(&other.stand),
            });
        }
        if doubtful { rivals } else { Vec::new() }
    }

    /// How many numbers of a cause were moved to where they suit best.
    fn shapes(&self, trial: &Trial) -> usize {
        self.cause(trial).terms.iter().filter(|term| !term.linear && !term.is_held()).count()
    }

    /// Whether one cause is a formula and the other a power that takes a course of its own in each run: the one foretells runs, the
    /// other follows them.
    fn is_course_beside(&self, own: &Trial, other: &Trial) -> bool {
        let other = self.cause(other);
        self.cause(own).law.is_some()
            && other.is_course()
            && other.balances.iter().all(|kind| kind.is_power())
    }

    /// Whether one cause is a pull that takes a course of its own in each run and the other a map of places that runs share: a map says
    /// the same of all of them, and what it says nearly as much by is hardly that by chance.
    fn is_place_for_course(&self, own: &Trial, other: &Trial) -> bool {
        self.cause(own).pulls_in_spells()
            && self.cause(other).form == Form::OverPosition
            && self.paths_shared()
    }

    /// Whether one cause is a law of places alone and the other a map of them, and neither was a path driven both ways nor an
    /// accelerometer there to tell: waves of a road are slopes by their name, however short the formula that draws them, and
    /// however coarse the map.
    fn is_place_told_one_way(&self, own: &Trial, other: &Trial) -> bool {
        let (own, other) = (self.cause(own), self.cause(other));
        let from_one_place = |law: &LawText| law.is_of_the_way() && way_is_place(self.case);
        let of_place = own.law.as_ref().is_some_and(|law| law.is_of_places() || from_one_place(law));
        let told = self.system.has(Kind::Parity) || self.case.drives_a_path_both_ways();
        of_place && other.form == Form::OverPosition && !told
    }

    /// Names a level of rolling resistance beside a map of the ground that lies off nought along most of the way: a patch is
    /// nought elsewhere, and what is not is level and map in one.
    pub fn named_level(&self, best: &Stand, accepted: &mut [Accepted]) {
        /// The median lies so many standard deviations off, and is this share of what the map is in the root mean square.
        const SIGMAS: f64 = 3.0;
        const SHARE: f64 = 0.4;
        let plain = |cause: &Cause| cause.form == Form::Parameters && cause.run.is_none();
        let level = |cause: &Cause| cause.id == LEVEL && plain(cause);
        let Some(cause) = self.case.causes.iter().position(level) else { return };
        if accepted.iter().any(|one| self.id(&one.trial) == LEVEL) {
            return;
        }
        for one in accepted.iter_mut() {
            let even = self.cause(&one.trial).even().map(|(id, _)| id);
            let by_place = self.cause(&one.trial).form == Form::OverPosition;
            let Some(function) = one.function.as_ref().filter(|_| by_place && even == Some(LEVEL)) else {
                continue;
            };
            let knots = || function.values.iter().flat_map(|(values, sds)| values.iter().zip(sds.iter()));
            let (values, sds): (Vec<f64>, Vec<f64>) = knots().map(|(value, sd)| (*value, *sd)).unzip();
            if values.is_empty() || one.rivals.iter().any(|rival| rival.cause == cause) {
                continue;
            }
            let middle = median(&values);
            let square = values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64;
            let off = middle.abs() > SIGMAS * median(&sds) && middle.abs() > SHARE * square.sqrt();
            if !off {
                continue;
            }
            let other_names = self.names_of_level(best, cause, middle);
            for cause in std::iter::once(cause).chain(other_names) {
                if !one
                    .rivals
                    .iter()
                    .any(|rival| self.case.causes[rival.cause].id == self.case.causes[cause].id)
                {
                    one.rivals.push(Rival {
                        cause,
                        gain: one.gain,
                        squared_correlation: middle * middle / square,
                        free: self.free_beside(best),
                    });
                }
            }
        }
    }

    /// Causes of one number that do to these rows what a level of the ground does, each of which can be what a level of this value
    /// asks of it: brakes that drag, on one ground.
    fn names_of_level(&self, best: &Stand, cause: usize, level: f64) -> Vec<usize> {
        let single = |trial: &&Trial| {
            let cause = self.cause(trial);
            trial.columns.len() == 1
                && cause.form == Form::Parameters
                && cause.law.is_none()
                && cause.run.is_none()
        };
        let singles = || self.pool.trials.iter().filter(single);
        let ground = singles().find(|trial| trial.cause == cause);
        let Some((ground, reduced)) = ground.zip(self.reduced(&best.noises, &[])) else { return Vec::new() };
        let product = |one: &Trial, other: &Trial| reduced.matrix[(one.columns[0], other.columns[0])];
        let same = |trial: &&Trial| {
            let (own, both) = (product(trial, trial), product(trial, ground));
            let alike = both * both > OTHER_WORDS * own * product(ground, ground);
            trial.cause != cause && alike && !self.cause(trial).impossible(trial.terms[0], level * both / own)
        };
        singles().filter(same).map(|trial| trial.cause).collect()
    }

    /// Names a map of the ground beside a pull that sets in and ends, where it may as well be one patch of it: a map is dear, since
    /// it may take any course, and what a window costs less for says nothing of which of the two was there.
    pub fn named_patch(&self, best: &Stand, accepted: &mut [Accepted]) {
        let Some(cause) = self.case.causes.iter().position(Cause::is_patch) else { return };
        let named = |one: &Accepted| self.case.causes[one.trial.cause].form == Form::OverPosition;
        if accepted.iter().any(named) {
            return;
        }
        for one in accepted.iter_mut() {
            let own = self.cause(&one.trial);
            let Some(window) = own.window_s(&one.trial.shape).filter(|_| own.id == PULL) else { continue };
            if in_one_place(self.case, None, window) && !one.rivals.iter().any(|rival| rival.cause == cause) {
                let free = self.free_beside(best);
                one.rivals.push(Rival { cause, gain: one.gain, squared_correlation: 1.0, free });
            }
        }
    }

    /// The free parameters as a set has them.
    pub fn free_beside(&self, stand: &Stand) -> Vec<Beside> {
        let of = |place: usize| Beside {
            change: stand.estimate.beta[place],
            sd: stand.estimate.covariance[(place, place)].sqrt(),
        };
        (0..self.case.study.parameters.len()).map(of).collect()
    }

    /// Other sets that are as good: what they hold otherwise stands beside the cause that it is most like.
    pub fn sets_as_good(&self, found: &mut Found, others: &[Stand]) {
        let best = worth(&found.stand);
        let Some(reduced) = self.reduced(&found.stand.noises, &[]) else { return };
        let nuisance: Vec<usize> = (0..self.pool.nuisance).collect();
        for other in others.iter().filter(|other| worth(other) > best - TOLERANCE) {
            for part in &other.parts {
                let id = self.id(&part.trial);
                let named = |one: &Accepted| {
                    let rival = |rival: &Rival| self.case.causes[rival.cause].id == id;
                    self.id(&one.trial) == id || one.rivals.iter().any(rival)
                };
                // Only where the other set does without some of ours is it an alternative, and only what it has more.
                let replaced: Vec<usize> = (0..found.accepted.len())
                    .filter(|place| {
                        let own = self.id(&found.accepted[*place].trial);
                        !other.parts.iter().any(|part| self.id(&part.trial) == own)
                    })
                    .collect();
                if found.accepted.iter().any(named) || replaced.is_empty() {
                    continue;
                }
                let effect = other.effect(self, part);
                let like = |place: &usize| {
                    let own = &found.accepted[*place];
                    // What a function is everywhere says nothing of its course.
                    if own.function.is_some() || part.spread.is_some() {
                        return self.alike(&found.effects[*place], &effect, found);
                    }
                    reduced.squared_correlation(
                        &own.trial.columns,
                        &part.trial.columns,
                        &nuisance,
                        &self.sd(),
                    )
                };
                let likest = replaced.iter().map(|place| (*place, like(place)));
                // What is like none of them explains something else, and a formula that is one of them says it in other words,
                // unless those are fewer.
                let law = self.cause(&part.trial).law.is_some();
                let plainer = self.numbers(&other.parts) < self.numbers(&found.stand.parts);
                let other_words = |correlation: f64| law && !plainer && correlation > OTHER_WORDS;
                let likest = likest
                    .filter(|(_, correlation)| *correlation > UNLIKE && !other_words(*correlation))
                    .max_by(|one, other| one.1.total_cmp(&other.1));
                // A law that does alone what several do together stands beside each of them.
                let whole = law && plainer && replaced.len() > 1 && likest.is_some();
                let beside = if whole {
                    replaced.iter().map(|place| (*place, like(place))).collect()
                } else {
                    likest.into_iter().collect::<Vec<_>>()
                };
                for (place, correlation) in beside {
                    let gain = found.accepted[place].gain + worth(other) - best;
                    let cause = part.trial.cause;
                    found.accepted[place].rivals.push(Rival {
                        cause,
                        gain,
                        squared_correlation: correlation,
                        free: self.free_beside(other),
                    });
                }
            }
        }
    }

    /// Squared correlation of what two causes do to the rows of the fitted runs, each row by the noise of its balance.
    fn alike(&self, one: &Column, other: &Column, found: &Found) -> f64 {
        let size = |rows: &Column| -> f64 {
            let squares = self.system.mean_squares(rows, self.fit);
            let noises = &found.stand.noises.each;
            squares.iter().zip(noises).map(|(square, noise)| square / noise.sd().powi(2)).sum()
        };
        let sum: Column = one.iter().zip(other).map(|(one, other)| one + other).collect();
        let (own, their) = (size(one), size(other));
        let product = 0.5 * (size(&sum) - own - their);
        if own * their > 0.0 { product * product / (own * their) } else { 0.0 }
    }

    /// A function over position that these recordings give to slopes and to soft ground alike: where it rises in places
    /// above a floor it is told as ground, where it goes both ways as slopes. The other stays named beside it.
    pub fn name_by_shape(&self, one: &mut Accepted) {
        /// So many times higher than deep is 'in places'.
        const LOPSIDED: f64 = 2.0;
        let causes: &[Cause] = &self.case.causes;
        let id = causes[one.trial.cause].id;
        let Some(twin) = twin(id) else { return };
        let Some(place) = one.rivals.iter().position(|rival| causes[rival.cause].id == twin) else { return };
        let Some(function) = &one.function else { return };
        let values: Vec<f64> =
            function.values.iter().flat_map(|(values, _)| values.iter().copied()).collect();
        let values = sorted(&values);
        let [low, middle, high] = [0.02, 0.5, 0.98].map(|share| quantile_of_sorted(&values, share));
        let ground = high - middle > LOPSIDED * (middle - low);
        if ground == (id == "soft_ground") {
            return;
        }
        let rival = one.rivals[place].cause;
        if let Some(trial) = self.pool.trials.iter().find(|trial| trial.cause == rival) {
            one.rivals[place].cause = one.trial.cause;
            one.trial = Trial { columns: one.trial.columns.clone(), ..trial.clone() };
        }
    }
}
