//! Only what a scene names is built: every shipped scene, and what it built for its first step.

use std::path::Path;

use stationary_scene::{Run, Scene};

/// The first step of a shipped scene.
fn first_step(name: &str) -> Run {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let scene = Scene::read(folder.join(name)).unwrap();
    let step = scene.timing().step();
    scene.with_horizon(step).unwrap().run().unwrap()
}

/// What was built, as `crate what number`.
fn built(run: &Run) -> String {
    let there = run.built().counts().into_iter().filter(|(.., count)| *count > 0);
    let words: Vec<String> =
        there.map(|(owner, what, count)| format!("{owner} {what} {count}")).collect();
    words.join(", ")
}

#[test]
fn every_shipped_scene_builds_what_it_names_and_nothing_else() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = files.map(|name| name.into_string().unwrap()).collect();
    names.retain(|name| name.ends_with(".toml"));
    names.sort();
    let lines: Vec<String> =
        names.iter().map(|name| format!("{name}: {}", built(&first_step(name)))).collect();
    insta::assert_snapshot!(lines.join("\n"), @r"
    ball-strikes-a-pendulum.toml: rigid bodies 2, constraints equations 5, contact colliders 2
    billiard-with-spin.toml: rigid bodies 3, contact colliders 4
    block-on-incline.toml: rigid bodies 1, contact colliders 2
    box-stack.toml: rigid bodies 9, contact colliders 10
    breaking-bridge.toml: elasticity springs 1, constraints equations 18, calculus sparse solvers 1
    cantilever.toml: elasticity elements 320
    cloth-on-a-ball.toml: elasticity elements 2048, elasticity hinges 3008, contact gaps 1089
    domino-row.toml: rigid bodies 9, contact colliders 10
    foucault-pendulum.toml: constraints equations 1, calculus sparse solvers 1
    four-bar-pushes-a-crate.toml: rigid bodies 5, constraints equations 12, contact colliders 6
    galton-board.toml: rigid bodies 11, constraints equations 15, contact colliders 41
    heavy-top.toml: rigid bodies 1, constraints equations 3, calculus sparse solvers 1
    masonry-arch.toml: rigid bodies 15, contact colliders 16
    newtons-cradle-on-rods.toml: rigid bodies 5, constraints equations 5, contact colliders 5
    newtons-cradle.toml: elasticity springs 5, contact gaps 10
    nine-ball-break.toml: contact gaps 45
    outer-solar-system.toml: 
    pendulum-chain.toml: constraints equations 10, calculus sparse solvers 1
    plunger-shoots-a-ball.toml: elasticity springs 1, rigid bodies 2, constraints equations 2, contact colliders 2
    slider-crank-with-stop.toml: rigid bodies 3, constraints equations 8, contact colliders 4
    slinky-release.toml: elasticity elements 200, calculus sparse solvers 1
    spring-net.toml: elasticity springs 1482
    sprung-door.toml: rigid bodies 1, constraints equations 5, contact colliders 2
    struck-bell.toml: elasticity elements 992, elasticity hinges 1472, modal modes 40, calculus sparse solvers 2
    thrown-racket.toml: rigid bodies 1
    tippe-top.toml: rigid bodies 1, contact colliders 3
    tumbling-wrench.toml: rigid bodies 1
    warm-sphere.toml: laplacian simplices 5120, calculus sparse solvers 1
    wheel-over-a-bump.toml: elasticity springs 1, rigid bodies 4, constraints equations 8, contact colliders 6
    ");
}
