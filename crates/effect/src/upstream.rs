//! Where a loss of the driveline lies.

use headland_plugin::{Parameter, parameter};

/// Whether a loss lies before the place where the force at the wheels is told, as between an engine and a hub that measures.
pub(crate) const UPSTREAM: Parameter = parameter(
    "upstream",
    "true or false",
    "whether it is lost before the place where the force at the wheels is told, so that it asks more of what drives; false where \
     left out",
);
