//! The functions of a set of causes, whether or not some act on the same rows: eliminated from what all rows say, and told.

use crate::balances::gram::{Reduced, Whitened};
use crate::causes::abreast::{self, Abreast, Spreaded, clusters};
use crate::causes::eliminated;
use crate::causes::profile::{Function, Profile, Spread, Widths};
use crate::choosing::state::State;
use nalgebra::DVector;

/// The functions of a set, part by part.
pub type Profiles<'a> = [Option<(Profile<'a>, Spread)>];

/// What rows say of the columns of a set and of its functions, at a noise: good for all spreads of the same knots.
pub struct Gathered {
    /// Of the columns alone.
    columns: Reduced,
    clusters: Vec<(Vec<usize>, Cluster)>,
    parts: usize,
}

/// A function that shares no rows with others, or several that share some.
enum Cluster {
    Lone(eliminated::Gathered),
    Several(abreast::Gathered),
}

/// The same with what was known of the functions before.
pub struct Solved {
    /// Products of the columns, the functions eliminated.
    pub reduced: Reduced,
    clusters: Vec<(Vec<usize>, SolvedCluster)>,
    parts: usize,
}

enum SolvedCluster {
    Lone(eliminated::Solved),
    Several(abreast::Solved),
}

/// The functions of a cluster.
fn members<'p, 'a>(profiles: &'p Profiles<'a>, cluster: &[usize]) -> Vec<Spreaded<'p, 'a>> {
    let of = |place: &usize| profiles[*place].as_ref().map(|(profile, spread)| (profile, spread));
    cluster.iter().filter_map(of).collect()
}

impl State<'_> {
    /// Products over the runs that are `fit`; none where there are too many functions to tell apart.
    pub fn gathered(&self, whitened: &Whitened, profiles: &Profiles, fit: &[bool]) -> Option<Gathered> {
        let chunks = &self.system.chunks;
        let of_cluster = |cluster: Vec<usize>| {
            let gathered = match members(profiles, &cluster)[..] {
                [(profile, spread)] => Cluster::Lone(profile.gathered(whitened, chunks, fit, spread)),
                ref several => Cluster::Several(Abreast::of(several)?.gathered(whitened, chunks, fit)),
            };
            Some((cluster, gathered))
        };
        Some(Gathered {
            columns: whitened.reduced(chunks, fit),
            clusters: clusters(profiles).into_iter().map(of_cluster).collect::<Option<_>>()?,
            parts: profiles.len(),
        })
    }

    /// Products over the runs that are `fit`, without the functions.
    pub fn without_functions(
        &self,
        whitened: &Whitened,
        profiles: &Profiles,
        fit: &[bool],
    ) -> Option<Reduced> {
        Some(self.gathered(whitened, profiles, fit)?.solved(profiles)?.reduced)
    }
}

impl Gathered {
    /// With the priors of the functions; none where what is left of one is not positive definite.
    pub fn solved(&self, profiles: &Profiles) -> Option<Solved> {
        let mut reduced = self.columns.clone();
        let mut of_cluster = |(cluster, gathered): &(Vec<usize>, Cluster)| {
            let spreads: Vec<&Spread> = members(profiles, cluster).into_iter().map(|one| one.1).collect();
            let solved = match gathered {
                Cluster::Lone(lone) => SolvedCluster::Lone(lone.solved(spreads[0])?),
                Cluster::Several(several) => SolvedCluster::Several(several.solved(&spreads)?),
            };
            match &solved {
                SolvedCluster::Lone(lone) => lone.take(&mut reduced),
                SolvedCluster::Several(several) => several.take(&mut reduced),
            }
            Some((cluster.clone(), solved))
        };
        let clusters = self.clusters.iter().map(&mut of_cluster).collect::<Option<_>>()?;
        Some(Solved { reduced, clusters, parts: self.parts })
    }
}

impl Solved {
    /// The functions, part by part, once all columns have the values `beta`.
    pub fn functions(&self, beta: &DVector<f64>, widths: Widths) -> Vec<Option<Function>> {
        let mut all: Vec<Option<Function>> = vec![None; self.parts];
        for (cluster, solved) in &self.clusters {
            let made = match solved {
                SolvedCluster::Lone(lone) => vec![lone.function(beta, widths)],
                SolvedCluster::Several(several) => several.functions(beta, widths),
            };
            for (place, function) in cluster.iter().zip(made) {
                all[*place] = Some(function);
            }
        }
        all
    }
}
