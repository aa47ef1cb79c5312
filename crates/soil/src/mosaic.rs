//! A ground that is made of other soils: what every map of soils has in common.

use headland_plugin::{Card, Contact, Footing, Place, Plugin, Refusal, Soil, WheelContact};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};
use std::fmt::Debug;
use std::path::Path;

/// Which soil lies where.
pub(crate) trait Layout: Debug + Send + Sync {
    const CARD: Card;

    fn settle(&mut self, folder: &Path) -> Result<(), Refusal>;

    /// The names of its soils, each with the parameter that says it.
    fn names(&self) -> Vec<(String, &str)>;

    /// Which of the names lies at a place.
    fn which(&self, place: &Place) -> usize;
}

/// Soils, laid out over the map.
#[derive(Debug)]
pub struct Mosaic<L> {
    pub(crate) layout: L,
    soils: Vec<(String, Box<dyn Soil>)>,
    /// Which of the soils each name of the layout is.
    named: Vec<usize>,
}

impl<'de, L: Deserialize<'de>> Deserialize<'de> for Mosaic<L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        L::deserialize(deserializer).map(|layout| Self { layout, soils: Vec::new(), named: Vec::new() })
    }
}

#[allow(private_bounds, reason = "the layouts are those of this crate")]
impl<L: Layout + DeserializeOwned + 'static> Plugin for Mosaic<L> {
    const CARD: Card = L::CARD;

    fn settle(&mut self, folder: &Path) -> Result<(), Refusal> {
        self.layout.settle(folder)
    }
}

#[allow(private_bounds, reason = "the layouts are those of this crate")]
impl<L: Layout> Mosaic<L> {
    fn lying(&self, place: &Place) -> Option<&(String, Box<dyn Soil>)> {
        self.soils.get(*self.named.get(self.layout.which(place))?)
    }

    fn soil(&self, place: &Place) -> Option<&dyn Soil> {
        self.lying(place).map(|(_, soil)| &**soil)
    }
}

#[allow(private_bounds, reason = "the layouts are those of this crate")]
impl<L: Layout> Soil for Mosaic<L> {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        self.resistance_at_n(contact, &Place::default())
    }

    fn resistance_at_n(&self, contact: &Contact, place: &Place) -> f64 {
        self.soil(place).map_or(f64::NAN, |soil| soil.resistance_at_n(contact, place))
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        self.soil(&contact.place)?.wheel(contact)
    }

    fn needs_axles(&self) -> bool {
        self.soils.iter().any(|(_, soil)| soil.needs_axles())
    }

    fn called(&self, place: &Place) -> Option<&str> {
        self.lying(place).map(|(name, _)| name.as_str())
    }

    fn needs_soils(&self) -> bool {
        true
    }

    fn adopt(&mut self, soils: Vec<(String, Box<dyn Soil>)>) -> Result<(), Refusal> {
        let known: Vec<&str> = soils.iter().map(|(name, _)| name.as_str()).collect();
        let index = |(parameter, name): (String, &str)| {
            known.iter().position(|known| *known == name).ok_or_else(|| Refusal {
                parameter,
                found: format!("\"{name}\""),
                expected: format!("one of `ground.soils`: {}", known.join(", ")),
            })
        };
        self.named = self.layout.names().into_iter().map(index).collect::<Result<_, _>>()?;
        if let Some(unused) = (0..known.len()).find(|at| !self.named.contains(at)) {
            return Err(Refusal {
                parameter: "soils".to_owned(),
                found: format!("\"{}\", which lies nowhere", known[unused]),
                expected: "soils that the map or `otherwise` names".to_owned(),
            });
        }
        self.soils = soils;
        Ok(())
    }
}
