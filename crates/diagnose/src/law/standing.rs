//! Whether a set with a law says more than the listed causes do, and whether it can be.

use crate::balances::balance::Kind;
use crate::causes::catalogue::Form;
use crate::causes::trial::Trial;
use crate::choosing::search::{
    Found, LEAST_GAIN, MOST_CAUSES, OTHER_WORDS, PER_CAUSE, TOLERANCE, concluded, worth,
};
use crate::choosing::state::{Part, Stand, State};
use crate::law::sound::are_alike;

/// A law has to be worth so much more than the listed causes: odds of four hundred to one.
const MARGIN: f64 = 6.0;
/// And by this share of what the listed causes bring, for each that they are fewer than three: the shape of a listed cause
/// is known from elsewhere, and a formula that is free to bend follows a recording closer than any law of physics.
const BETTER: f64 = 0.1;
/// By this share where it needs fewer causes than they do, and functions are among those: two that patch each other are no
/// knowledge.
const SIMPLER: f64 = 0.03;
/// And by no share where numbers alone patch each other, odds of twenty to one are enough: one term that says more than two of them
/// would not, were they true.
const PLAINER: f64 = 3.0;
/// Nothing that is known is so many standard deviations wrong.
const STRAINED: f64 = 3.5;
/// A law works in at least this share of the rows, by the participation ratio of its squares,
const EVERYWHERE: f64 = 0.04;
/// or in this one where it brings so much more than the listed causes: bends and starts are short.
const NOW_AND_THEN: f64 = 0.01;
/// Growth of ln p that the best of all formulas has by no chance.
const BEYOND_CHANCE: f64 = 100.0;
/// And in so many runs, by that of the runs' sums.
const SHARED: f64 = 1.2;
/// Causes that a law of so many terms less takes the place of.
pub const PATCHES: usize = 2;

