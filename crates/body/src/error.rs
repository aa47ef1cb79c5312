//! Why a body cannot be put on its ground.

use headland_plugin::Refusal;

/// A vehicle that cannot be driven as a rigid body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BodyError {
    /// The model has no axles, and so no wheels.
    #[error("the vehicle has no `axles`: a rigid body needs wheels to stand on")]
    NoAxles,
    /// The model has no soil.
    #[error("the ground has no `soil`: road-load coefficients speak of whole vehicles on level roads")]
    NoSoil,
    /// Mass or inertia of which nothing can move.
    #[error("`{name}` is {found}, expected more than 0")]
    NotPositive {
        /// What it is.
        name: &'static str,
        /// Its value.
        found: f64,
    },
    /// The chassis does not suit its axles.
    #[error(transparent)]
    Chassis(#[from] Refusal),
    /// The path turns, and nothing is known of the ground beside it.
    #[error(
        "the path turns at {position_m:.1} m, and its terrain knows no ground beside it: a rigid body needs a terrain with a \
         surface, or a straight path"
    )]
    NoSurface {
        /// Where along the path [m].
        position_m: f64,
    },
    /// The step would not be stable.
    #[error("`step_s` is {found_s}, expected at most {longest_s:.1e}: {what} too fast for a longer step")]
    Step {
        /// The step that was asked for [s].
        found_s: f64,
        /// The longest that is safe [s].
        longest_s: f64,
        /// What is fast.
        what: &'static str,
    },
    /// A wheel stands beyond the map.
    #[error(
        "{wheel} would start beyond the edge of the map, {east_m:.1} m east and {north_m:.1} m north of its origin"
    )]
    OffTheMap {
        /// Which wheel.
        wheel: String,
        /// Where [m].
        east_m: f64,
        /// Where [m].
        north_m: f64,
    },
    /// A wheel is in the ground.
    #[error(
        "{wheel} would start {depth_m:.2} m below the ground, with {load_kn:.0} kN on it; its tyre gives way by {most_m:.2} m \
         at the most"
    )]
    BelowGround {
        /// Which wheel.
        wheel: String,
        /// How deep [m].
        depth_m: f64,
        /// What it would carry there [kN].
        load_kn: f64,
        /// Height of the tyre's section [m].
        most_m: f64,
    },
    /// There is a trailer, and no task says what it weighs.
    #[error(
        "the vehicle's `body` has a `trailer`, and no task tows one: expected a task with a `carriage`, which says its mass"
    )]
    NothingTowed,
    /// It finds no rest on its wheels.
    #[error(
        "the vehicle finds no rest on its wheels where it is to start: on such ground it would turn over, or its mass and \
         inertia do not belong to its springs"
    )]
    NoRest,
    /// It would start beside its path.
    #[error("`position_m` is {found_m}, expected {from_m:.1} to {to_m:.1}: there the path begins and ends")]
    OffThePath {
        /// Where it was to start [m].
        found_m: f64,
        /// Where the path begins [m].
        from_m: f64,
        /// Where it ends [m].
        to_m: f64,
    },
    /// The axles do not suit a rigid body.
    #[error(transparent)]
    Axles(Refusal),
}
