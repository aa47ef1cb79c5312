//! Axles, and how they share the load.
//!
//! W_i = k_i (δ₀ + θ x_i),  Σ W_i = W,  Σ W_i x_i = M             two axles: the lever rule, whatever the k_i
//! M = (F_air − m a − m g sin θ) h − D h_D − Σ R_i r_i            moment about the ground below the centre of gravity
//!
//! Source: statics of a rigid body; ASABE D497, clause 3, and Goering, Stone, Smith and Turnquist, *Off-Road Vehicle
//! Engineering Principles* (2003), chapter on weight transfer, for a tractor that pulls. A wheel that resists has its
//! ground reaction ahead of its hub, by R r / W. More than two axles share as springs do, the tyres being the only springs.
//! Air and slope act in the centre of gravity, where what is carried lies too. The torque that spins wheels up is left out.

use headland_plugin::{Refusal, Tyre};

/// An axle with wheels of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axle {
    /// Ahead of the centre of gravity [m].
    pub position_m: f64,
    /// Distance of left and right wheels [m].
    pub track_m: f64,
    /// Number of its wheels: 2, or 4 where they are doubled.
    pub wheels: u32,
    /// What it rolls on.
    pub tyre: Tyre,
    /// Speed of its wheels as a multiple of the driveline's; `None` where it is not driven.
    pub lead: Option<f64>,
}

/// What a vehicle stands on.
#[derive(Clone, Debug, PartialEq)]
pub struct Axles {
    list: Vec<Axle>,
    /// Height of the centre of gravity above the ground [m].
    pub centre_of_gravity_height_m: f64,
    /// Height at which tasks pull [m].
    pub hitch_height_m: f64,
    /// Greatest slip of the driveline's speed that a run may have.
    pub slip_limit: f64,
    /// Part of the weight, and load per moment [1/m], of each axle.
    shares: Vec<(f64, f64)>,
    /// Wheels that go ahead in the same rut, by axle: driving forward, and backward.
    earlier: [Vec<u32>; 2],
}

impl Axles {
    /// Axles in any order; at least two, one of them driven.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter, as `axles.0.lead`.
    pub fn new(
        list: Vec<Axle>,
        centre_of_gravity_height_m: f64,
        hitch_height_m: f64,
        slip_limit: f64,
    ) -> Result<Self, Refusal> {
        check(&list)?;
        let stiffness: Vec<f64> =
            list.iter().map(|axle| f64::from(axle.wheels) * axle.tyre.stiffness_n_per_m()).collect();
        let sum = |power: i32| -> f64 {
            list.iter().zip(&stiffness).map(|(axle, k)| k * axle.position_m.powi(power)).sum()
        };
        let (s0, s1, s2) = (sum(0), sum(1), sum(2));
        let determinant = s0 * s2 - s1 * s1;
        let shares: Vec<(f64, f64)> = list
            .iter()
            .zip(&stiffness)
            .map(|(axle, k)| {
                let x = axle.position_m;
                (k * (s2 - s1 * x) / determinant, k * (s0 * x - s1) / determinant)
            })
            .collect();
        for (index, (share, _)) in shares.iter().enumerate() {
            if *share <= 0.0 {
                return Err(Refusal {
                    parameter: format!("axles.{index}.position_m"),
                    found: list[index].position_m.to_string(),
                    expected: "axles on both sides of the centre of gravity, from which positions count"
                        .to_owned(),
                });
            }
        }
        let earlier =
            [1.0, -1.0].map(|way| list.iter().map(|axle| earlier(&list, axle, way)).collect::<Vec<u32>>());
        Ok(Self { list, centre_of_gravity_height_m, hitch_height_m, slip_limit, shares, earlier })
    }

    /// The axles, as they were given.
    pub fn list(&self) -> &[Axle] {
        &self.list
    }

    /// Load of an axle [N] where the ground carries `weight_n` and the forces turn it forward by `moment_n_m`.
    pub fn load_n(&self, index: usize, weight_n: f64, moment_n_m: f64) -> f64 {
        let (share, per_moment) = self.shares[index];
        share * weight_n + per_moment * moment_n_m
    }

    /// Wheels that pass before those of an axle in the same rut: those ahead of it, or behind it where the vehicle goes backward.
    pub fn earlier(&self, index: usize, backward: bool) -> u32 {
        self.earlier[usize::from(backward)][index]
    }
}

