//! The Rust of the docs' pages, compiled and run: `cargo test -p stationary-tests --doc`.

/// A page a line.
#[cfg(doctest)]
macro_rules! pages {
    ($($page:ident)*) => {
        $(
            #[doc = include_str!(concat!("../docs/src/", stringify!($page), ".md"))]
            mod $page {}
        )*
    };
}

#[cfg(doctest)]
pages! {
    introduction architecture report trials choose errata
    measure calculus mesh integrators constraints rigid contact elasticity modal laplacian scene chart
    stationary
}
