//! What stands for a crate that is not compiled, in the shape that the others expect.
//!
//! A file that names what such a crate moves is refused before anything is made of it
//! (`features.rs`): here is nothing to compute, and nobody to ask.

/// Types without values.
pub(crate) mod types {
    use std::fmt;

    use stationary_integrators::Facts;

    macro_rules! without_values {
        ($($name:ident)*) => {$(
            /// Of a crate that is not compiled: there is none.
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub enum $name {}
        )*};
    }

    macro_rules! no_errors {
        ($($name:ident)*) => {$(
            without_values!($name);

            impl fmt::Display for $name {
                fn fmt(&self, _: &mut fmt::Formatter<'_>) -> fmt::Result {
                    match *self {}
                }
            }

            impl std::error::Error for $name {}
        )*};
    }

    without_values!(BodyMethod HeatMethod ImpactLaw Strain When);
    no_errors!(ConstraintError ContactError ElasticityError LaplacianError);
    no_errors!(ModalError RigidError SparseError SpringError);

    /// Of a crate that is not compiled: there is none.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum Lame<const D: usize> {}

    impl BodyMethod {
        /// None.
        pub const ALL: &[BodyMethod] = &[];

        /// Of none.
        pub fn facts(self) -> Facts {
            match self {}
        }
    }

    impl HeatMethod {
        /// None.
        pub const ALL: [HeatMethod; 0] = [];

        /// Of none.
        pub fn name(self) -> &'static str {
            match self {}
        }
    }
}

/// A potential without a value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    freedoms: usize,
}

mod flat {
    use stationary_calculus::{Covector, Potential, Sink};

    impl Potential for super::Flat {
        fn dim(&self) -> usize {
            self.freedoms
        }

        fn energy(&self, _: &[f64]) -> f64 {
            0.0
        }

        fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

        fn add_hessian(&self, _: &[f64], _: &mut impl Sink) {}
    }
}

#[cfg(not(all(feature = "constraints", feature = "rigid")))]
pub(crate) mod joint_steps {
    use stationary_integrators::State;

    use crate::run::error::AssemblyError;
    use crate::run::steps::Steps;

    type Made<'a> = Result<Box<dyn Steps + 'a>, AssemblyError>;

    pub(crate) fn in_space<'a, M, S, J>(
        _: M,
        _: &'a S,
        _: &'a [J],
        _: &State<Vec<f64>>,
    ) -> Made<'a> {
        Err(AssemblyError::NotCompiled("joints"))
    }

    pub(crate) fn in_the_plane<'a, S, J>(_: &'a S, _: &'a [J], _: &State<Vec<f64>>) -> Made<'a> {
        Err(AssemblyError::NotCompiled("joints"))
    }
}

#[cfg(not(feature = "rigid"))]
pub(crate) mod bodies {
    use crate::assemble::scene::Moved;
    use crate::text::diagnostic::Checked;
    use crate::words::declaration::Declaration;
    use crate::words::particles::Roster;

    pub(crate) fn declare(_: &mut Roster, _: usize, _: &Declaration) -> Checked<Moved> {
        Ok(Moved::default())
    }
}

#[cfg(not(feature = "contact"))]
pub(crate) mod contacts {
    use super::Flat;
    use crate::model::built::Built;
    use crate::model::scene::Scene;
    use crate::model::things::SceneContact;
    use crate::model::upper::ContactError;
    use crate::text::diagnostic::Checked;
    use crate::text::fault::Fault;
    use crate::words::declaration::Declaration;

    pub(crate) type Penalty<const D: usize> = Flat;

    pub(crate) fn declare(_: &Declaration, _: usize) -> Checked<Option<SceneContact>> {
        Ok(None)
    }

    impl Scene {
        pub(crate) fn penalty(&self, _: &mut Built) -> Result<Option<Flat>, ContactError> {
            Ok(None)
        }

        pub(crate) fn check_apart(&self) -> Result<(), Fault> {
            Ok(())
        }
    }
}

#[cfg(not(feature = "contact"))]
pub(crate) mod touching {
    use stationary_integrators::State;

    use crate::model::scene::Scene;
    use crate::model::things::SceneContact;
    use crate::run::error::AssemblyError;
    use crate::run::steps::Steps;

    type Made<'a> = Result<Box<dyn Steps + 'a>, AssemblyError>;

    pub(crate) fn in_space<'a, S>(
        _: &Scene,
        contact: &SceneContact,
        _: &'a S,
        _: &State<Vec<f64>>,
    ) -> Made<'a> {
        match contact.law {}
    }

    pub(crate) fn in_the_plane<'a, S>(
        _: &Scene,
        contact: &SceneContact,
        _: &'a S,
        _: &State<Vec<f64>>,
    ) -> Made<'a> {
        match contact.law {}
    }
}

