//! What effects do to the samples, remembered as long as neither the recordings nor what they are driven beside change: regressors
//! are made anew whenever other samples are usable or the rows are as fine as there are, and to drive every run takes longest.

use crate::balances::balance::Kind;
use crate::causes::trial::Shown;
use crate::{Case, DiagnoseError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// So many values are kept, half a gigabyte; beyond them it begins anew.
const MOST_VALUES: usize = 1 << 26;

/// What an effect is by: the balances, how it is written for every run, and the step that it is divided by.
#[derive(PartialEq)]
pub struct Driven {
    pub kinds: Vec<Kind>,
    pub texts: Vec<String>,
    pub step: f64,
}

#[derive(Default)]
struct Kept {
    values: usize,
    shown: Vec<(Driven, Arc<Shown>)>,
}

/// What was driven.
#[derive(Default)]
pub struct Remembered(Mutex<Kept>);

impl Remembered {
    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Forgets everything, where what it was made of is no more.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}

impl Case<'_> {
    /// What was shown by something driven before, or what `drive` makes of it now.
    pub fn remembered(
        &self,
        driven: Driven,
        drive: impl FnOnce(&Driven) -> Result<Shown, DiagnoseError>,
    ) -> Result<Arc<Shown>, DiagnoseError> {
        if let Some((_, known)) = self.remembered.kept().shown.iter().find(|(own, _)| *own == driven) {
            return Ok(Arc::clone(known));
        }
        let shown = Arc::new(drive(&driven)?);
        let values: usize = shown.iter().flat_map(|(_, runs)| runs).map(Vec::len).sum();
        let mut kept = self.remembered.kept();
        if kept.values + values > MOST_VALUES {
            *kept = Kept::default();
        }
        kept.values += values;
        kept.shown.push((driven, Arc::clone(&shown)));
        Ok(shown)
    }
}
