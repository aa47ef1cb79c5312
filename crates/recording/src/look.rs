//! What a log shows about itself.

use crate::Notice;
use headland_trace::Trace;

/// Looks at a whole log before it is cut.
pub(crate) fn at_log(_trace: &Trace, _run: &str, _notices: &mut Vec<Notice>) {}

/// Looks at one run.
pub(crate) fn at_run(_trace: &Trace, _run: &str, _notices: &mut Vec<Notice>) {}
