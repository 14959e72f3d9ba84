//! What does it cost to stretch something? Springs, bars, sheets, membranes and solids.
//!
//! ```text
//! spring     V = 1/2 k (l - L)^2                                                  (3.1-3.3)
//! stretch    eps(s) = s - 1, (s^2 - 1)/2, log s      measures of it, and what changes between them
//! strain     S = 1/2 (F^T F - I),  F = d phi                                      (13.1)
//! material   W = mu tr S^2 + lambda/2 (tr S)^2, and others;  P = dW/dF            (13.2)
//! body       V(q) = sum of elements, sum of points  w W(F)                     (12.1, 13.2, 13.3)
//! mass       M_ab = int rho N_a N_b, or a share for each node                     (12.2, 13.2.1)
//! damping    F = -dD/dv with D >= 0                                               (10.1.1)
//! rest       dV(q) = f                                                            (4.4)
//! ```
//! `l L` lengths, now and at rest (m), `F` how a body is laid out in space, `W` energy density
//! (J/m^3), `P` stress (Pa), `w` volumes, `N` shape functions, `rho` density. The numbers name
//! sections of the notes.
//!
//! ```
//! use stationary_calculus::Potential;
//! use stationary_elasticity::{Freedoms, Lame, LinearTetrahedron, SaintVenantKirchhoff, Solid};
//!
//! // A block of rubber, 1 m x 0.2 m x 0.2 m, stretched by a tenth with its sides held.
//! let block = stationary_mesh::cuboid([1.0, 0.2, 0.2], [5, 1, 1])?;
//! let lame = Lame::<3>::from_young_poisson(1e6, 0.3)?;
//! let freedoms = Freedoms::<3>::free(block.vertices().len())?;
//! let rubber = SaintVenantKirchhoff::new(lame);
//! let solid = Solid::new(LinearTetrahedron, &block, 1.0, rubber, freedoms)?;
//! let q: Vec<f64> = block.vertices().iter().flat_map(|x| [1.1 * x.x, x.y, x.z]).collect();
//! let strain = (1.1 * 1.1 - 1.0) / 2.0;
//! let expected = (0.5 * lame.lambda() + lame.mu()) * strain * strain * 0.04; // J/m^3 times m^3
//! assert!((solid.energy(&q) / expected - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: [`Spring`], nets of them and [`Dampers`] between vertices; measures of stretch; the
//! pair of numbers of an isotropic material; what a [`Material`] is, and six of them; sheets that are
//! free to thin; shape functions;
//! which coordinates move ([`Freedoms`]); the [`Solid`], which sums its elements, in parts on several
//! threads if told to; what it answers to the parameters of its material; bending; mass, loads,
//! damping; statics with supports and reactions; stress at the nodes.
//!
//! The crate gives potentials, forces and metrics; it knows nothing of time.

#![expect(clippy::needless_range_loop, reason = "tensors are written by their indices")]

mod error;
mod spring;
mod net;
mod damper;
mod measure;
mod lame;
mod lanes;
mod tensor;
mod material;
mod saint_venant_kirchhoff;
mod linear;
mod neo_hookean;
mod corotated;
mod orthotropic;
mod automatic;
mod eigen;
mod singular;
mod isotropic;
mod convexified;
mod full_tangent;
mod thin;
mod reference;
mod shape;
mod freedoms;
mod group;
mod lane_hessian;
mod division;
mod solid;
mod pieces;
mod fitted;
mod hinge;
mod mass;
mod boundary;
mod load;
mod strain_rate;
mod rigid_motions;
mod settle;
mod statics;
mod stress;
pub mod problems;

pub use automatic::{AutomaticMaterial, Density};
pub use boundary::{curved_boundary, straight_boundary};
pub use corotated::FixedCorotated;
pub use damper::{Damper, Dampers};
pub use error::{ElasticityError, SpringError};
pub use fitted::Fitted;
pub use freedoms::{Freedoms, Held};
pub use full_tangent::FullTangent;
pub use hinge::{Hinge, hinges};
pub use isotropic::PrincipalTangent;
pub use lame::Lame;
pub use lanes::{Lanes, Real};
pub use linear::{Linear, LinearTangent};
pub use load::DeadLoad;
pub use mass::{galerkin_mass, lumped_mass};
pub use material::{Material, TakesTangent, Tangent};
pub use measure::Measure;
pub use neo_hookean::{NeoHookean, NeoHookeanTangent};
pub use net::{Net, net};
pub use orthotropic::{Orthotropic, OrthotropicNode, OrthotropicTangent, Weave};
pub use reference::{
    LinearSegment, LinearTetrahedron, LinearTriangle, QuadraticSegment, QuadraticTetrahedron,
    QuadraticTriangle, Reference,
};
pub use saint_venant_kirchhoff::{SaintVenantKirchhoff, SaintVenantKirchhoffTangent};
pub use shape::Elements;
pub use solid::Solid;
pub use spring::{Spring, Strain};
pub use statics::{AtRest, Solves, Statics};
pub use strain_rate::{Rayleigh, StrainRate};
pub use stress::{averaged_stress, cauchy};
pub use thin::FreeToThin;