impl State<'_> {
    /// What a set with a law comes down to, where that says more than what was found. A law that the runs do not teach each other is
    /// none, unless courses of time were found, which they teach no better, and it says far more than those do.
    pub fn with_a_law(&self, best: Stand, found: &Found) -> Option<Found> {
        let is_law = |part: &Part| self.cause(&part.trial).law.is_some();
        let course = |part: &Part| self.timed(part) || self.cause(&part.trial).is_course();
        let courses = !found.stand.parts.is_empty() && found.stand.parts.iter().all(course);
        let beyond = worth(&best) - worth(&found.stand) > BEYOND_CHANCE;
        let told = concluded(self, best.clone(), found);
        let told = told.filter(|told| worth(&told.stand) > worth(&found.stand));
        let taught = told.as_ref().is_some_and(|told| told.stand.parts.iter().any(is_law));
        if taught || !courses || !beyond {
            return told;
        }
        Some(self.found(best, found.first.clone(), (found.tried.clone(), Vec::new()), found.needed))
    }

    /// How much better than what was found a set with a law has to be. What differs from run to run has no shape that would
    /// be known from elsewhere, and three causes that one term says better patch each other.
    pub fn margin(&self, found: &Found, stand: &Stand) -> f64 {
        if self.simpler(stand, &found.stand) && found.stand.parts.iter().all(|part| part.spread.is_none()) {
            return PLAINER;
        }
        // A shape that is known from elsewhere and needs a parameter to be what it cannot be is not the one that is there.
        if self.relieves(stand, &found.stand) {
            return MARGIN;
        }
        // Nor has what is switched with time. And what shows where the law does nothing, as the resistance of a battery does in its
        // voltage, leaves nothing there that a formula could bend to; nor does a map that stays where a law is simpler.
        let simpler = self.simpler(stand, &found.stand);
        let stays = |part: &Part| stand.parts.iter().any(|own| own.trial.columns == part.trial.columns);
        let any = |part: &Part| {
            let cause = self.cause(&part.trial);
            let over_time = cause.form == Form::OverTime;
            let kept = simpler && part.spread.is_some() && stays(part);
            cause.by_run || over_time || kept || self.is_elsewhere(part, stand, &found.stand)
        };
        let (shapeless, shaped): (Vec<Part>, Vec<Part>) = found.stand.parts.iter().cloned().partition(any);
        // Beside all that has a shape a law says why runs and times differ.
        let named = |part: &Part| stand.parts.iter().any(|own| self.id(&own.trial) == self.id(&part.trial));
        let differs = |part: &&Part| {
            let cause = self.cause(&part.trial);
            cause.by_run || cause.form == Form::OverTime
        };
        if shaped.iter().all(named) && shapeless.iter().filter(differs).any(|part| !named(part)) {
            return MARGIN;
        }
        let alone = if shapeless.is_empty() { None } else { self.settle(&shapeless, &found.stand.noises) };
        let brought = worth(&found.stand) - worth(alone.as_ref().unwrap_or(&found.first));
        let shaped = shaped.len();
        let fewer = match (shaped, found.stand.parts.len()) {
            (0, 0) => 0.0,
            (0, _) => 1.0,
            _ if shaped >= self.pieces(stand) + PATCHES => 0.0,
            _ => 3usize.saturating_sub(shaped).max(usize::from(simpler)) as f64,
        };
        let share = if simpler { SIMPLER } else { BETTER };
        MARGIN + share * fewer * brought.max(0.0)
    }

    /// The cause of a set of three or more, all of numbers and two of them of one balance, without which the recordings are least likely.
    pub fn most_telling(&self, found: &Found, kind: Kind) -> Option<Part> {
        let listed = &found.stand.parts;
        let able = |part: &Part| part.spread.is_none() && self.cause(&part.trial).law.is_none();
        let works = |part: &&Part| kind.among(self.cause(&part.trial).balances);
        if listed.len() <= PATCHES
            || !listed.iter().all(able)
            || listed.iter().filter(works).count() < PATCHES
        {
            return None;
        }
        let without = |left: usize| {
            let others = listed.iter().enumerate().filter(|(place, _)| *place != left);
            others.map(|(_, part)| part.clone()).collect::<Vec<_>>()
        };
        let worth_without =
            |place: usize| self.settle(&without(place), &found.stand.noises).map(|one| worth(&one));
        let told = (0..listed.len()).filter_map(|place| Some((worth_without(place)?, place)));
        told.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, place)| listed[place].clone())
    }

    /// Whether a part of what was found does nothing to the balances that the laws of a set do something to.
    pub fn is_elsewhere(&self, part: &Part, set: &Stand, found: &Stand) -> bool {
        /// Mean square over that of the noise.
        const NOTHING: f64 = 1e-3;
        let works = |stand: &Stand, part: &Part| -> Vec<bool> {
            let squares = self.system.mean_squares(&stand.effect(self, part), self.fit);
            let noises = found.noises.each.iter().map(|noise| noise.sd().powi(2));
            squares.into_iter().zip(noises).map(|(square, noise)| square > NOTHING * noise).collect()
        };
        let own = works(found, part);
        let mut laws = set.parts.iter().filter(|part| self.cause(&part.trial).law.is_some());
        laws.all(|law| !works(set, law).into_iter().zip(&own).any(|(law, own)| law && *own))
    }

    /// Whether a set leaves the free parameters where they are known to be, or at least where another has them: a law that
    /// takes the place of what is known says nothing new. One that brings many times what a parameter's drift costs does.
    pub fn keeps_to_priors(&self, stand: &Stand, other: &Stand) -> bool {
        /// As far as another has it, but for what any two estimates differ by.
        const ABOUT: f64 = 1.15;
        /// What a drift may cost of what a set brings.
        const LITTLE: f64 = 0.05;
        let more = (worth(stand) - worth(other)).max(0.0);
        // The square of a drift counts half in ln p.
        let most = STRAINED.max((2.0 * LITTLE * more).sqrt());
        let pairs = self.strains(stand).into_iter().zip(self.strains(other));
        pairs.into_iter().all(|(strain, other)| strain < most.max(ABOUT * other))
    }

    /// How far each free parameter, and each small error that is free, is from where it is known to be, in standard deviations.
    fn strains(&self, stand: &Stand) -> Vec<f64> {
        let own = (0..self.pool.nuisance).map(|column| stand.estimate.beta[column] / self.pool.sd[column]);
        let mut strains: Vec<f64> = own.collect();
        for (column, strain) in self.stand_ins(stand) {
            strains[column] += strain;
        }
        strains.into_iter().map(f64::abs).collect()
    }

    /// Whether a set leaves the free parameters where they are known to be, and another has one of them where it cannot be.
    fn relieves(&self, stand: &Stand, other: &Stand) -> bool {
        /// Share of the strain.
        const MUCH: f64 = 0.5;
        let greatest = |stand: &Stand| {
            self.strains(stand).into_iter().take(self.case.study.parameters.len()).fold(0.0, f64::max)
        };
        let (own, other) = (greatest(stand), greatest(other));
        other > STRAINED && own < STRAINED && own < MUCH * other
    }

    /// Listed causes of a set that do to the rows what a free parameter does, each with the column of that one and by how many of
    /// its standard deviations they move it: more mass is mass, whatever it is called. A law that is another parameter in other
    /// words is no better than that, and is not judged here.
    pub fn stand_ins(&self, stand: &Stand) -> Vec<(usize, f64)> {
        /// Nothing is centred here: an engine that turns at speeds not far from each other loses to a friction nearly what a consumer
        /// takes, and the two are told apart all the same.
        const SAME: f64 = 0.99;
        let single = |part: &&Part| part.spread.is_none() && part.trial.columns.len() == 1;
        let listed = |part: &&Part| self.cause(&part.trial).law.is_none();
        let parts = stand.parts.iter().filter(|part| single(part) && listed(part));
        let Some(reduced) = self.reduced(&stand.noises, &[]) else { return Vec::new() };
        let product = |one: usize, other: usize| reduced.matrix[(one, other)];
        let of = |part: &Part| {
            let own = part.trial.columns[0];
            let alike =
                |free: &usize| product(own, *free).powi(2) > SAME * product(own, own) * product(*free, *free);
            let free = (0..self.case.study.parameters.len()).find(alike)?;
            let moved = stand.value(own) * product(own, free) / product(free, free);
            Some((free, moved / self.pool.sd[free]))
        };
        parts.filter_map(of).collect()
    }

    /// The listed causes of a set.
    pub fn listed(&self, stand: &Stand) -> Vec<Part> {
        stand.parts.iter().filter(|part| self.cause(&part.trial).law.is_none()).cloned().collect()
    }

    /// How good a set with a law is: what is known is likelier from the start than a term of a formula that says as much, and beside one that
    /// stays it brings no more than it tells.
    pub fn good(&self, stand: &Stand) -> f64 {
        let terms = self.pieces(stand) - self.listed(stand).len();
        worth(stand) - TOLERANCE * terms as f64
    }

    /// Whether a set with a law is better than another, where there is one: none whose consumer gives back more than it takes is better than
    /// one whose does not.
    pub fn is_better(&self, stand: &Stand, than: Option<&Stand>) -> bool {
        than.is_none_or(|than| match (self.gives_back(stand), self.gives_back(than)) {
            (gives, other) if gives != other => other,
            _ => self.good(stand) > self.good(than),
        })
    }

    /// A set with a law, or one with fewer listed causes beside the same one, where that is worse by less than the best of many causes
    /// takes to be one: what it had more patches the law. Of what is as good the one of fewer terms is told.
    pub fn without_a_patch(&self, best: Stand, others: &[Stand]) -> Stand {
        let laws = |stand: &Stand| -> Vec<usize> {
            let laws = stand.parts.iter().filter(|part| self.cause(&part.trial).law.is_some());
            laws.flat_map(|part| part.trial.columns.iter().copied()).collect()
        };
        let fewer = |other: &&Stand| {
            let gone = best.parts.len().saturating_sub(other.parts.len());
            gone > 0
                && laws(other) == laws(&best)
                && self.good(other) > self.good(&best) - (LEAST_GAIN + PER_CAUSE) * gone as f64
        };
        let plainer = |other: &&Stand| {
            self.pieces(other) < self.pieces(&best) && self.good(other) > self.good(&best) - TOLERANCE
        };
        let told = others.iter().filter(|other| fewer(other) || plainer(other));
        told.max_by(|one, other| self.good(one).total_cmp(&self.good(other))).cloned().unwrap_or(best)
    }

    /// Whether a set with a law says in fewer causes what another says. As many as there may be at most are too many: they
    /// patch what none of them is.
    pub fn simpler(&self, stand: &Stand, other: &Stand) -> bool {
        let (pieces, causes) = (self.pieces(stand), other.parts.len());
        pieces < causes || pieces == causes && causes == MOST_CAUSES && stand.parts.len() < causes
    }

    /// How many causes a set amounts to: every term of a law is one.
    pub fn pieces(&self, stand: &Stand) -> usize {
        let of = |part: &Part| self.cause(&part.trial).law.as_ref().map_or(1, |law| law.terms);
        stand.parts.iter().map(of).sum()
    }

    /// How many numbers are estimated in a set, beside its functions.
    pub fn numbers(&self, parts: &[Part]) -> usize {
        parts.iter().map(|part| self.cause(&part.trial).numbers()).sum()
    }

    /// Whether the laws of a set are at work in more than a few rows, and in more than one run where there are several.
    pub fn works_widely(&self, stand: &Stand, listed: &Stand) -> bool {
        let beyond = worth(stand) - worth(listed) > BEYOND_CHANCE;
        let least = if beyond { NOW_AND_THEN } else { EVERYWHERE };
        let laws = stand.parts.iter().filter(|part| self.cause(&part.trial).law.is_some());
        laws.into_iter().all(|part| {
            let effect = stand.effect(self, part);
            let (mut squares, mut fourths, mut count) = (0.0, 0.0, 0usize);
            let mut of_runs = vec![0.0; self.fit.len()];
            for (chunk, rows) in self.system.chunks.iter().zip(&effect) {
                let shown = self.system.kind(chunk).among(self.cause(&part.trial).balances);
                if self.fit[chunk.run] && (shown || rows.norm_squared() > 0.0) {
                    squares += rows.norm_squared();
                    of_runs[chunk.run] += rows.norm_squared();
                    fourths += rows.iter().map(|value| value.powi(4)).sum::<f64>();
                    count += rows.len();
                }
            }
            let several = self.fit.iter().filter(|fit| **fit).count() > 2;
            let shared = squares * squares > SHARED * of_runs.iter().map(|own| own * own).sum::<f64>();
            squares * squares > least * count as f64 * fourths && (shared || !several)
        })
    }

    /// Whether a set has a law of places alone beside a map of them: the map holds it as well.
    pub fn draws_twice(&self, stand: &Stand) -> bool {
        let mapped = stand
            .parts
            .iter()
            .any(|part| part.spread.is_some() && self.cause(&part.trial).form == Form::OverPosition);
        let drawn = |part: &Part| {
            let law = self.cause(&part.trial).law.as_ref();
            law.is_some_and(|law| law.depends_on == ["position_m"])
        };
        mapped && stand.parts.iter().any(drawn)
    }

    /// Whether a law of a set is the same nearly always in a balance, and a listed cause of one number in its place says as much but for
    /// a little: what saturates early is a level, unless how it gets there is told.
    pub fn are_levels(&self, stand: &Stand, kind: Kind) -> bool {
        /// Growth of ln p that a level does not bring: the shape of the little that is left has to be plain.
        const PLAINLY: f64 = 20.0;
        let laws = stand.parts.iter().filter(|part| self.cause(&part.trial).law.is_some());
        laws.into_iter().any(|law| {
            let rows = self.system.chunks.iter().zip(&self.pool.columns[law.trial.columns[0]]);
            let own = rows.filter(|(chunk, _)| self.fit[chunk.run] && self.system.kind(chunk) == kind);
            if !are_alike(own.flat_map(|(_, rows)| rows.iter())) {
                return false;
            }
            let others =
                || stand.parts.iter().filter(|part| part.trial.columns != law.trial.columns).cloned();
            let single = |trial: &&Trial| trial.columns.len() == 1 && !self.cause(trial).is_function();
            let listed =
                self.pool.trials.iter().filter(single).filter(|trial| self.cause(trial).law.is_none());
            let instead = |trial: &Trial| {
                let part = Part { trial: trial.clone(), spread: None };
                self.likely(&others().chain([part]).collect::<Vec<_>>(), &stand.noises)
            };
            let own = self.likely(&stand.parts, &stand.noises);
            own.is_none_or(|own| listed.filter_map(instead).any(|other| own - other < PLAINLY))
        })
    }

    /// Whether a law of a set says the same as a listed cause in other words, which can be what it would have to be then. Beside what is far
    /// larger than the noise two shapes are alike that the rows tell apart all the same.
    pub fn is_listed(&self, stand: &Stand, first: &Stand) -> bool {
        let Some(reduced) = self.reduced(&stand.noises, &[]) else { return true };
        let nuisance: Vec<usize> = (0..self.pool.nuisance).collect();
        let sd = self.sd();
        let least = worth(stand) - MARGIN - BETTER * (worth(stand) - worth(first)).max(0.0);
        let laws = stand.parts.iter().filter(|part| self.cause(&part.trial).law.is_some());
        laws.into_iter().any(|law| {
            // What each run has for itself says whatever differs between them, in more numbers than a reason for it.
            let numbers = self.numbers(std::slice::from_ref(law));
            let anything = |trial: &Trial| self.cause(trial).by_run && trial.columns.len() > numbers;
            let listed = self.pool.trials.iter().filter(|trial| {
                let cause = self.cause(trial);
                cause.law.is_none() && !cause.is_function() && !anything(trial)
            });
            let same = |trial: &&Trial| {
                reduced.squared_correlation(&law.trial.columns, &trial.columns, &nuisance, &sd) > OTHER_WORDS
            };
            listed.filter(same).any(|trial| self.can_stand_for(law, trial, stand, least))
        })
    }

    /// Whether a set with a listed cause in the place of a law can be, and makes the recordings as likely as it has to at least.
    fn can_stand_for(&self, law: &Part, trial: &Trial, stand: &Stand, least: f64) -> bool {
        let others = stand.parts.iter().filter(|part| part.trial.columns != law.trial.columns);
        let own = Part { trial: trial.clone(), spread: None };
        let parts: Vec<Part> = others.cloned().chain([own]).collect();
        self.settle(&parts, &stand.noises)
            .is_some_and(|other| worth(&other) > least && !self.impossible(&other.parts, &other.estimate))
    }

    /// Whether a law of a set says in other words what one or two listed causes say together.
    pub fn paraphrases(&self, stand: &Stand, listed: &Stand) -> bool {
        /// A law of which they leave no more than this is theirs.
        const THEIRS: f64 = 0.995;
        /// More of them patch what none of them is.
        const FEW: usize = 2;
        let own = |part: &&Part| self.cause(&part.trial).law.is_none();
        let few = listed.parts.len() <= FEW && listed.parts.iter().all(|part| part.spread.is_none());
        let columns: Vec<usize> =
            listed.parts.iter().filter(own).flat_map(|part| part.trial.columns.iter().copied()).collect();
        if !few || columns.is_empty() {
            return false;
        }
        let Some(reduced) = self.reduced(&stand.noises, &[]) else { return true };
        let nuisance: Vec<usize> = (0..self.pool.nuisance).collect();
        let sd = self.sd();
        let laws = stand.parts.iter().filter(|part| self.cause(&part.trial).law.is_some());
        laws.into_iter()
            .any(|law| reduced.squared_correlation(&law.trial.columns, &columns, &nuisance, &sd) > THEIRS)
    }

    /// A set with a listed cause beside, the likeliest first, but for some; faults of sensors were looked for before. Of a wind of
    /// each run the columns are those of a breath, unless it was found: what goes with speed takes it for a strong one.
    pub fn with_listed(&self, stand: &Stand, found: &Found, but: &[&'static str]) -> Vec<Stand> {
        let Some(reduced) = self.reduced(&stand.noises, &stand.parts) else { return Vec::new() };
        let faults = self.case.causes.iter().filter(|cause| cause.form == Form::Measured);
        let banned: Vec<&str> = faults.map(|cause| cause.id).chain(but.iter().copied()).collect();
        let known = |part: &Part| found.stand.parts.iter().any(|own| own.trial.columns == part.trial.columns);
        let told = |stand: &Stand| {
            let part = stand.parts.last();
            part.is_some_and(|part| !self.cause(&part.trial).blows_by_run() || known(part))
        };
        self.contest(stand, &reduced, &banned).into_iter().map(|one| one.stand).filter(told).collect()
    }
}
