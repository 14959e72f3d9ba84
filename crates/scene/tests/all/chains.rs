//! Chains: what their links are, and which cannot be.

use stationary_scene::{Fault, Scene, SceneError};

fn scene(chain: &str) -> Result<Scene, SceneError> {
    let text = format!(
        "dimension = 2\nintegrator = \"rattle\"\nstep = 0.001\nhorizon = 0.1\n\
         uniform_gravity = {{ acceleration = [0, -9.81] }}\nparticles = [\n\
         {{ name = \"hook\", position = [0, 0], pinned = true }},\n\
         {{ name = \"bob\", position = [3, 4], mass = 2, velocity = [-0.8, 0.6] }},\n]\n\
         chains = [{{ name = \"chain\", {chain} }}]\n"
    );
    Scene::parse("a.toml", &text)
}

#[test]
fn the_links_of_a_chain_are_alike_and_stay_as_long_as_they_are() {
    let scene = scene("between = [\"hook\", \"bob\"], links = 10, particle_mass = 0.1").unwrap();
    assert_eq!((scene.particles().len(), scene.rods().len()), (11, 10));
    assert_eq!(scene.particles()[2].name, "chain.1");
    let run = scene.run().unwrap();
    let last = run.times().len() - 1;
    for rod in scene.rods() {
        assert!((rod.length - 0.5).abs() < 1e-14, "{}", rod.length);
        let [x, y] = rod.ends.map(|end| &run.positions(last)[2 * end..][..2]);
        let length = (y[0] - x[0]).hypot(y[1] - x[1]);
        assert!((length / rod.length - 1.0).abs() < 1e-9, "{length}");
    }
}

#[test]
fn a_chain_that_cannot_be_is_refused() {
    let fault = |chain: &str| match scene(chain) {
        Err(SceneError::Invalid(error)) => error.fault,
        other => panic!("{chain}: {other:?}"),
    };
    let chain = |ends: &str, links: u64| {
        fault(&format!("between = [{ends}], links = {links}, particle_mass = 0.1"))
    };
    let none = Fault::NotPositive { what: "`links`", value: 0.0 };
    assert_eq!(chain("\"hook\", \"bob\"", 0), none);
    assert_eq!(chain("\"bob\", \"bob\"", 3), Fault::RodLength(0.0));
    let many = chain("\"hook\", \"bob\"", u64::MAX / 2);
    assert!(matches!(many, Fault::TooMany { what: "particles", .. }), "{many:?}");
}
