//! Problems that are scenes: one definition each for tests, studies and benches.
//!
//! | problem | system | answer |
//! | --- | --- | --- |
//! | [`outer_solar_system`] | the sun and five planets | none in closed form |
//! | [`spring_net`] | a net held at two corners, falling | none: it bounds the step |
//!
//! Both are read from the scenes that ship with the crate, [`OUTER_SOLAR_SYSTEM`] and [`SPRING_NET`].

use crate::assemble::error::AssemblyError;
use crate::assemble::system::SceneProblem;
use crate::model::scene::Scene;
use crate::text::file_error::SceneError;
use crate::text::number::Count;

/// The text of the scene `outer-solar-system.toml`.
pub const OUTER_SOLAR_SYSTEM: &str = include_str!("../scenes/outer-solar-system.toml");

/// The text of the scene `spring-net.toml`.
pub const SPRING_NET: &str = include_str!("../scenes/spring-net.toml");

/// The text of the scene `thrown-racket.toml`, whose system is a body in space.
pub const THROWN_RACKET: &str = include_str!("../scenes/thrown-racket.toml");

/// The text of the scene `heavy-top.toml`, whose system is a body on a ball joint.
pub const HEAVY_TOP: &str = include_str!("../scenes/heavy-top.toml");

/// A scene that ships with the crate and does not make a problem.
#[derive(Debug, thiserror::Error)]
pub enum ProblemError {
    /// Its text is no scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene makes no system.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
}

/// Jupiter's year in days: 2 pi sqrt(a^3 / (G (m_sun + m_jupiter))), a = 5.2025 au.
const JUPITERS_YEAR: f64 = 4332.0;

/// The sun, Jupiter, Saturn, Uranus, Neptune and Pluto over 200,000 days: au, days, solar masses.
/// Its period is Jupiter's year.
///
/// # Errors
/// None: its scene ships with the crate.
pub fn outer_solar_system() -> Result<SceneProblem, ProblemError> {
    let scene = Scene::parse("outer-solar-system.toml", OUTER_SOLAR_SYSTEM)?;
    let problem = scene.problem()?;
    Ok(SceneProblem { name: "outer-solar-system", period: JUPITERS_YEAR, ..problem })
}

/// The net of `spring-net.toml` with other numbers of rows and columns, at least two of each. Its
/// period is one over the bound 8 k/m on the square of its frequencies, rooted.
///
/// # Errors
/// [`ProblemError::Scene`] as of [`spring_net_scene`].
pub fn spring_net(rows: u32, columns: u32) -> Result<SceneProblem, ProblemError> {
    let scene = spring_net_scene(rows, columns)?;
    let problem = scene.problem()?;
    let stiffest = scene.links().iter().map(|link| link.stiffness).fold(0.0, f64::max);
    let lightest = problem.system.metric().masses().iter().copied().fold(f64::INFINITY, f64::min);
    let period = (8.0 * stiffest / lightest).sqrt().recip();
    Ok(SceneProblem { name: "spring-net", period, ..problem })
}

/// The scene of `spring-net.toml` with other numbers of rows and columns, and the usual observables.
/// A larger net is sampled less often, so that its samples take no more memory.
///
/// # Errors
/// [`SceneError::Invalid`] for fewer than two rows or columns, for a net that is too large, and
/// without the feature `elasticity`.
pub fn spring_net_scene(rows: u32, columns: u32) -> Result<Scene, SceneError> {
    Scene::parse_changed("spring-net.toml", SPRING_NET, |declared| {
        declared.observables = None;
        // They are about the net of the file.
        declared.claims.clear();
        let larger = (u64::from(rows) * u64::from(columns)).div_ceil(20 * 20);
        if let Some(every) = &mut declared.sample_every {
            every.get_mut().0 *= larger;
        }
        for net in &mut declared.nets {
            *net.rows.get_mut() = Count(rows.into());
            *net.columns.get_mut() = Count(columns.into());
        }
    })
}