#[cfg(not(feature = "elasticity"))]
pub(crate) mod springs {
    use super::Flat;
    use crate::assemble::system::Vertices;
    use crate::model::built::Built;
    use crate::model::scene::Scene;
    use crate::model::things::Link;
    use crate::run::error::AssemblyError;
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::Fault;
    use crate::words::declaration::SpringDeclaration;
    use crate::words::particles::Roster;

    pub(crate) type Springs<const D: usize> = Flat;

    pub(crate) fn declare(_: &Roster, said: &SpringDeclaration) -> Checked<Link> {
        let fault = Fault::NotCompiled { word: "springs", feature: "elasticity" };
        Err(at(said.between.span(), fault))
    }

    impl Scene {
        pub(crate) fn springs<const D: usize>(
            &self,
            vertices: &Vertices,
            _: &mut Built,
        ) -> Result<Flat, AssemblyError> {
            Ok(Flat { freedoms: D * vertices.free })
        }
    }
}

#[cfg(not(feature = "elasticity"))]
pub(crate) mod nets {
    use crate::model::things::Link;
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::Fault;
    use crate::words::declaration::NetDeclaration;
    use crate::words::particles::Roster;

    pub(crate) fn declare(
        _: &mut Roster,
        _: &mut Vec<Link>,
        _: usize,
        said: &NetDeclaration,
    ) -> Checked<()> {
        let fault = Fault::NotCompiled { word: "nets", feature: "elasticity" };
        Err(at(said.name.span(), fault))
    }
}

#[cfg(not(feature = "elasticity"))]
pub(crate) mod elastic {
    use super::Flat;
    use crate::assemble::system::Vertices;
    use crate::model::built::Built;
    use crate::model::scene::Scene;
    use crate::model::upper::Lame;
    use crate::run::error::AssemblyError;
    use crate::run::fields::Stress;
    use crate::text::fault::Fault;

    pub(crate) type ElasticBodies = Flat;

    pub(crate) fn lame(_: f64, _: f64) -> Result<Lame<3>, Fault> {
        Err(Fault::NotCompiled { word: "solids", feature: "elasticity" })
    }

    impl Flat {
        pub(crate) fn count(self, _: &mut Built) {}

        pub(crate) fn stresses(self, _: &[f64]) -> Vec<Stress> {
            Vec::new()
        }
    }

    impl Scene {
        pub(crate) fn elastic_bodies<const D: usize>(
            &self,
            vertices: &Vertices,
        ) -> Result<ElasticBodies, AssemblyError> {
            Ok(Flat { freedoms: D * vertices.free })
        }
    }
}

#[cfg(not(feature = "elasticity"))]
pub(crate) mod node_shares {
    use crate::text::fault::Fault;
    use crate::words::shape::Shape;

    pub(crate) fn node_shares(_: &Shape) -> Result<Vec<f64>, Fault> {
        Err(Fault::NotCompiled { word: "solids", feature: "elasticity" })
    }
}

#[cfg(not(feature = "modal"))]
pub(crate) mod rest {
    use crate::assemble::system::SceneProblem;
    use crate::model::built::Built;
    use crate::run::error::AssemblyError;

    pub(crate) struct Rest {
        pub(crate) q: Vec<f64>,
        pub(crate) built: Built,
    }

    pub(crate) fn rest<const D: usize>(_: &SceneProblem<D>) -> Result<Rest, AssemblyError> {
        Err(AssemblyError::NotCompiled("hung"))
    }
}

#[cfg(not(any(feature = "constraints", feature = "elasticity", feature = "modal")))]
pub(crate) mod sparse_steps {
    use stationary_integrators::{Drag, Method, Newmark, NewmarkWeights};

    use crate::assemble::system::SceneProblem;
    use crate::run::equal_steps::Equal;
    use crate::run::error::AssemblyError;
    use crate::text::limits;

    pub(crate) fn can_factor(freedoms: usize) -> bool {
        freedoms <= limits::FULL_MATRIX_FREEDOMS
    }

    pub(crate) fn equal<const D: usize>(
        problem: &SceneProblem<D>,
        method: Method,
    ) -> Result<Equal<'_>, AssemblyError> {
        Ok(Equal::without_solver(method.integrator(&problem.system)?))
    }

    pub(crate) fn held_back<const D: usize>(
        problem: &SceneProblem<D>,
        weights: NewmarkWeights,
        drag: Drag<Vec<f64>>,
    ) -> Result<Equal<'_>, AssemblyError> {
        let integrator = Newmark::with_force(&problem.system, weights, drag)?;
        Ok(Equal::without_solver(Box::new(integrator)))
    }
}
