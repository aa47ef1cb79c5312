//! A cause that nobody listed: an equation is looked for in what the free parameters leave, and in what the listed causes
//! leave. It is claimed where it makes the recordings more likely than the listed causes do, with all that it cost to
//! find it.

use crate::balance::Kind;
use crate::catalogue::{Cause, Form, LawText};
use crate::formula::{Sought, laws};
use crate::gram::Column;
use crate::look::MANY_ROWS;
use crate::losses::SPEED_SQUARED;
use crate::search::{Found, MOST_CAUSES, OTHER_WORDS, TOLERANCE, concluded, worth};
use crate::state::{Part, Stand, State};
use crate::trial::{Pool, Trial, add_trial};
use crate::{Case, DiagnoseError, System};
use headland_calibrate::statistics::median;
use headland_symbolic::{Law, Target};

/// A law has to be worth so much more than the listed causes: odds of four hundred to one.
const MARGIN: f64 = 6.0;
/// And by this share of what the listed causes bring, for each that they are fewer than three: the shape of a listed cause
/// is known from elsewhere, and a formula that is free to bend follows a recording closer than any law of physics.
const BETTER: f64 = 0.1;
/// By this share where it needs fewer causes than they do, and functions are among those: two that patch each other are no
/// knowledge.
const SIMPLER: f64 = 0.03;
/// And by no share where numbers alone patch each other: one term that says more than two of them would not, were they true.
const PLAINER: f64 = 4.5;
/// A law that brings this share of that is as good as they are.
const DOUBT: f64 = 0.5;
/// A law works in at least this share of the rows, by the participation ratio of its squares,
const EVERYWHERE: f64 = 0.04;
/// or in this one where it brings so much more than the listed causes: bends and starts are short.
const NOW_AND_THEN: f64 = 0.01;
/// Growth of ln p that the best of all formulas has by no chance.
const BEYOND_CHANCE: f64 = 100.0;
/// And in so many runs, by that of the runs' sums.
const SHARED: f64 = 1.2;
/// A consumer that may take any course is not told by a formula beyond so many rows, nor is one looked for in the place of each cause.
const LONG_ROWS: usize = 8_000;
/// Rounds in which a law of the acceleration is made anew by the one that it makes.
const ROUNDS_OF_ITSELF: usize = 3;
/// Where what lasts of the noise is less than this share of that of the sensors, nothing is left that another law could say better.
const WANDERS: f64 = 0.1;
/// What acts on the motion.
const FORCES: [(Kind, Target); 2] = [(Kind::Motion, Target::Force), (Kind::Motion, Target::Share)];
/// Causes that a law of so many terms less takes the place of.
const PATCHES: usize = 2;
/// Causes that hide each other bring beside one another up to so many times what the best of them brings alone.
const HARDLY: f64 = 3.0;

/// What was found, laws among it, and the set with a law that would have been as good, where the listed causes stayed.
pub type Told = (Found, Option<Stand>);

/// Looks for a law, and puts it in the place of what was found or beside it.
pub fn unlisted(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    found: Found,
) -> Result<Told, DiagnoseError> {
    /// Where power is drawn, and lost upstream of a measured force; what pulls where no force was measured.
    const POWERS: [(Kind, Target); 5] = [
        (Kind::Shaft, Target::Force),
        (Kind::Shaft, Target::Power),
        (Kind::Shaft, Target::Share),
        (Kind::Battery, Target::Power),
        (Kind::Fuel, Target::Power),
    ];
    let (found, of_forces) = among(case, system, pool, found, &FORCES)?;
    let (found, of_powers) = among(case, system, pool, found, &POWERS)?;
    let as_good = of_forces.into_iter().chain(of_powers);
    Ok((found, as_good.max_by(|one, other| worth(one).total_cmp(&worth(other)))))
}

/// The same for what acts on the motion alone.
pub fn of_motion(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    found: Found,
) -> Result<Found, DiagnoseError> {
    Ok(among(case, system, pool, found, &FORCES)?.0)
}

fn among(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    found: Found,
    sought: &[(Kind, Target)],
) -> Result<Told, DiagnoseError> {
    let mut as_good: Option<Stand> = None;
    if !case.wanted("unlisted") {
        return Ok((found, as_good));
    }
    let forced = case.runs.iter().any(|run| run.measured.trace.get("tractive_force_n").is_some());
    let mut found = found;
    for (kind, target) in sought.iter().copied() {
        // Where no force at the wheels was measured the shaft lacks a force as likely as a consumer, and a formula of watts
        // would draw the course of a pull, but in the place of a consumer's.
        let pulled = found.stand.parts.iter().any(|part| {
            let cause = &case.causes[part.trial.cause];
            let consumes = target != Target::Force && cause.balances.iter().all(|kind| kind.is_power());
            cause.by_run || !consumes && (cause.form == Form::OverTime || part.spread.is_some())
        });
        if kind == Kind::Shaft && if forced { target == Target::Force } else { pulled } {
            continue;
        }
        // A consumer that is switched with time may take any course: where that is long, no law says more.
        let any = found.stand.parts.iter().any(|part| {
            let cause = &case.causes[part.trial.cause];
            kind != Kind::Motion && cause.form == Form::OverTime && cause.balances.contains(&kind)
        });
        let any = any && system.row_count_of(kind) > LONG_ROWS;
        // What a formula says of the shaft it says of the fuel.
        let said_already = kind == Kind::Fuel && system.has(Kind::Shaft);
        if system.has(kind)
            && !said_already
            && !any
            && let Some(sought) = Sought::new(case, system, kind, target)?
        {
            case.step("unlisted causes")?;
            let other;
            (found, other) = beside(case, system, pool, found, &sought)?;
            as_good = other.or(as_good);
        }
    }
    Ok((found, as_good))
}

