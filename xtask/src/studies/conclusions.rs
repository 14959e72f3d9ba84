//! What each crate's studies show, in a sentence, and which of them show it.

/// A crate in a sentence.
#[derive(Clone, Copy, Debug)]
pub struct Conclusion {
    /// The crate.
    pub krate: &'static str,
    /// What its studies show. No figures: those are measured, and stand in the studies.
    pub sentence: &'static str,
    /// The studies that show it; it holds where all of their claims do.
    pub shown_by: &'static [&'static str],
}

/// One a crate, in the order of the page.
pub const CONCLUSIONS: &[Conclusion] = &[
    Conclusion {
        krate: "calculus",
        sentence: "Finite differences find a derivative that is wrong in one entry; Newton's method \
                   does not, and only takes more iterations.",
        shown_by: &["derivative-check", "newton-wrong-derivatives"],
    },
    Conclusion {
        krate: "integrators",
        sentence: "Symplectic steps keep the energy for as long as one looks. Many digits of an orbit \
                   are cheapest with adaptive methods of high order, stiff equations need implicit \
                   ones, and steps longer than a fast oscillation must keep off its resonances.",
        shown_by: &[
            "kepler-long-run",
            "orbits-work-precision",
            "stiff-work-precision",
            "multiscale-stability",
        ],
    },
    Conclusion {
        krate: "constraints",
        sentence: "Multipliers keep a rod to rounding; penalties trade its length against the step, \
                   and gains on accelerations have a stability limit of their own.",
        shown_by: &["pendulum-four-ways", "penalty-stability", "acceleration-drift"],
    },
    Conclusion {
        krate: "rigid",
        sentence: "Steps that turn orientation and momentum together keep angular momentum to \
                   rounding and energy within a bound; Munthe-Kaas is cheaper for short runs.",
        shown_by: &["tumbling-box-long-run", "tumbling-box-work-precision"],
    },
    Conclusion {
        krate: "contact",
        sentence: "With times of impact nothing tunnels, projection solves simultaneous impacts to \
                   rounding, and stones stand or slide where statics puts the border.",
        shown_by: &["tunnelling", "pile-solvers", "friction-threshold", "masonry-arch"],
    },
    Conclusion {
        krate: "elasticity",
        sentence: "Quadratic elements need far fewer freedoms than linear ones and hardly lock; narrow \
                   triangles spoil the condition alone, flat ones the answer too.",
        shown_by: &["cantilever-work", "locking", "slivers"],
    },
    Conclusion {
        krate: "modal",
        sentence: "A few modes answer a small motion within a bound that is known beforehand; the \
                   error grows with the square of the amplitude, and a load at a point needs many.",
        shown_by: &["reduced-beam", "modes-large-motion", "modes-needed"],
    },
    Conclusion {
        krate: "laplacian",
        sentence: "Implicit heat with lumped mass on Delaunay edges never falls below the coldest, \
                   explicit heat is stable up to the predicted step, and distances state their error.",
        shown_by: &["maximum-principle", "heat-border", "geodesic-distance"],
    },
    Conclusion {
        krate: "scene",
        sentence: "The method chosen for a scene costs little more than the cheapest that an \
                   exhaustive search finds, and is as accurate as was asked.",
        shown_by: &["choosing", "choosing-unseen"],
    },
    Conclusion {
        krate: "trials",
        sentence: "On random cases every crate keeps its promises or refuses with a typed error.",
        shown_by: &["trials"],
    },
];
