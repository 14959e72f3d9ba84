//! A problem of statics as the trials state it, and its answer.

use stationary_elasticity::{
    DeadLoad, ElasticityError, Elements, Freedoms, Held, Material, Reference, Solid, Statics,
    lumped_mass,
};

/// Where a body came to rest, and what holds it.
pub struct Rest<const D: usize> {
    pub positions: Vec<[f64; D]>,
    pub reactions: Vec<f64>,
}

/// What is solved.
pub struct Problem<'a, const D: usize> {
    pub held: &'a [Held],
    /// Where the held coordinates go.
    pub ends: &'a [f64],
    pub density: f64,
    pub section: f64,
    pub steps: usize,
}

/// Makes a load for given supports.
pub type Loads<'a, const D: usize> =
    &'a dyn Fn(&Freedoms<D>) -> Result<DeadLoad<D>, ElasticityError>;

impl<const D: usize> Problem<'_, D> {
    pub fn solve<F, M, const N: usize, const R: usize, const Q: usize>(
        &self,
        family: F,
        mesh: &impl Elements<D, N>,
        material: M,
        start: &[[f64; D]],
        load: Loads<'_, D>,
    ) -> Result<Rest<D>, ElasticityError>
    where
        F: Reference<N, R, Q> + Copy,
        M: Material<D, R>,
    {
        let freedoms = Freedoms::<D>::new(mesh.count(), self.held)?;
        let metric = lumped_mass(family, mesh, [self.density, self.section], &freedoms)?;
        let load = load(&freedoms)?;
        let mut solid = Solid::new(family, mesh, self.section, material, freedoms.clone())?;
        let mut q = freedoms.gathered(start)?;
        let statics = Statics { steps: self.steps, ..Statics::default() };
        let rest = statics.solve(&mut solid, &load, &metric, self.ends, &mut q)?;
        Ok(Rest { positions: solid.freedoms().positions(&q)?, reactions: rest.reactions })
    }
}

/// The free coordinates, of all of D each vertex.
pub fn free(count: usize, d: usize, held: &[Held]) -> Vec<usize> {
    (0..d * count).filter(|k| !held.iter().any(|h| d * h.vertex + h.component == *k)).collect()
}

pub fn plain<const D: usize>(x: &[[f64; D]]) -> Vec<Vec<f64>> {
    x.iter().map(|x| x.to_vec()).collect()
}

/// Vertices held where they are.
pub fn clamp<const D: usize>(
    vertices: impl IntoIterator<Item = usize>,
    places: &[[f64; D]],
) -> Vec<Held> {
    let all = vertices.into_iter().flat_map(|vertex| {
        (0..D).map(move |component| Held { vertex, component, place: places[vertex][component] })
    });
    all.collect()
}