/// Sets with a law: by itself, beside what was found, and in place of parts of it.
fn candidates(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    sought: &Sought,
) -> Result<Vec<Vec<Part>>, DiagnoseError> {
    let listed = found.stand.parts.clone();
    let mut candidates: Vec<Vec<Part>> = Vec::new();
    // Of many rows a formula takes long to find, and where functions are needed none does by itself.
    let functions = listed.iter().any(|part| part.spread.is_some());
    let rows = system.row_count_of(sought.kind);
    let mut starts = if functions && rows > MANY_ROWS { Vec::new() } else { vec![Vec::new()] };
    // What patches one law beside maps would hide it, and the maps stay.
    let maps: Vec<Part> = listed.iter().filter(|part| part.spread.is_some()).cloned().collect();
    let patched = listed.len() >= maps.len() + PATCHES;
    if patched && !maps.is_empty() && rows <= MANY_ROWS {
        starts.push(maps);
    }
    let wanders = system
        .kinds
        .iter()
        .zip(&found.stand.noises.each)
        .any(|(kind, noise)| *kind == sought.kind && noise.lasting() > WANDERS * noise.sensor);
    if wanders && rows <= LONG_ROWS && sought.target != Target::Share {
        starts.extend(without_each(case, &listed, sought.kind));
    }
    // What two of three say may be one law beside the third.
    if rows <= MANY_ROWS && sought.target != Target::Share {
        let state = State { case, system, pool, fit: &case.fit };
        starts.extend(state.most_telling(found, sought.kind).map(|part| vec![part]));
    }
    // What functions follow may be a law beside all that is known by numbers.
    let numbers: Vec<Part> = listed.iter().filter(|part| part.spread.is_none()).cloned().collect();
    if functions && !numbers.is_empty() && rows <= MANY_ROWS && sought.target != Target::Share {
        starts.push(numbers);
    }
    // What differs from run to run for no reason may do so by what each run was driven in.
    let reasons: Vec<Part> =
        listed.iter().filter(|part| !case.causes[part.trial.cause].by_run).cloned().collect();
    if !reasons.is_empty() && reasons.len() < listed.len() && rows <= MANY_ROWS {
        starts.push(reasons);
    }
    if !listed.is_empty() {
        starts.push(listed);
    }
    let mut starts: Vec<(Vec<Part>, &Sought)> = starts.into_iter().map(|start| (start, sought)).collect();
    // What stands in for courses of time is a formula of neither times nor places.
    let courses = State { case, system, pool, fit: &case.fit }.courses(found, sought.kind);
    let anywhen = (!courses.is_empty() && rows <= MANY_ROWS).then(|| sought.anywhen());
    starts.extend(anywhen.iter().map(|anywhen| (Vec::new(), anywhen)));
    for (start, sought) in starts {
        let told = laws(case, system, pool, &start, &found.stand, sought)?;
        if let Some(law) = told.first().filter(|_| start.is_empty() && rows <= MANY_ROWS) {
            candidates.extend(with_less(case, system, pool, law, sought));
        }
        // Terms more may patch what a good one leaves.
        let sound: Vec<Law> = told.into_iter().filter(|law| is_sound(case, law, sought)).collect();
        let mut sound = sound.into_iter();
        let Some(mut law) = sound.next() else { continue };
        let mut part = add(case, system, pool, &law, sought);
        for simpler in sound.filter(|_| rows <= MANY_ROWS) {
            let part = add(case, system, pool, &simpler, sought);
            let listed = windows(case, system, pool, &simpler)?;
            let with = |part: Part| start.iter().cloned().chain([part]).collect();
            candidates.extend(std::iter::once(part).chain(listed).map(with));
        }
        // Once more with the noise that is left then: what was fitted to the whole mismatch hides slow laws. What hangs on an
        // acceleration that it makes itself knows that better every time.
        let with = |part: &Part| start.iter().cloned().chain([part.clone()]).collect::<Vec<Part>>();
        for _ in 0..if sought.hangs(&law) { ROUNDS_OF_ITSELF } else { 1 } {
            let state = State { case, system, pool, fit: &case.fit };
            if let Some(settled) = state.settle(&with(&part), &found.stand.noises)
                && (rows <= MANY_ROWS || worth(&settled) > worth(&found.stand))
                && let moved = sought.moved_by(case, &law)
                && let Some(better) =
                    first_sound(case, laws(case, system, pool, &start, &settled, &moved)?, &moved)
            {
                law = better;
                part = add(case, system, pool, &law, sought);
            }
        }
        candidates.push(with(&part));
        candidates.push(vec![part]);
        for part in windows(case, system, pool, &law)? {
            candidates.push(start.iter().cloned().chain([part]).collect());
        }
    }
    if sought.kind == Kind::Battery
        && let Some(part) = outgrown(case, pool, found)
    {
        candidates.push(found.stand.parts.iter().cloned().chain([part]).collect());
    }
    Ok(candidates)
}

