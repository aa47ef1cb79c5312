//! Every model that a program knows.

use crate::family::read;
use crate::{Card, Driveline, Effect, Family, Form, Management, Plugin, Soil, Task, Terrain, form_of};

/// The kinds of plugin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Resistance of the ground.
    Soil,
    /// Shape of the ground.
    Terrain,
    /// Engine, motors, gears and stores.
    Driveline,
    /// Sharing of power between two stores.
    Management,
    /// Work.
    Task,
    /// Added physics.
    Effect,
}

impl Kind {
    /// All kinds, in the order in which they are listed.
    pub const ALL: [Self; 6] =
        [Self::Soil, Self::Terrain, Self::Driveline, Self::Management, Self::Task, Self::Effect];

    /// As it is written on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Soil => "soil",
            Self::Terrain => "terrain",
            Self::Driveline => "driveline",
            Self::Management => "management",
            Self::Task => "task",
            Self::Effect => "effect",
        }
    }
}

/// A value that knows models by name; nothing is registered behind its back.
pub struct Registry {
    /// Soil models.
    pub soils: Family<dyn Soil>,
    /// Terrains.
    pub terrains: Family<dyn Terrain>,
    /// Drivelines.
    pub drivelines: Family<dyn Driveline>,
    /// Managements.
    pub managements: Family<dyn Management>,
    /// Tasks.
    pub tasks: Family<dyn Task>,
    /// Effects.
    pub effects: Family<dyn Effect>,
}

impl Default for Registry {
    fn default() -> Self {
        Self::new()
    }
}

impl Registry {
    /// A registry that knows nothing yet.
    pub const fn new() -> Self {
        Self {
            soils: Family::new("soil model"),
            terrains: Family::new("terrain"),
            drivelines: Family::new("driveline"),
            managements: Family::new("management"),
            tasks: Family::new("task"),
            effects: Family::new("effect"),
        }
    }

    /// Registers a soil model.
    pub fn soil<P: Plugin + Soil>(&mut self) {
        self.soils.insert(P::CARD, |text, folder| Ok(Box::new(read::<P>(text, folder)?)), form_of::<P>);
    }

    /// Registers a terrain.
    pub fn terrain<P: Plugin + Terrain>(&mut self) {
        self.terrains.insert(P::CARD, |text, folder| Ok(Box::new(read::<P>(text, folder)?)), form_of::<P>);
    }

    /// Registers a driveline.
    pub fn driveline<P: Plugin + Driveline>(&mut self) {
        self.drivelines.insert(P::CARD, |text, folder| Ok(Box::new(read::<P>(text, folder)?)), form_of::<P>);
    }

    /// Registers a management.
    pub fn management<P: Plugin + Management>(&mut self) {
        self.managements.insert(P::CARD, |text, folder| Ok(Box::new(read::<P>(text, folder)?)), form_of::<P>);
    }

    /// Registers a task.
    pub fn task<P: Plugin + Task>(&mut self) {
        self.tasks.insert(P::CARD, |text, folder| Ok(Box::new(read::<P>(text, folder)?)), form_of::<P>);
    }

    /// Registers an effect.
    pub fn effect<P: Plugin + Effect>(&mut self) {
        self.effects.insert(P::CARD, |text, folder| Ok(Box::new(read::<P>(text, folder)?)), form_of::<P>);
    }

    /// The cards of one kind, in the order in which they were registered.
    pub fn cards(&self, kind: Kind) -> Vec<&Card> {
        fn of<T: ?Sized>(family: &Family<T>) -> Vec<&Card> {
            family.entries().iter().map(|entry| &entry.card).collect()
        }
        match kind {
            Kind::Soil => of(&self.soils),
            Kind::Terrain => of(&self.terrains),
            Kind::Driveline => of(&self.drivelines),
            Kind::Management => of(&self.managements),
            Kind::Task => of(&self.tasks),
            Kind::Effect => of(&self.effects),
        }
    }

    /// The cards of one kind, each with what its parameters look like.
    pub fn forms(&self, kind: Kind) -> Vec<(&Card, Form)> {
        fn of<T: ?Sized>(family: &Family<T>) -> Vec<(&Card, Form)> {
            family.entries().iter().map(|entry| (&entry.card, entry.form())).collect()
        }
        match kind {
            Kind::Soil => of(&self.soils),
            Kind::Terrain => of(&self.terrains),
            Kind::Driveline => of(&self.drivelines),
            Kind::Management => of(&self.managements),
            Kind::Task => of(&self.tasks),
            Kind::Effect => of(&self.effects),
        }
    }
}
