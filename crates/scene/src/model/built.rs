//! What a run built before its first step, counted where it was made: nothing but what its scene names.

use std::ops::Add;

use stationary_measure::{Column, Table};

/// How many of each structure a run built. What a scene does not name is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// Springs, those of nets as well.
    pub springs: u64,
    /// Elements of elastic bodies.
    pub elements: u64,
    /// Pairs of triangles at whose common edge a sheet bends.
    pub hinges: u64,
    /// Rigid bodies with their inertia.
    pub bodies: u64,
    /// Equations of rods and joints.
    pub equations: u64,
    /// Gaps between particles, and between particles and what is fixed.
    pub gaps: u64,
    /// Shapes of bodies and of what is fixed, between which contacts are looked for.
    pub colliders: u64,
    /// Simplices through which heat flows.
    pub heated: u64,
    /// Modes.
    pub modes: u64,
    /// Sparse matrices that are factored, each analysed once.
    pub sparse_solvers: u64,
}

impl Built {
    /// Every structure: the crate whose it is, its name, and how many there are.
    pub fn counts(self) -> [(&'static str, &'static str, u64); 10] {
        [
            ("elasticity", "springs", self.springs),
            ("elasticity", "elements", self.elements),
            ("elasticity", "hinges", self.hinges),
            ("rigid", "bodies", self.bodies),
            ("constraints", "equations", self.equations),
            ("contact", "gaps", self.gaps),
            ("contact", "colliders", self.colliders),
            ("laplacian", "simplices", self.heated),
            ("modal", "modes", self.modes),
            ("calculus", "sparse solvers", self.sparse_solvers),
        ]
    }

    /// A row for each structure of which there is one.
    pub(crate) fn table(self) -> Table {
        let mut table =
            Table::new([Column::exact("crate"), Column::exact("built"), Column::exact("number")]);
        for (owner, what, count) in self.counts() {
            if count > 0 {
                table.push([owner.into(), what.into(), count.into()]);
            }
        }
        table
    }
}

impl Add for Built {
    type Output = Built;

    fn add(self, other: Built) -> Built {
        Built {
            springs: self.springs + other.springs,
            elements: self.elements + other.elements,
            hinges: self.hinges + other.hinges,
            bodies: self.bodies + other.bodies,
            equations: self.equations + other.equations,
            gaps: self.gaps + other.gaps,
            colliders: self.colliders + other.colliders,
            heated: self.heated + other.heated,
            modes: self.modes + other.modes,
            sparse_solvers: self.sparse_solvers + other.sparse_solvers,
        }
    }
}