/// A set without each of its causes in turn that does something to a balance: beside one that is there another may be what a law is
/// taken for, and leaves no law anything to say.
fn without_each(case: &Case, listed: &[Part], kind: Kind) -> Vec<Vec<Part>> {
    /// What so many causes say together no law says beside all but one of them.
    const MOST: usize = 3;
    let able = |part: &&Part| part.spread.is_none() && case.causes[part.trial.cause].law.is_none();
    if !(PATCHES..=MOST).contains(&listed.len()) || !listed.iter().all(|part| able(&part)) {
        return Vec::new();
    }
    let without = |left: usize| {
        let others = listed.iter().enumerate().filter(|(place, _)| *place != left);
        others.map(|(_, part)| part.clone()).collect()
    };
    let works = |place: &usize| kind.among(case.causes[listed[*place].trial.cause].balances);
    (0..listed.len()).filter(works).map(without).collect()
}

fn beside(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    found: Found,
    sought: &Sought,
) -> Result<Told, DiagnoseError> {
    let rows = system.row_count_of(sought.kind);
    let candidates = candidates(case, system, pool, &found, sought)?;
    let state = State { case, system, pool, fit: &case.fit };
    let alone = found.tried.first().and_then(|round| round.causes.first()).map_or(0.0, |one| one.2);
    let within = |stand: &Stand| {
        stand.parts.len() < MOST_CAUSES && worth(stand) + HARDLY * alone > worth(&found.stand)
    };
    let courses = state.courses(&found, sought.kind);
    let mut lasting: Vec<Stand> = Vec::new();
    let mut best: Option<Stand> = None;
    let mut as_good: Option<Stand> = None;
    let listed_of = |state: &State, stand: &Stand| -> Vec<Part> {
        stand.parts.iter().filter(|part| state.cause(&part.trial).law.is_none()).cloned().collect()
    };
    // What is known is likelier from the start than a term of a formula that says as much; beside one that stays it brings no
    // more than it tells.
    let good = |state: &State, stand: &Stand| {
        let terms = state.pieces(stand) - listed_of(state, stand).len();
        worth(stand) - TOLERANCE * terms as f64
    };
    let better = |stand: &Stand, than: &Option<Stand>| {
        than.as_ref().is_none_or(|than| good(&state, stand) > good(&state, than))
    };
    let is_sound_set = |stand: &Stand| {
        !state.impossible(&stand.parts, &stand.estimate)
            && state.works_widely(stand, &found.stand)
            && state.sensible(stand)
            && !state.draws_twice(stand)
            && !state.are_levels(stand, sought.kind)
            && state.keeps_to_priors(stand, &found.stand)
    };
    for parts in candidates {
        let Some(stand) = state.settle(&parts, &found.stand.noises) else { continue };
        let more = if within(&stand) { state.with_listed(&stand, &found, &[]) } else { Vec::new() };
        if !courses.is_empty() {
            lasting.extend(state.with_listed(&stand, &found, &courses).into_iter().take(1));
            lasting.push(stand.clone());
        }
        // Where the likeliest leaves a free parameter strained, one that takes the strain off it is what was missing.
        let relieved = match &more[..] {
            [first, others @ ..] if !is_sound_set(first) => {
                others.iter().find(|set| is_sound_set(set)).cloned()
            }
            _ => None,
        };
        for stand in more.into_iter().take(1).chain(relieved).chain([stand]) {
            let simpler = state.simpler(&stand, &found.stand);
            let more = worth(&stand) - worth(&found.stand);
            let margin = state.margin(&found, &stand);
            let clearly = more > margin;
            let sound = is_sound_set(&stand);
            let able = sound
                && (clearly || simpler && more > -TOLERANCE)
                && (simpler || !state.is_listed(&stand))
                && (simpler && clearly || !state.paraphrases(&stand, &found.stand));
            // What says it better than the listed causes, and not by enough, is a doubt of them, whatever it is like.
            let as_short = state.pieces(&stand) <= found.stand.parts.len();
            // So is what says as much in fewer numbers.
            let plainer =
                state.numbers(&stand.parts) < state.numbers(&found.stand.parts) && more > -TOLERANCE;
            let doubtful = sound && as_short && (plainer || more > DOUBT * margin);
            if able && clearly && better(&stand, &best) {
                best = Some(stand);
            } else if (able || doubtful) && better(&stand, &as_good) {
                as_good = Some(stand);
            }
        }
    }
    lasting.retain(|stand| is_sound_set(stand));
    let foretells = state.that_foretells(&found, lasting, sought.kind);
    if let Some(concluded) = foretells.and_then(|stand| concluded(&state, stand, &found)) {
        return Ok((concluded, None));
    }
    // A law that was found by itself has what stood in for the listed causes beside it: it is looked for once more beside them.
    if let Some(stand) = best.clone() {
        let listed = listed_of(&state, &stand);
        let terms = state.pieces(&stand) - listed.len();
        if !listed.is_empty()
            && rows <= MANY_ROWS
            && let Some(law) = first_sound(case, laws(case, system, pool, &listed, &stand, sought)?, sought)
            && law.terms <= terms
        {
            let part = add(case, system, pool, &law, sought);
            let state = State { case, system, pool, fit: &case.fit };
            let parts: Vec<Part> = listed.into_iter().chain([part]).collect();
            best = state
                .settle(&parts, &stand.noises)
                .filter(|other| good(&state, other) > good(&state, &stand) && state.sensible(other))
                .or(Some(stand));
        }
    }
    let state = State { case, system, pool, fit: &case.fit };
    let mut found = found;
    if let Some(other) = best.and_then(|best| state.with_a_law(best, &found)) {
        return Ok((other, None));
    }
    if let Some(other) = &as_good {
        state.sets_as_good(&mut found, std::slice::from_ref(other));
    }
    Ok((found, as_good))
}

