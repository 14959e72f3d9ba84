//! Bodies in the coordinates of their joints: the same motion as in their own, order, budget, and what is refused.

use stationary_scene::{Fault, Run, Scene, SceneError};

fn scene(text: &str) -> Scene {
    Scene::parse("joints.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(text: &str) -> Fault {
    match Scene::parse("joints.toml", text) {
        Err(SceneError::Invalid(error)) => error.fault,
        other => panic!("{other:?}"),
    }
}

/// A pendulum of two bars in the plane, on which more may act.
fn double_pendulum(method: &str, step: f64, more: &str) -> Scene {
    scene(&format!(
        "dimension = 2\nintegrator = {method}\nstep = {step}\nhorizon = 1.2\n\
         uniform_gravity = {{ acceleration = [0, -9.81] }}\n\
         bodies = [{{ name = \"lower\", mass = 0.7, moments = 0.02, position = [0.5, -0.5] }},\n\
         {{ name = \"upper\", mass = 1.1, moments = 0.05, position = [0.25, 0] }}]\n\
         joints = [{{ kind = \"pin\", between = [\"lower\", \"upper\"], at = [0.5, 0]{more} }},\n\
         {{ kind = \"pin\", between = [\"upper\", \"world\"], at = [0, 0] }}]\n"
    ))
}

/// A body on a ball joint that carries one on a hinge and one on a slider; one more is free.
fn branches(method: &str, step: f64) -> Scene {
    scene(&format!(
        "dimension = 3\nintegrator = {method}\nstep = {step}\nhorizon = 0.8\n\
         uniform_gravity = {{ acceleration = [0, 0, -9.81] }}\n\
         bodies = [{{ name = \"free\", mass = 2, moments = [0.3, 0.4, 0.5], position = [3, 0, 0],\n\
         velocity = [0, 1, 4], angular_velocity = [1, 2, -1] }},\n\
         {{ name = \"trunk\", mass = 1, moments = [0.1, 0.12, 0.04], position = [0, 0, -0.4],\n\
         rotation = [0, 0, 0.3] }},\n\
         {{ name = \"vane\", mass = 0.5, moments = [0.02, 0.03, 0.04], position = [0.4, 0, -0.8] }},\n\
         {{ name = \"bead\", mass = 0.3, moments = [0.01, 0.01, 0.02], position = [0, 0.3, -0.4],\n\
         velocity = [0, 0.5, 0] }}]\n\
         joints = [{{ kind = \"ball\", between = [\"world\", \"trunk\"], at = [0, 0, 0] }},\n\
         {{ kind = \"hinge\", between = [\"trunk\", \"vane\"], at = [0, 0, -0.8], axis = [0, 1, 1] }},\n\
         {{ kind = \"slider\", between = [\"bead\", \"trunk\"], at = [0, 0.3, -0.4], axis = [0, 1, 0] }}]\n"
    ))
}

/// The largest difference of places at the moments of the coarser run.
pub(crate) fn apart(fine: &Run, coarse: &Run) -> f64 {
    let every = (fine.times().len() - 1) / (coarse.times().len() - 1);
    let differ = |sample: usize| {
        let (a, b) = (fine.positions(every * sample), coarse.positions(sample));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    (0..coarse.times().len()).map(differ).fold(0.0, f64::max)
}

/// What the works leave of the change of energy, joules.
pub(crate) fn defect(run: &Run) -> f64 {
    let energies = run.energies();
    let change = energies[energies.len() - 1] - energies[0];
    change - run.works().iter().map(|(_, work)| work).sum::<f64>()
}

#[test]
fn the_coordinates_of_joints_have_the_motion_of_bodies_held_by_forces_at_order_two() {
    let exact = "\"dormand-prince-853\"\ntolerance = 1e-11";
    let equal = "\"joint-coordinates\"";
    let plane = |method: &str, step| double_pendulum(method, step, "").run().unwrap();
    let space = |method: &str, step| branches(method, step).run().unwrap();
    type Runs<'a> = &'a dyn Fn(&str, f64) -> Run;
    let cases: [(Runs<'_>, &str, [f64; 2]); 2] = [
        (&plane, "\"stormer-verlet\"", [0.004, 0.002]),
        (&space, "\"variational-rotation\"", [0.002, 0.001]),
    ];
    for (run, held, [coarse, fine]) in cases {
        let truth = run(exact, fine);
        for method in [equal, held] {
            let [first, second] = [coarse, fine].map(|step| apart(&truth, &run(method, step)));
            let slope = (first / second).log2();
            assert!((slope - 2.0).abs() < 0.1 && second < 1e-3, "{method}: {first} {second}");
        }
        // The same discrete principle: to rounding the same motion.
        let both = apart(&run(equal, fine), &run(held, fine));
        assert!(both < 1e-9, "{both}");
        let energies = truth.energies();
        let drift = energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max);
        assert!(drift < 1e-8, "{drift}");
    }
}

#[test]
fn springs_dampers_loads_and_motors_act_along_joints_and_close_the_budget() {
    let more = ", stiffness = 3, rest = 0.2, damping = 0.05";
    let acting = |method: &str, step: f64| {
        let text = format!(
            "{}loads = [{{ on = \"lower\", force = [2, 1], strength = {{ sine = 1, frequency = 1.5 }} }}]\n\
             motors = [{{ between = [\"upper\", \"world\"], torque = 1.5 }}]\n\
             springs = [{{ between = [\"lower.0\", \"upper.0\"], stiffness = 40, damping = 0.3 }}]\n",
            text_of(method, step, more)
        );
        scene(&text).run().unwrap()
    };
    let truth = acting("\"dormand-prince-853\"\ntolerance = 1e-11", 0.002);
    assert!(defect(&truth).abs() < 1e-7, "{}", defect(&truth));
    assert!(truth.works().iter().all(|(_, work)| work.abs() > 1e-4), "{:?}", truth.works());
    for method in ["\"joint-coordinates\"", "\"stormer-verlet\""] {
        let runs = [0.004, 0.002].map(|step| acting(method, step));
        let [first, second] = [0, 1].map(|k| apart(&truth, &runs[k]));
        assert!(((first / second).log2() - 2.0).abs() < 0.15, "{method}: {first} {second}");
        let [first, second] = [0, 1].map(|k| defect(&runs[k]).abs());
        assert!(second < 1e-3 && first / second > 3.0, "{method}: {first} {second}");
    }
}

/// The double pendulum with points that springs are tied to.
fn text_of(method: &str, step: f64, more: &str) -> String {
    format!(
        "dimension = 2\nintegrator = {method}\nstep = {step}\nhorizon = 1.2\n\
         uniform_gravity = {{ acceleration = [0, -9.81] }}\n\
         bodies = [{{ name = \"lower\", mass = 0.7, moments = 0.02, position = [0.5, -0.5],\n\
         points = [[0, -0.3]] }},\n\
         {{ name = \"upper\", mass = 1.1, moments = 0.05, position = [0.25, 0], points = [[0, 0.2]] }}]\n\
         joints = [{{ kind = \"pin\", between = [\"lower\", \"upper\"], at = [0.5, 0]{more} }},\n\
         {{ kind = \"pin\", between = [\"upper\", \"world\"], at = [0, 0] }}]\n"
    )
}

#[test]
fn methods_that_step_no_coordinates_of_joints_are_refused() {
    let pendulum = "dimension = 2\nintegrator = \"joint-coordinates\"\nstep = 0.1\nhorizon = 1\n\
         bodies = [{ name = \"bar\", mass = 1, moments = 0.1, position = [1, 0] }]\n\
         joints = [{ kind = \"pin\", between = [\"bar\", \"world\"], at = [0, 0] }]\n";
    let touching = pendulum.replace("integrator", "contact = {}\nintegrator");
    assert!(matches!(fault(&touching), Fault::Bodies(_) | Fault::MethodCannot { .. }));
    let implicit = pendulum.replace("\"joint-coordinates\"", "\"radau-iia-5\"\ntolerance = 1e-3");
    assert!(matches!(fault(&implicit), Fault::MethodOfAnother(_)), "{}", fault(&implicit));
    let particles = "dimension = 1\nintegrator = \"joint-coordinates\"\nstep = 0.1\nhorizon = 1\n\
         particles = [{ name = \"a\", position = [0], mass = 1 }]\n";
    assert!(matches!(fault(particles), Fault::UnknownWord { .. }), "{}", fault(particles));
}

/// Three bodies on a ball and a hinge that nothing else holds.
fn free_chain(method: &str, step: f64, spin: f64) -> Scene {
    scene(&format!(
        "dimension = 3\nintegrator = {method}\nstep = {step}\nhorizon = 2\n\
         observables = [\"linear-momentum\", \"angular-momentum\"]\n\
         bodies = [{{ name = \"a\", mass = 1, moments = [0.1, 0.2, 0.15], position = [0, 0, 0],\n\
         velocity = [0.3, -0.1, 0.2], angular_velocity = [0, 0, {spin}] }},\n\
         {{ name = \"b\", mass = 2, moments = [0.2, 0.1, 0.2], position = [1, 0, 0] }},\n\
         {{ name = \"c\", mass = 0.5, moments = [0.05, 0.04, 0.03], position = [2, 0.5, 0] }}]\n\
         joints = [{{ kind = \"ball\", between = [\"a\", \"b\"], at = [0.5, 0, 0] }},\n\
         {{ kind = \"hinge\", between = [\"c\", \"b\"], at = [1.5, 0, 0], axis = [0, 1, 1] }}]\n"
    ))
}

#[test]
fn a_chain_that_nothing_holds_keeps_both_momenta() {
    let adaptive = "\"dormand-prince-853\"\ntolerance = 1e-11";
    for (method, least) in [("\"joint-coordinates\"", 1e-11), (adaptive, 1e-8)] {
        let run = free_chain(method, 0.01, 2.0).run().unwrap();
        let first = run.observed(0).to_vec();
        assert!(first.iter().any(|x| x.abs() > 0.1), "{first:?}");
        for sample in 0..run.times().len() {
            let now = run.observed(sample).iter().zip(&first);
            let off = now.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < least, "{method}: {off} at {sample}");
        }
    }
}

/// Past the edge: a body that turns by more than half a turn in an equal step is an error with what was run
/// so far; steps that the method chooses go on.
#[test]
fn too_long_a_step_in_the_coordinates_of_joints_is_an_error_and_chosen_ones_are_not() {
    let fast = |method: &str| free_chain(method, 0.1, 60.0).run();
    let error = fast("\"joint-coordinates\"").unwrap_err();
    assert!(error.partial().is_some_and(|run| run.times().len() < 21), "{error}");
    let run = fast("\"dormand-prince-853\"\ntolerance = 1e-9").unwrap();
    assert_eq!(run.times().len(), 21);
}

#[test]
fn a_turn_spring_counts_whole_turns_whatever_steps_are_tried() {
    let (stiffness, inertia) = (0.2_f64, 1.01 / 12.0 + 0.25);
    let w = (stiffness / inertia).sqrt();
    for method in [
        "\"dormand-prince-853\"\ntolerance = 1e-6",
        "\"dormand-prince-853\"\ntolerance = 1e-9",
        "\"dormand-prince-54\"\ntolerance = 1e-9",
        "\"joint-coordinates\"",
        "\"error-controlled\"\ntolerance = 1e-5",
    ] {
        // A floor far below, as steps chosen by error are those of worlds with contact.
        let floor = if method.contains("error-controlled") {
            "[contact]\nwalls = [{ name = \"floor\", normal = [0, 1], at = [0, -5] }]\n"
        } else {
            ""
        };
        let run = scene(&format!(
            "dimension = 2\nintegrator = {method}\nstep = 0.001\nhorizon = 3\nsample_every = 500\n\
             bodies = [{{ name = \"arm\", mass = 1, box = [1, 0.1], position = [0.5, 0],\n\
             angular_velocity = 6 }}]\n\
             joints = [{{ kind = \"pin\", between = [\"world\", \"arm\"], at = [0, 0],\n\
             stiffness = {stiffness} }}]\n{floor}"
        ))
        .run()
        .unwrap();
        for (sample, t) in run.times().iter().enumerate() {
            let angle = 6.0 / w * (w * t).sin();
            let off = (run.positions(sample)[0] - 0.5 * angle.cos())
                .hypot(run.positions(sample)[1] - 0.5 * angle.sin());
            assert!(off < 1e-4, "{method}: {off} at {t}");
        }
    }
}
