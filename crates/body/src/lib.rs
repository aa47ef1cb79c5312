//! The rigid-body fidelity: a chassis on wheels over a surface, integrated by rapier.