/// The first of some laws, where it is sound.
fn first_sound(case: &Case, laws: Vec<Law>, sought: &Sought) -> Option<Law> {
    laws.into_iter().next().filter(|law| is_sound(case, law, sought))
}

/// Whether a law draws no map, each of its terms is known, none of several is a level nor any a mass, and what is lost on a way is that.
fn is_sound(case: &Case, law: &Law, sought: &Sought) -> bool {
    let level = law.each.len() > 1 && law.each.iter().any(is_level);
    let loose = law.terms > 1 && is_loose(law);
    let mass = goes_as_a_mass(case, law, sought);
    let known = !is_undetermined(law) && !loose && !mass && !is_hurried(law) && !level;
    !is_map(law, sought.target, sought.places()) && known && is_lost(law, sought)
}

/// Whether what is lost on a way is lost, and is not all of it.
fn is_lost(law: &Law, sought: &Sought) -> bool {
    !sought.gains(law) && !sought.answers_itself(law)
}

/// Whether a law draws a map: softer ground and slopes are that by their definition, and so is a consumer that is switched
/// with time, beside something else or in several shapes of one. A wave that goes on all the way is none; places where it is on
/// and others where it is off are patches. Nor is what fades with the way from the start: a tyre or a tank that a run begins with.
/// Where nobody recorded places the place is that way, and where all runs begin at one the way says the place.
fn is_map(law: &Law, target: Target, (placed, from_one_place): (bool, bool)) -> bool {
    const WAVE: &str = "sin";
    const FADES: [&str; 2] = ["exp(-", "/ (1 + "];
    const PULSE: &str = " - level";
    let is_place = |name: &str| name == "x" || from_one_place && name == "way";
    // In a run that goes once along its way places and times both say where it is.
    let only = |term: &[&str]| match target {
        Target::Power => ["x", "t"].iter().any(|name| !term.is_empty() && term.iter().all(|own| own == name)),
        _ => term.iter().any(|own| is_place(own)) && term.iter().all(|own| is_place(own) || *own == "t"),
    };
    let terms = law.variables_of_terms();
    let patches = law.text.contains(PULSE) && terms.iter().any(|term| term.iter().all(|own| *own == "x"));
    let way = if placed { "way" } else { "x" };
    let sizes = [format!("{way} / "), format!("abs({way}) / ")];
    let fades = |text: &str| {
        FADES.iter().any(|fades| sizes.iter().any(|size| text.contains(&format!("{fades}{size}"))))
    };
    let alone = terms.len() == 1 && law.names(WAVE) && !patches;
    !alone && terms.iter().zip(law.texts()).any(|(term, text)| only(term) && !fades(text))
}

/// Whether a shape is as well none of its own: the scale that it bends over may be anything, a straight line or a level among that,
/// which other terms and free parameters take back.
fn is_loose(law: &Law) -> bool {
    let scale = |constant: &headland_symbolic::Constant| {
        ["tanh(", "exp(-", "(1 + "].iter().any(|shape| {
            let mut of = law.text.split(shape).skip(1).filter_map(|rest| rest.split(')').next());
            of.any(|inner| inner.ends_with(&format!("/ {}", constant.name)))
        })
    };
    let loose = |constant: &headland_symbolic::Constant| {
        constant.sd.is_some_and(|sd| constant.value < crate::refine::HALF_95 * sd)
    };
    law.constants.iter().any(|constant| scale(constant) && loose(constant))
}

/// Whether a law of a force hangs on the acceleration as a mass does, or as one does that was told too large.
fn goes_as_a_mass(case: &Case, law: &Law, sought: &Sought) -> bool {
    sought.is_mass(case, law) || sought.hangs(law) && drives_ahead(law)
}

/// Whether a force goes with the acceleration that it makes: beside a mass told too large it takes back what that is too much, and
/// nothing that resists does.
fn drives_ahead(law: &Law) -> bool {
    let amplitudes = || law.constants.iter().filter(|constant| constant.is_amplitude());
    let ahead = |text: &&str| {
        let own = amplitudes().find(|constant| text.starts_with(&format!("{} ", constant.name)));
        own.is_some_and(|own| own.value < 0.0)
    };
    law.texts().iter().filter(|text| text.contains("acceleration")).any(ahead)
}