fn check(list: &[Axle]) -> Result<(), Refusal> {
    let refuse = |parameter: String, found: String, expected: &str| {
        Err(Refusal { parameter, found, expected: expected.to_owned() })
    };
    if list.len() < 2 {
        return refuse("axles".to_owned(), format!("a list of {}", list.len()), "two axles or more");
    }
    for (index, axle) in list.iter().enumerate() {
        if axle.wheels == 0 {
            return refuse(format!("axles.{index}.wheels"), "0".to_owned(), "1 or more");
        }
        if list[..index].iter().any(|other| other.position_m == axle.position_m) {
            let found = format!("{} for the second time", axle.position_m);
            return refuse(format!("axles.{index}.position_m"), found, "a place of its own");
        }
    }
    if list.iter().all(|axle| axle.lead.is_none()) {
        return refuse("axles".to_owned(), "no driven axle".to_owned(), "a `lead` for one axle or more");
    }
    Ok(())
}

/// A wheel runs in the rut of one ahead, the way the vehicle goes, where their middles are less than half a width of the narrower apart.
fn earlier(list: &[Axle], axle: &Axle, way: f64) -> u32 {
    let ahead = list.iter().filter(|other| {
        let apart = 0.5 * (other.track_m - axle.track_m).abs();
        let narrower = other.tyre.width_m.min(axle.tyre.width_m);
        way * other.position_m > way * axle.position_m && apart < 0.5 * narrower
    });
    u32::try_from(ahead.count()).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    pub const TYRE: Tyre = Tyre {
        width_m: 0.9,
        diameter_m: 2.045,
        section_height_m: 0.54,
        inflation_pa: 1.5e5,
        carcass_pa: 0.0,
        stiffness_n_per_m: None,
    };

    fn axle(position_m: f64) -> Axle {
        Axle { position_m, track_m: 2.1, wheels: 2, tyre: TYRE, lead: Some(1.0) }
    }

    fn of(list: Vec<Axle>) -> Result<Axles, Refusal> {
        Axles::new(list, 1.3, 0.8, 0.5)
    }

    /// The lever rule: 100 kN, 1 m behind the front axle of a wheelbase of 4 m: 75 kN there; 20 kNm take 5 kN from it.
    #[test]
    fn two_axles_share_by_the_lever_whatever_their_tyres() {
        let soft = Tyre { stiffness_n_per_m: Some(1e5), ..TYRE };
        let axles = of(vec![axle(1.0), Axle { tyre: soft, ..axle(-3.0) }]).unwrap();
        assert!((axles.load_n(0, 1e5, 0.0) - 75e3).abs() < 1e-8);
        assert!((axles.load_n(1, 1e5, 0.0) - 25e3).abs() < 1e-8);
        assert!((axles.load_n(0, 1e5, -20e3) - 70e3).abs() < 1e-8);
        assert!((axles.load_n(1, 1e5, -20e3) - 30e3).abs() < 1e-8);
    }

    /// Three equal axles at 2, 0 and −2 m share in thirds, and a moment of 8 kNm turns 2 kN from the last to the first.
    #[test]
    fn three_axles_share_as_springs_do() {
        let axles = of(vec![axle(2.0), axle(0.0), axle(-2.0)]).unwrap();
        let loads: Vec<f64> = (0..3).map(|index| axles.load_n(index, 90e3, 8e3)).collect();
        for (load, expected) in loads.iter().zip([32e3, 30e3, 28e3]) {
            assert!((load - expected).abs() < 1e-8, "{loads:?}");
        }
    }

    #[test]
    fn a_wheel_follows_in_the_rut_of_one_ahead_that_runs_in_line() {
        let wide = Axle { track_m: 3.2, ..axle(-3.0) };
        let axles = of(vec![axle(2.0), axle(1.0), wide, axle(-2.0)]).unwrap();
        let passes = |backward| (0..4).map(|index| axles.earlier(index, backward)).collect::<Vec<_>>();
        assert_eq!(passes(false), [0, 1, 0, 2]);
        assert_eq!(passes(true), [2, 1, 0, 0], "backward the last axle is the first");
    }

    #[test]
    fn axles_that_cannot_carry_or_drive_are_refused_by_name() {
        let refused = |list: Vec<Axle>| of(list).unwrap_err().to_string();
        assert!(refused(vec![axle(1.0)]).contains("two axles or more"));
        assert!(
            refused(vec![axle(1.0), axle(1.0)]).contains("`axles.1.position_m` is 1 for the second time")
        );
        assert!(refused(vec![axle(1.0), axle(2.0)]).contains("both sides of the centre of gravity"));
        assert!(refused(vec![axle(1.0), Axle { wheels: 0, ..axle(-2.0) }]).contains("`axles.1.wheels` is 0"));
        let towed = |x: f64| Axle { lead: None, ..axle(x) };
        assert!(refused(vec![towed(1.0), towed(-1.0)]).contains("no driven axle"));
    }
}
