//! A cause that nobody listed: an equation is looked for in what the free parameters leave, and in what the listed causes
//! leave. It is claimed where it makes the recordings more likely than the listed causes do, with all that it cost to
//! find it.

use crate::balances::balance::Kind;
use crate::balances::gram::Column;
use crate::causes::catalogue::{Cause, Form, LawText};
use crate::causes::trial::{Pool, Trial};
use crate::choosing::bend;
use crate::choosing::search::{Found, MOST_CAUSES, TOLERANCE, concluded, worth};
use crate::choosing::state::{Part, Stand, State};
use crate::law::formula::{Sought, laws};
use crate::law::small_laws::outgrown;
use crate::law::sound::{first_sound, goes_as_a_mass, is_hurried, is_level, is_lost, is_map, is_sound};
use crate::law::standing::PATCHES;
use crate::law::window::windows;
use crate::look::MANY_ROWS;
use crate::{Case, DiagnoseError, System};
use headland_symbolic::{Law, Target};

/// A law that brings this share of that is as good as they are.
const DOUBT: f64 = 0.5;
/// A consumer that may take any course is not told by a formula beyond so many rows, nor is one looked for in the place of each cause.
const LONG_ROWS: usize = 8_000;
/// Rounds in which a law of the acceleration is made anew by the one that it makes, and one of slip by that.
const ROUNDS_OF_ITSELF: usize = 3;
/// Where what lasts of the noise is less than this share of that of the sensors, nothing is left that another law could say better.
const WANDERS: f64 = 0.1;
/// What acts on the motion.
const FORCES: [(Kind, Target); 2] = [(Kind::Motion, Target::Force), (Kind::Motion, Target::Share)];
/// What acts between the wheels and the ground.
const SLIPS: [(Kind, Target); 1] = [(Kind::Slip, Target::Share)];
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
    const POWERS: [(Kind, Target); 6] = [
        (Kind::Shaft, Target::Force),
        (Kind::Shaft, Target::Power),
        (Kind::Shaft, Target::Share),
        (Kind::Battery, Target::Power),
        (Kind::Fuel, Target::Share),
        (Kind::Fuel, Target::Power),
    ];
    let (found, of_forces) = among(case, system, pool, found, &FORCES)?;
    let (found, of_slips) = among(case, system, pool, found, &SLIPS)?;
    let (found, of_powers) = among(case, system, pool, found, &POWERS)?;
    let as_good = of_forces.into_iter().chain(of_slips).chain(of_powers);
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
        // A share that fuel alone tells of is one of a force that was measured, and sought in the place of a listed loss of the drive.
        let lost = |part: &Part| case.causes[part.trial.cause].upstream;
        if kind == Kind::Fuel && target == Target::Share && !(forced && found.stand.parts.iter().any(lost)) {
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

/// Sets with a law.
struct Candidates {
    /// By itself, beside what was found, and in place of parts of it.
    sets: Vec<Vec<Part>>,
    /// The same law by other powers, where courses of time were found that may stand beside it.
    powers: Vec<Vec<Part>>,
}

/// The sets to choose from, beside what was found.
fn candidates(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    sought: &Sought,
) -> Result<Candidates, DiagnoseError> {
    let listed = found.stand.parts.clone();
    let (mut candidates, mut powers): (Vec<Vec<Part>>, Vec<Vec<Part>>) = (Vec::new(), Vec::new());
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
        // acceleration that it makes itself knows that better every time, and so does a slip that grows with itself.
        let with = |part: &Part| start.iter().cloned().chain([part.clone()]).collect::<Vec<Part>>();
        for _ in 0..if sought.makes_itself(&law) { ROUNDS_OF_ITSELF } else { 1 } {
            let state = State { case, system, pool, fit: &case.fit };
            if let Some(settled) = state.settle(&with(&part), &found.stand.noises)
                && (rows <= MANY_ROWS || worth(&settled) > worth(&found.stand))
                && let moved = sought.moved_by(case, &law)
                && let Some(better) =
                    first_sound(case, laws(case, system, pool, &start, &settled, &moved)?, &moved)
            {
                law = better;
                part = add(case, system, pool, &law, &moved);
            }
        }
        // A smoother acceleration takes terms more to say what a sudden one says in one.
        if let Some(sudden) = sought.by_forces(case, &law) {
            let told = laws(case, system, pool, &start, &found.stand, &sudden)?;
            if let Some(other) = first_sound(case, told, &sudden) {
                let part = add(case, system, pool, &other, &sudden);
                candidates.push(with(&part));
                candidates.push(vec![part]);
            }
        }
        let takes_its_course = |part: &Part| courses.contains(&case.causes[part.trial.cause].id);
        if !courses.is_empty() && !start.iter().any(takes_its_course) {
            for other in &law.powers {
                if is_sound(case, other, sought) {
                    powers.push(with(&add(case, system, pool, other, sought)));
                }
            }
        }
        candidates.push(with(&part));
        candidates.push(vec![part]);
        for part in windows(case, system, pool, &law)? {
            candidates.push(start.iter().cloned().chain([part]).collect());
        }
    }
    Ok(Candidates { sets: candidates, powers })
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
    let Candidates { sets, powers } = candidates(case, system, pool, &found, sought)?;
    if let Some(other) = with_a_large_loss(case, system, pool, &found, sought.kind) {
        return Ok((other, None));
    }
    let state = State { case, system, pool, fit: &case.fit };
    let alone = found.tried.first().and_then(|round| round.causes.first()).map_or(0.0, |one| one.2);
    let within = |stand: &Stand| {
        stand.parts.len() < MOST_CAUSES && worth(stand) + HARDLY * alone > worth(&found.stand)
    };
    let courses = state.courses(&found, sought.kind);
    let has_a_window = found.stand.parts.iter().any(|part| state.cause(&part.trial).window().is_some());
    let mut lasting: Vec<Stand> = Vec::new();
    let mut best: Option<Stand> = None;
    let mut as_good: Option<Stand> = None;
    let mut smaller: Vec<Stand> = Vec::new();
    let is_sound_set = |stand: &Stand| {
        !state.impossible(&stand.parts, &stand.estimate)
            && state.works_widely(stand, &found.stand)
            && state.sensible(stand)
            && !state.draws_twice(stand)
            && !state.are_levels(stand, sought.kind)
            && state.keeps_to_priors(stand, &found.stand)
            // Beside a course of time that is known by its name none by another is said.
            && (courses.is_empty() || !state.holds_a_course(stand))
    };
    let sets =
        sets.into_iter().map(|parts| (parts, true)).chain(powers.into_iter().map(|parts| (parts, false)));
    for (parts, by_itself) in sets {
        let Some(stand) = state.settle(&parts, &found.stand.noises) else { continue };
        let more =
            if by_itself && within(&stand) { state.with_listed(&stand, &found, &[]) } else { Vec::new() };
        let mut beside = None;
        if !courses.is_empty() {
            if by_itself {
                lasting.extend(state.with_listed(&stand, &found, &courses).into_iter().take(1));
                lasting.push(stand.clone());
            }
            beside = state.beside_courses(&stand, &found.stand, &courses);
        }
        // Where the likeliest leaves a free parameter strained, one that takes the strain off it is what was missing.
        let relieved = match &more[..] {
            [first, others @ ..] if !is_sound_set(first) => {
                others.iter().find(|set| is_sound_set(set)).cloned()
            }
            _ => None,
        };
        for stand in more.into_iter().take(1).chain(relieved).chain(beside).chain([stand]) {
            let simpler = state.simpler(&stand, &found.stand);
            let more = worth(&stand) - worth(&found.stand);
            let margin = state.margin(&found, &stand);
            let clearly = more > margin;
            let sound = is_sound_set(&stand);
            let able = sound
                && (clearly || simpler && more > -TOLERANCE)
                && (simpler || !state.is_listed(&stand, &found.first))
                && (simpler && clearly || !state.paraphrases(&stand, &found.stand));
            // What says it better than the listed causes, and not by enough, is a doubt of them, whatever it is like, but for the edges
            // of a window: how it sets in and ends is no cause of its own.
            let as_short = state.pieces(&stand) <= found.stand.parts.len();
            // So is what says as much in fewer numbers.
            let plainer =
                state.numbers(&stand.parts) < state.numbers(&found.stand.parts) && more > -TOLERANCE;
            let doubtful = sound
                && as_short
                && (plainer || more > DOUBT * margin)
                && !(has_a_window && state.paraphrases(&stand, &found.stand));
            if able && clearly && state.is_better(&stand, best.as_ref()) {
                smaller.extend(best.replace(stand));
            } else if able && clearly {
                smaller.push(stand);
            } else if (able || doubtful) && state.is_better(&stand, as_good.as_ref()) {
                as_good = Some(stand);
            }
        }
    }
    best = best.map(|best| state.without_a_patch(best, &smaller));
    lasting.retain(|stand| is_sound_set(stand));
    let foretells = state.that_foretells(&found, lasting, sought.kind);
    if let Some(concluded) = foretells.and_then(|stand| concluded(&state, stand, &found)) {
        return Ok((concluded, None));
    }
    let best = match best {
        Some(best) if rows <= MANY_ROWS => {
            let best = bend::beside_a_law(case, system, pool, best)?;
            Some(once_more(case, system, pool, best, sought)?)
        }
        best => best,
    };
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

/// A law that was found by itself has what stood in for the listed causes beside it: it is looked for once more beside them.
fn once_more(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    best: Stand,
    sought: &Sought,
) -> Result<Stand, DiagnoseError> {
    let state = State { case, system, pool, fit: &case.fit };
    let listed = state.listed(&best);
    let terms = state.pieces(&best) - listed.len();
    if listed.is_empty() {
        return Ok(best);
    }
    let told = first_sound(case, laws(case, system, pool, &listed, &best, sought)?, sought);
    let Some(law) = told.filter(|law| law.terms <= terms) else { return Ok(best) };
    let part = add(case, system, pool, &law, sought);
    let state = State { case, system, pool, fit: &case.fit };
    let parts: Vec<Part> = listed.into_iter().chain([part]).collect();
    let better = |other: &Stand| state.good(other) > state.good(&best) && state.sensible(other);
    Ok(state.settle(&parts, &best.noises).filter(better).unwrap_or(best))
}

/// What was found with a loss of the electric drive beside it that was free because it is small, and is not: it is free no more, and has to
/// say what the rows show of it.
fn with_a_large_loss(
    case: &mut Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    kind: Kind,
) -> Option<Found> {
    /// What a loss may be that is told by its name, as a share of what is usual.
    const NOTHING: f64 = 1e-3;
    if kind != Kind::Battery || found.stand.parts.len() >= MOST_CAUSES {
        return None;
    }
    let (part, small) = outgrown(case, pool, found)?;
    let usual = pool.sd[small];
    pool.sd[small] = NOTHING * usual;
    let state = State { case, system, pool, fit: &case.fit };
    let told = || {
        let first = state.settle(&[], &found.first.noises)?;
        let before = state.settle(&found.stand.parts, &first.noises)?;
        let base = concluded(&state, before, &Found { first, ..found.clone() })?;
        let parts: Vec<Part> = found.stand.parts.iter().cloned().chain([part]).collect();
        let with = state.settle(&parts, &found.stand.noises)?;
        let sound = !state.impossible(&with.parts, &with.estimate)
            && state.works_widely(&with, &base.stand)
            && state.sensible(&with)
            && state.keeps_to_priors(&with, &found.stand);
        if sound { state.with_a_law(with, &base) } else { None }
    };
    let told = told();
    if told.is_none() {
        pool.sd[small] = usual;
    }
    told
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

/// The regressor of a law.
fn add(case: &mut Case, system: &System, pool: &mut Pool, law: &Law, sought: &Sought) -> Part {
    let Sought { kind, target, .. } = *sought;
    let column = system.column(|own| {
        law.prediction.iter().enumerate().map(|(run, said)| sought.samples(own, run, said)).collect()
    });
    // A force shows in powers by the motion.
    let kind = if target == Target::Force { Kind::Motion } else { kind };
    put(case, pool, Cause::of_law(LawText::new(law, (target, kind), sought.role(case, law)), kind), column)
}

/// A law among the causes, with its regressor.
pub fn put(case: &mut Case, pool: &mut Pool, cause: Cause, rows: Column) -> Part {
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