/// Whether what follows late does so at once, nearly: a speed that is ahead of itself by a moment is an acceleration, which forces make.
fn is_hurried(law: &Law) -> bool {
    /// The shortest time constant that a law may have [s]; the search goes a little below it.
    const SHORTEST_S: f64 = 2.5;
    law.constants.iter().any(|constant| constant.name.starts_with("lag") && constant.value < SHORTEST_S)
}

/// Whether a term is the same nearly always, but for a vehicle that stands now and then: a level has names enough in the library.
fn is_level(term: &Law) -> bool {
    are_alike(term.prediction.iter().flatten())
}

/// Whether values are of one size nearly always.
fn are_alike<'a>(values: impl Iterator<Item = &'a f64>) -> bool {
    /// So far from the median, as a share of it, is the same.
    const ABOUT: f64 = 0.2;
    /// In this share of the samples. What is switched is off for longer.
    const MOST: f64 = 0.85;
    let sizes: Vec<f64> = values.map(|value| value.abs()).collect();
    if sizes.is_empty() {
        return true;
    }
    let middle = median(&sizes);
    let same = sizes.iter().filter(|size| (**size - middle).abs() <= ABOUT * middle).count();
    same as f64 > MOST * sizes.len() as f64
}

/// Whether a term of a law may as well be none: several that take each other back say nothing of any.
fn is_undetermined(law: &Law) -> bool {
    let nothing = |constant: &headland_symbolic::Constant| {
        constant.sd.is_some_and(|sd| constant.value.abs() < crate::refine::HALF_95 * sd)
    };
    law.constants.iter().any(|constant| constant.is_amplitude() && nothing(constant))
}

