//! Elastic bodies, and the body through which heat flows.

use serde::Serialize;

use crate::model::simplices::{Middles, Simplices};
#[cfg(feature = "elasticity")]
use stationary_elasticity::Lame;

/// An elastic body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ElasticBody {
    /// Its name; its vertices are called `name.0`, `name.1` and so on.
    pub name: String,
    /// Its energy density.
    pub material: ElasticMaterial,
    /// Its parameters as a body in space, force per area.
    #[cfg(feature = "elasticity")]
    #[serde(serialize_with = "crate::model::serialized::lame")]
    pub lame: Lame<3>,
    /// The cross-section of a bar, the thickness of a sheet, 1 of a block.
    pub section: f64,
    /// The bending stiffness of a sheet in space, an energy.
    pub bending: Option<f64>,
    /// Its first vertex, by its place in [`Scene::particles`](crate::Scene::particles).
    pub first: usize,
    /// Its vertices at rest.
    pub rest: Vec<[f64; 3]>,
    /// Its simplices, by the places of their vertices in [`Scene::particles`](crate::Scene::particles).
    pub simplices: Simplices,
    /// The nodes of quadratic elements in the middle of edges, by the places of all three in
    /// [`Scene::particles`](crate::Scene::particles), the smaller end first; none of linear ones.
    #[serde(serialize_with = "crate::model::serialized::middles")]
    pub middles: Middles,
}

/// The energy density of an elastic body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum ElasticMaterial {
    /// [`SaintVenantKirchhoff`](stationary_elasticity::SaintVenantKirchhoff).
    SaintVenantKirchhoff,
    /// [`NeoHookean`](stationary_elasticity::NeoHookean).
    NeoHookean,
    /// [`FixedCorotated`](stationary_elasticity::FixedCorotated).
    FixedCorotated,
    /// [`Linear`](stationary_elasticity::Linear): for small displacements alone.
    Linear,
}

/// A body through which heat flows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeatedBody {
    /// Its name; its vertices are called `name.0`, `name.1` and so on.
    pub name: String,
    /// alpha, length squared over time.
    pub diffusivity: f64,
    /// Its simplices.
    pub simplices: Simplices,
    /// The temperature of each vertex at the start.
    pub start: Vec<f64>,
    /// Which vertices keep theirs.
    pub held: Vec<bool>,
}