impl State<'_> {
    /// What a set with a law comes down to, where that says more than what was found. A law that the runs do not teach each other is
    /// none, unless courses of time were found, which they teach no better, and it says far more than those do.
    fn with_a_law(&self, best: Stand, found: &Found) -> Option<Found> {
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
    fn margin(&self, found: &Found, stand: &Stand) -> f64 {
        if self.simpler(stand, &found.stand) && found.stand.parts.iter().all(|part| part.spread.is_none()) {
            return PLAINER;
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
    fn most_telling(&self, found: &Found, kind: Kind) -> Option<Part> {
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
    fn is_elsewhere(&self, part: &Part, set: &Stand, found: &Stand) -> bool {
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
    fn keeps_to_priors(&self, stand: &Stand, other: &Stand) -> bool {
        /// Nothing that is known is so many standard deviations wrong.
        const MOST: f64 = 3.5;
        /// As far as another has it, but for what any two estimates differ by.
        const ABOUT: f64 = 1.15;
        /// What a drift may cost of what a set brings.
        const LITTLE: f64 = 0.05;
        let more = (worth(stand) - worth(other)).max(0.0);
        // The square of a drift counts half in ln p.
        let most = MOST.max((2.0 * LITTLE * more).sqrt());
        let strains = |stand: &Stand| -> Vec<f64> {
            let own =
                (0..self.pool.nuisance).map(|column| stand.estimate.beta[column] / self.pool.sd[column]);
            let mut strains: Vec<f64> = own.collect();
            for (column, strain) in self.stand_ins(stand) {
                strains[column] += strain;
            }
            strains.into_iter().map(f64::abs).collect()
        };
        strains(stand).into_iter().zip(strains(other)).all(|(strain, other)| strain < most.max(ABOUT * other))
    }

    /// Listed causes of a set that do to the rows what a free parameter does, each with the column of that one and by how many of
    /// its standard deviations they move it: more mass is mass, whatever it is called. A law that is another parameter in other
    /// words is no better than that, and is not judged here.
    fn stand_ins(&self, stand: &Stand) -> Vec<(usize, f64)> {
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

    /// Whether a set with a law says in fewer causes what another says. As many as there may be at most are too many: they
    /// patch what none of them is.
    fn simpler(&self, stand: &Stand, other: &Stand) -> bool {
        let (pieces, causes) = (self.pieces(stand), other.parts.len());
        pieces < causes || pieces == causes && causes == MOST_CAUSES && stand.parts.len() < causes
    }

    /// How many causes a set amounts to: every term of a law is one.
    fn pieces(&self, stand: &Stand) -> usize {
        let of = |part: &Part| self.cause(&part.trial).law.as_ref().map_or(1, |law| law.terms);
        stand.parts.iter().map(of).sum()
    }

    /// How many numbers are estimated in a set, beside its functions.
    pub fn numbers(&self, parts: &[Part]) -> usize {
        parts.iter().map(|part| self.cause(&part.trial).numbers()).sum()
    }

    /// Whether the laws of a set are at work in more than a few rows, and in more than one run where there are several.
    fn works_widely(&self, stand: &Stand, listed: &Stand) -> bool {
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
    fn draws_twice(&self, stand: &Stand) -> bool {
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
    fn are_levels(&self, stand: &Stand, kind: Kind) -> bool {
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

    /// Whether a law of a set says the same as a listed cause in other words, which can be what it would have to be then.
    fn is_listed(&self, stand: &Stand) -> bool {
        let Some(reduced) = self.reduced(&stand.noises, &[]) else { return true };
        let nuisance: Vec<usize> = (0..self.pool.nuisance).collect();
        let sd = self.sd();
        let laws = stand.parts.iter().filter(|part| self.cause(&part.trial).law.is_some());
        laws.into_iter().any(|law| {
            let listed = self.pool.trials.iter().filter(|trial| {
                let cause = self.cause(trial);
                cause.law.is_none() && !cause.is_function()
            });
            let same = |trial: &&Trial| {
                reduced.squared_correlation(&law.trial.columns, &trial.columns, &nuisance, &sd) > OTHER_WORDS
            };
            listed.filter(same).any(|trial| self.can_stand_for(law, trial, stand))
        })
    }

    /// Whether a set with a listed cause in the place of a law can be.
    fn can_stand_for(&self, law: &Part, trial: &Trial, stand: &Stand) -> bool {
        let others = stand.parts.iter().filter(|part| part.trial.columns != law.trial.columns);
        let own = Part { trial: trial.clone(), spread: None };
        let parts: Vec<Part> = others.cloned().chain([own]).collect();
        self.settle(&parts, &stand.noises)
            .is_some_and(|other| !self.impossible(&other.parts, &other.estimate))
    }

    /// Whether a law of a set says in other words what one or two listed causes say together.
    fn paraphrases(&self, stand: &Stand, listed: &Stand) -> bool {
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
    fn with_listed(&self, stand: &Stand, found: &Found, but: &[&'static str]) -> Vec<Stand> {
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

/// A law without one of its terms, each in turn, and each term by itself: what was left out may be a listed cause that the
/// formula says in other words.
fn with_less(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    law: &Law,
    sought: &Sought,
) -> Vec<Vec<Part>> {
    let able = |term: &&Law| {
        !is_map(term, sought.target, sought.places())
            && is_lost(term, sought)
            && !is_hurried(term)
            && !is_level(term)
            && !goes_as_a_mass(case, term, sought)
    };
    let able: Vec<&Law> = law.each.iter().filter(able).collect();
    let terms: Vec<Part> = able.into_iter().map(|term| add(case, system, pool, term, sought)).collect();
    let mut all: Vec<Vec<Part>> = terms.iter().map(|term| vec![term.clone()]).collect();
    if terms.len() > 2 {
        all.extend((0..terms.len()).map(|gone| {
            let mut others = terms.clone();
            others.remove(gone);
            others
        }));
    }
    all
}

/// The listed causes that begin and end, at the times at which a law does: a formula finds edges that no grid has.
fn windows(case: &Case, system: &System, pool: &mut Pool, law: &Law) -> Result<Vec<Part>, DiagnoseError> {
    let Some(window) = window_s(law, case.longest_s()) else { return Ok(Vec::new()) };
    let before = pool.trials.len();
    for (number, cause) in case.causes.iter().enumerate() {
        if cause.window().is_some() && cause.own.is_none() && cause.possible(&window) {
            add_trial(case, system, pool, number, &window)?;
        }
    }
    Ok(pool.trials[before..].iter().map(|trial| Part { trial: trial.clone(), spread: None }).collect())
}

/// When a law sets in and ends [s]: at two steps, about the middle of one bump, or where what goes on and off again and again
/// is on only once in runs of this length.
fn window_s(law: &Law, longest_s: f64) -> Option<[f64; 2]> {
    let has = |text: String| law.text.contains(&text);
    let middles: Vec<usize> =
        (0..law.constants.len()).filter(|at| has(format!("(t - {})", law.constants[*at].name))).collect();
    let value = |at: usize| law.constants.get(at).map(|constant| constant.value);
    match middles[..] {
        [middle] if law.terms == 1 && has(" - level".to_owned()) => {
            let (middle_s, period_s, level) = (value(middle)?, value(middle + 1)?, value(middle + 2)?);
            on_once_s(middle_s, period_s, level, longest_s)
        }
        _ if law.names("sin") => None,
        [one, other] => Some([value(one)?.min(value(other)?), value(one)?.max(value(other)?)]),
        [middle] => {
            let (about_s, width) = (value(middle)?, law.constants.get(middle + 1)?);
            let bump = has(format!("((t - {}) / {})^2", law.constants[middle].name, width.name));
            bump.then_some([about_s - width.value, about_s + width.value])
        }
        _ => None,
    }
}

/// When sin(2π (t − t₁) / t₂) is above a level in runs of this length, where that is once.
fn on_once_s(middle_s: f64, period_s: f64, level: f64, longest_s: f64) -> Option<[f64; 2]> {
    if !(-1.0..1.0).contains(&level) || period_s <= 0.0 {
        return None;
    }
    let rises = level.asin() / std::f64::consts::TAU;
    let [from_s, to_s] = [rises, 0.5 - rises].map(|turn| middle_s + turn * period_s);
    let first = (-to_s / period_s).floor() + 1.0;
    let [from_s, to_s] = [from_s, to_s].map(|at_s| at_s + first * period_s);
    (from_s < longest_s && from_s + period_s >= longest_s).then_some([from_s, to_s])
}

/// The regressor of a law.
fn add(case: &mut Case, system: &System, pool: &mut Pool, law: &Law, sought: &Sought) -> Part {
    let Sought { kind, target, .. } = *sought;
    let column = system.column(|own| {
        law.prediction.iter().enumerate().map(|(run, said)| sought.samples(own, run, said)).collect()
    });
    // A force shows in powers by the motion.
    let kind = if target == Target::Force { Kind::Motion } else { kind };
    put(case, pool, Cause::of_law(LawText::new(law, target, kind), kind), column)
}

/// A law among the causes, with its regressor.
fn put(case: &mut Case, pool: &mut Pool, cause: Cause, rows: Column) -> Part {
    let number = case.causes.len();
    case.causes.push(cause);
    let column = pool.columns.len();
    pool.columns.push(rows);
    // Its amplitudes are in it: what is estimated is one, nearly.
    pool.sd.push(1.0);
    let trial = Trial::new(number, &[], vec![column], vec![0]);
    pool.trials.push(trial.clone());
    Part { trial, spread: None }
}

/// A small loss of a drive as a formula.
struct SmallLaw {
    /// The loss.
    small: &'static str,
    text: &'static str,
    /// Constants of the formula: name, unit, value, and to which power it stands in it.
    units: &'static [(&'static str, &'static str, f64, i32)],
    depends_on: &'static [&'static str],
}

/// A speed and a force at which a loss is told.
const V1: (&str, &str, f64, i32) = ("v1_m_s", "m/s", 10.0, 1);
const F1: (&str, &str, f64, i32) = ("f1_n", "N", 1000.0, 1);
const V1_SQUARED: (&str, &str, f64, i32) = (V1.0, V1.1, V1.2, 2);
const F1_SQUARED: (&str, &str, f64, i32) = (F1.0, F1.1, F1.2, 2);
const BOTH: &[&str] = &["tractive_force_n", "speed_m_s"];

/// Those that nothing listed says; a loss in proportion to the power of the drive is one of its efficiency.
const SMALL_LAWS: [SmallLaw; 4] = [
    SmallLaw {
        small: SPEED_SQUARED,
        text: "(v / v1_m_s)^2",
        units: &[V1_SQUARED],
        depends_on: &["speed_m_s"],
    },
    SmallLaw {
        small: "battery_force_squared",
        text: "(F_drive / f1_n)^2",
        units: &[F1_SQUARED],
        depends_on: &["tractive_force_n"],
    },
    SmallLaw {
        small: "battery_power_speed",
        text: "abs(F_drive / f1_n) * (v / v1_m_s)^2",
        units: &[F1, V1_SQUARED],
        depends_on: BOTH,
    },
    SmallLaw {
        small: "battery_power_force",
        text: "(F_drive / f1_n)^2 * abs(v / v1_m_s)",
        units: &[F1_SQUARED, V1],
        depends_on: BOTH,
    },
];

impl SmallLaw {
    /// What a loss of one makes where every ratio is one [W].
    fn watts(&self) -> f64 {
        self.units.iter().map(|(_, _, value, power)| value.powi(*power)).product()
    }

    fn constants_text(&self, power_w: f64) -> String {
        let others = self.units.iter().map(|(name, _, value, _)| format!(", \"{name}\": {value:?}"));
        format!("{{\"a1_w\": {power_w:?}{}}}", others.collect::<String>())
    }
}

/// A loss of an electric drive that is free because it is small, and is not: a consumer of its shape, which no search can
/// find beside it.
fn outgrown(case: &mut Case, pool: &mut Pool, found: &Found) -> Option<Part> {
    /// What is so many times its usual size is not small.
    const MOST: f64 = 4.0;
    let of = |law: &'static SmallLaw| {
        let (_, small) = pool.small.iter().find(|(id, _)| *id == law.small)?;
        let position = found.used.iter().position(|used| used == small)?;
        let value = found.estimate.beta[position];
        let sd = found.estimate.covariance[(position, position)].sqrt();
        (value >= MOST * pool.sd[*small]).then_some((value / pool.sd[*small], law, *small, value, sd))
    };
    let all = SMALL_LAWS.iter().filter_map(of);
    let (_, law, small, value, sd) = all.max_by(|one, other| one.0.total_cmp(&other.0))?;
    let watts = law.watts();
    let constant = |name: &str, unit: &str, value: f64, sd: Option<f64>| headland_symbolic::Constant {
        name: name.to_owned(),
        unit: unit.to_owned(),
        value,
        sd,
    };
    let power_w = value * watts;
    let text = LawText {
        role: "auxiliary_power",
        text: format!("a1_w * {}", law.text),
        constants_text: law.constants_text(power_w),
        constants: std::iter::once(constant("a1_w", "W", power_w, Some(sd * watts)))
            .chain(law.units.iter().map(|(name, unit, value, _)| constant(name, unit, *value, None)))
            .collect(),
        depends_on: law.depends_on.to_vec(),
        terms: 1,
        // It was free from the start, and nothing was chosen.
        cost: 0.0,
    };
    let column = pool.columns[small].iter().map(|rows| rows * value).collect();
    Some(put(case, pool, Cause::of_law(text, Kind::Battery), column))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(text: &str, constants: &[(&str, f64)]) -> Law {
        let constant = |(name, value): &(&str, f64)| headland_symbolic::Constant {
            name: (*name).to_owned(),
            value: *value,
            sd: None,
            unit: "s".to_owned(),
        };
        let constants = constants.iter().map(constant).collect();
        Law { text: text.to_owned(), constants, terms: 1, ..Law::default() }
    }

    #[test]
    fn a_law_sets_in_and_ends_at_its_steps_or_beside_its_bump() {
        let steps = law(
            "a1_n * 0.5 * (1 + tanh((t - t1_s) / t2_s)) + a2_n * 0.5 * (1 + tanh((t - t3_s) / t4_s))",
            &[("a1_n", 5.0), ("t1_s", 29.0), ("t2_s", 0.6), ("a2_n", -5.0), ("t3_s", 13.0), ("t4_s", 0.6)],
        );
        assert_eq!(window_s(&steps, 60.0), Some([13.0, 29.0]));
        let bump = "a1_n * exp(-((t - t1_s) / t2_s)^2)";
        let told = |text: &str, constants: &[(&str, f64)]| window_s(&law(text, constants), 60.0);
        assert_eq!(told(bump, &[("a1_n", 5.0), ("t1_s", 20.0), ("t2_s", 4.0)]), Some([16.0, 24.0]));
        let pulse = "a1_n * 0.5 * (1 + tanh(20 * (sin(6.28 * (t - t1_s) / t2_s) - level1)))";
        let pulsed =
            |t2_s: f64| told(pulse, &[("a1_n", 5.0), ("t1_s", 2.0), ("t2_s", t2_s), ("level1", 0.5)]);
        assert_eq!(pulsed(8.0), None);
        let [from_s, to_s] = pulsed(72.0).expect("it is on once");
        assert!((from_s - 8.0).abs() < 1e-9 && (to_s - 32.0).abs() < 1e-9, "{from_s} to {to_s}");
        assert_eq!(told("a1_n * exp(-t / t1_s)", &[("a1_n", 5.0), ("t1_s", 20.0)]), None);
    }

    #[test]
    fn a_force_that_goes_with_the_acceleration_drives_ahead() {
        let text = "a1_n * exp(-v / v1_m_s) + a2_n * tanh(acceleration / acceleration1_m_s2)";
        let told = |first: f64, second: f64| drives_ahead(&law(text, &[("a1_n", first), ("a2_n", second)]));
        assert!(!told(-500.0, 700.0) && told(500.0, -700.0));
    }

    #[test]
    fn a_scale_that_may_be_anything_bends_nothing() {
        let with_sd = |text: &str, sd: f64| {
            let mut law = law(text, &[("a1_n", 900.0), ("way1_m", 300.0)]);
            law.constants[1].sd = Some(sd);
            law
        };
        for text in [
            "a1_n * (1 - exp(-way / way1_m))",
            "a1_n * tanh(way / way1_m)",
            "a1_n * (1 / (1 + way / way1_m))",
        ] {
            assert!(is_loose(&with_sd(text, 200.0)) && !is_loose(&with_sd(text, 100.0)), "{text}");
        }
        assert!(!is_loose(&with_sd("a1_n * (way / way1_m)", 200.0)));
    }

    #[test]
    fn a_patch_is_a_map_and_what_goes_on_all_the_way_is_none() {
        let told = |text: &str, target: Target| is_map(&law(text, &[]), target, (true, false));
        assert!(told("a1_n * exp(-((x - x1_m) / x2_m)^2)", Target::Force));
        let fades = law("a1_n * (1 - exp(-x / x1_m))", &[]);
        assert!(
            is_map(&fades, Target::Force, (true, false)) && !is_map(&fades, Target::Force, (false, false))
        );
        let beside = law("a1_n * (abs(v) / v1_m_s) + a2_n * exp(-abs(x) / x1_m)", &[]);
        assert!(
            is_map(&beside, Target::Force, (true, false)) && !is_map(&beside, Target::Force, (false, false))
        );
        // From one place the way says the place, but for what fades.
        for (text, map) in [
            ("a1_n * 0.5 * (1 + tanh((way - way1_m) / way2_m))", true),
            ("a1_n * (v / v1_m_s) + a2_n * sin(6.28 * way / way1_m + phase2_rad)", true),
            ("a1_n * (v / v1_m_s) + a2_n * (1 - exp(-way / way1_m))", false),
        ] {
            let law = law(text, &[]);
            assert_eq!(is_map(&law, Target::Force, (true, true)), map, "{text}");
            assert!(!is_map(&law, Target::Force, (true, false)), "{text}");
        }
        assert!(!told("a1_n * sin(6.28 * x / x1_m + phase1_rad)", Target::Force));
        let pulse =
            |of: &str| format!("a1_n * 0.5 * (1 + tanh(20 * (sin(6.28 * ({of} - {of}1) / {of}2) - level1)))");
        assert!(told(&pulse("x"), Target::Force) && !told(&pulse("t"), Target::Force));
        assert!(told("a1_n * (v / v1_m_s) + a2_n * exp(-((x - x1_m) / x2_m)^2)", Target::Force));
        assert!(!told("a1_n * exp(-((t - t1_s) / t2_s)^2)", Target::Force));
        assert!(told("a1_w * exp(-((t - t1_s) / t2_s)^2)", Target::Power));
        assert!(!told("a1_w * (v / v1_m_s)^3", Target::Power));
        // A patch that is switched on when the first run is there.
        let switched = "a1_n * exp(-((x - x1_m) / x2_m)^2) * 0.5 * (1 + tanh((t - t1_s) / t2_s))";
        assert!(told(switched, Target::Force));
    }
}
