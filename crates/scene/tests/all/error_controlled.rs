//! Bodies of scenes that touch in steps chosen by their error: closed forms, the accuracy that was asked for, reading
//! off, resuming, refusals.

use stationary_scene::{Control, Observer, Progress, Run, Scene};

use crate::body_diagnostics::refused;
use crate::checkpoints::assert_resumes;

const G: f64 = 10.0;

/// A box that is pushed over a floor in the plane, on two corners or as a disc that does not turn.
fn sliding(tolerance: f64, step: f64) -> String {
    format!(
        "dimension = 2\nintegrator = \"error-controlled\"\ntolerance = {tolerance:e}\nstep = {step}\nhorizon = 2\n\
         uniform_gravity = {{ acceleration = [0, -{G}] }}\n\
         bodies = [{{ name = \"block\", mass = 2, box = [0.6, 0.8], position = [0, 0.4], velocity = [3, 0] }}]\n\
         [contact]\nfriction = 0.25\nwalls = [{{ normal = [0, 1], at = [0, 0] }}]\n"
    )
}

/// The block's size: the distance of its corners from its centre.
const SIZE: f64 = 0.5;

/// `x = 3 t - 5/4 t^2` until it stops at `t = 1.2`: 1.8 m in all.
fn slid(t: f64) -> f64 {
    let t = t.min(1.2);
    3.0 * t - 1.25 * t * t
}

fn dropped(tolerance: f64, step: f64) -> String {
    format!(
        "dimension = 3\nintegrator = \"error-controlled\"\ntolerance = {tolerance:e}\nstep = {step}\nhorizon = 1\n\
         uniform_gravity = {{ acceleration = [0, 0, -{G}] }}\n\
         bodies = [{{ name = \"ball\", mass = 2, ball = 0.1, position = [0, 0, 1.1], velocity = [0.3, 0, 0] }}]\n\
         [contact]\nrestitution = 0.5\nwalls = [{{ normal = [0, 0, 1], at = [0, 0, 0] }}]\n"
    )
}

/// The height of the ball, whose second bounce comes `sqrt(20)/10` s after the first.
fn height(t: f64) -> f64 {
    let (fall, speed) = (0.2_f64.sqrt(), 20.0_f64.sqrt());
    let up = |speed: f64, t: f64| 0.1 + speed * t - 5.0 * t * t;
    match t {
        t if t < fall => 1.1 - 5.0 * t * t,
        t if t < 2.0 * fall => up(0.5 * speed, t - fall),
        t => up(0.25 * speed, t - 2.0 * fall),
    }
}

fn run(text: &str) -> Run {
    Scene::parse("a.toml", text).unwrap().run().unwrap()
}

fn worst(run: &Run, coordinate: usize, truth: fn(f64) -> f64) -> f64 {
    let off = |k: usize| (run.positions(k)[coordinate] - truth(run.times()[k])).abs();
    (0..run.times().len()).map(off).fold(0.0, f64::max)
}

#[test]
fn a_block_slides_to_rest_as_coulomb_says_to_the_accuracy_that_is_asked_for() {
    let mut before = f64::INFINITY;
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
        let run = run(&sliding(tolerance, 0.05));
        let off = worst(&run, 0, slid);
        assert!(off < SIZE * tolerance, "{tolerance}: {off}");
        assert!(off < 0.5 * before, "{tolerance}: {off} after {before}");
        before = off;
        assert!(run.chosen_steps().accepted > 0 && run.unsettled().steps == 0);
    }
}

#[test]
fn a_ball_bounces_as_galileo_says_to_the_accuracy_that_is_asked_for() {
    let mut before = f64::INFINITY;
    // A ball alone has no size but one.
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
        let run = run(&dropped(tolerance, 0.05));
        let off = worst(&run, 2, height);
        assert!(off < 4.0 * tolerance, "{tolerance}: {off}");
        assert!(off < 0.5 * before, "{tolerance}: {off} after {before}");
        before = off;
        let [first, second] = [run.impacts()[0].time, run.impacts()[1].time];
        let fall = 0.2_f64.sqrt();
        assert!((first - fall).abs() < tolerance && (second - 2.0 * fall).abs() < 4.0 * tolerance);
    }
}

/// Two bounces take 3/4 of 20 J and of the 5 J that are left; what is left of the budget falls with the tolerance.
#[test]
fn the_work_of_impacts_closes_the_budget_to_the_tolerance() {
    let mut before = f64::INFINITY;
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let run = run(&dropped(tolerance, 0.05));
        let energies = run.energies();
        let change = energies[energies.len() - 1] - energies[0];
        let works: f64 = run.works().iter().map(|(_, work)| work).sum();
        let left = (change - works).abs();
        assert!((works + 18.75).abs() < 200.0 * tolerance, "{tolerance}: {works}");
        assert!(left < 0.2 * before, "{tolerance}: {left} after {before}");
        before = left;
    }
}

/// What is read off where nothing ends is as near to the truth, and costs no steps.
#[test]
fn a_fine_step_costs_none_and_is_as_accurate() {
    let [coarse, fine] = [0.05, 0.000_5].map(|step| run(&sliding(1e-4, step)));
    assert!(worst(&fine, 0, slid) < SIZE * 1e-4);
    let [few, many] = [&coarse, &fine].map(|run| run.chosen_steps().accepted);
    assert!(many < 2 * few, "{many} and {few}");
    assert_eq!(fine.times().len(), 4001);
}

#[test]
fn it_resumes_to_the_same_bits() {
    for (name, text) in
        [("chosen-slide", sliding(1e-3, 0.005)), ("chosen-bounce", dropped(1e-3, 0.005))]
    {
        assert_resumes(&Scene::parse("a.toml", &text).unwrap(), &[2, 3, 50, 117, 199], name);
    }
}

/// Looks within every step.
struct Looks(Vec<(f64, f64)>);

impl Observer for Looks {
    fn stepped(&mut self, _: Progress<'_>) -> Control {
        Control::Continue
    }

    fn keep(&mut self, _: &stationary_scene::Checkpoint) {}

    fn parts(&mut self, _: u64) -> &[f64] {
        &[0.25, 0.75, 1.0]
    }

    fn inside(&mut self, time: f64, observed: &[f64]) {
        self.0.push((time, observed[2]));
    }
}

#[test]
fn what_is_within_a_step_is_read_off_and_changes_nothing() {
    let text =
        dropped(1e-4, 0.05).replace("horizon", "observables = [{ position = \"ball\" }]\nhorizon");
    let scene = Scene::parse("a.toml", &text).unwrap();
    let mut looks = Looks(Vec::new());
    let run = scene.run_from(None, &mut looks).unwrap();
    assert_eq!(looks.0.len(), 60);
    for (time, found) in looks.0 {
        assert!((found - height(time)).abs() < 4e-4, "{time}: {found}");
    }
    let last = run.times().len() - 1;
    assert_eq!(run.positions(last), scene.run().unwrap().positions(last));
}

/// What the energy's change and the works differ by, J.
fn left(run: &Run) -> f64 {
    let energies = run.energies();
    let works: f64 = run.works().iter().map(|(_, work)| work).sum();
    energies[energies.len() - 1] - energies[0] - works
}

fn work(run: &Run, name: &str) -> f64 {
    run.works().iter().find(|(other, _)| other == name).unwrap().1
}

/// 2 kg at 3 m/s: 9 J go to friction and nothing else, whatever samples cut the steps.
#[test]
fn a_block_that_slides_to_rest_loses_what_friction_took() {
    for step in [0.5, 0.05, 0.000_5] {
        for (tolerance, off) in [(1e-2, 1e-2), (1e-4, 1e-4), (1e-6, 1e-6)] {
            let run = run(&sliding(tolerance, step));
            assert!((work(&run, "friction") + 9.0).abs() < off, "{:?}", run.works());
            assert!(left(&run).abs() < off, "{step} {tolerance}: {}", left(&run));
        }
    }
}

/// The budget up to each sample: works are of the momentum that is read there.
#[test]
fn the_budget_of_a_slide_that_stops_anywhere_is_closed() {
    for horizon in [0.31, 0.7, 1.1] {
        let text = sliding(1e-4, 0.01).replace("horizon = 2", &format!("horizon = {horizon}"));
        let run = run(&text);
        assert!(left(&run).abs() < 1e-6, "{horizon}: {}", left(&run));
        let v = 3.0 - 2.5 * horizon;
        assert!((work(&run, "friction") - (v * v - 9.0)).abs() < 1e-3, "{:?}", run.works());
    }
}

/// A box that falls on its corner, slides and tumbles: what is left is the sum of what its steps are off, as many as
/// one over the root of the tolerance.
#[test]
fn a_box_dropped_with_friction_closes_its_budget_with_the_tolerance() {
    let text = |tolerance: f64| {
        format!(
            "dimension = 2\nintegrator = \"error-controlled\"\ntolerance = {tolerance:e}\nstep = 0.01\nhorizon = 1\n\
             uniform_gravity = {{ acceleration = [0, -{G}] }}\n\
             bodies = [{{ name = \"box\", mass = 2, box = [0.6, 0.8], position = [0, 0.8], rotation = 0.3, \
             velocity = [2, 0] }}]\n\
             [contact]\nfriction = 0.3\nwalls = [{{ normal = [0, 1], at = [0, 0] }}]\n"
        )
    };
    let mut before = f64::INFINITY;
    for (tolerance, off) in [(1e-3, 1e-1), (1e-4, 3e-2), (1e-5, 1e-2)] {
        let run = run(&text(tolerance));
        assert!(work(&run, "friction") < -1.0 && work(&run, "impacts") < -1.0, "{:?}", run.works());
        let left = left(&run).abs();
        // Where steps are extrapolated, so are impulses.
        let given: [f64; 2] =
            std::array::from_fn(|c| run.contact_impulses().iter().map(|row| row.impulse[c]).sum());
        let momenta = run.linear_momenta();
        let end = momenta[momenta.len() - 1];
        assert!((end[0] - momenta[0][0] - given[0]).abs() < 1e-10, "{given:?}");
        assert!((end[1] - momenta[0][1] + 2.0 * G - given[1]).abs() < 1e-10, "{given:?}");
        assert!(left < off && left < before, "{tolerance}: {left} {:?}", run.works());
        before = left;
    }
}

/// Impulses are the changes of momenta from sample to sample, of what rests the weight times the time.
#[test]
fn impulses_of_contacts_are_the_changes_of_momenta() {
    for step in [0.05, 0.000_5] {
        let run = run(&sliding(1e-4, step));
        let rows = run.contact_impulses();
        let (times, mut sums) = (run.times(), vec![[0.0; 2]; run.times().len()]);
        for row in rows {
            assert_eq!(row.between.map(|side| side.name(run.scene())), ["wall 1", "block"]);
            (0..2).for_each(|c| sums[row.sample][c] += row.impulse[c]);
        }
        for k in 1..times.len() {
            let [x, y] = sums[k];
            let before = run.linear_momenta()[k - 1];
            let given: [f64; 3] = std::array::from_fn(|c| run.linear_momenta()[k][c] - before[c]);
            assert!((x - given[0]).abs() < 1e-10, "{step} {k}: {x} {given:?}");
            let weight = 2.0 * G * (times[k] - times[k - 1]);
            assert!((y - weight - given[1]).abs() < 1e-10, "{step} {k}: {y} {weight}");
        }
        let total: f64 = sums.iter().map(|[_, y]| y).sum();
        assert!((total - 2.0 * G * 2.0).abs() < 1e-9, "{total}");
    }
}

/// A block that a load pushes over the floor while gravity grows, in air: `x.. = F/m - mu g(t) - c/m x.`.
fn pushed(tolerance: f64, step: f64) -> String {
    sliding(tolerance, step)
        .replace("uniform_gravity", "drag = { coefficient = 0.8 }\nuniform_gravity")
        .replace(
            &format!("acceleration = [0, -{G}]"),
            &format!(
                "acceleration = [0, -{G}], strength = {{ ramp = [1, 1.5], from = 0.2, to = 0.9 }}"
            ),
        )
        + "[[loads]]\non = \"block\"\nforce = [16, 0]\nstrength = { step = [0, 1], at = 0.33 }\n"
}

/// Where it is at 2 s, by steps of order 4 between the corners.
fn pushed_to() -> f64 {
    let rate = |t: f64, [_, v]: [f64; 2]| {
        let g = G * (1.0 + 0.5 * ((t - 0.2) / 0.7).clamp(0.0, 1.0));
        let push = if t > 0.33 { 8.0 } else { 0.0 };
        [v, push - 0.25 * g - 0.4 * v]
    };
    let mut y = [0.0, 3.0];
    for ends in [[0.0, 0.2], [0.2, 0.33], [0.33, 0.9], [0.9, 2.0]] {
        let (n, h) = (200, (ends[1] - ends[0]) / 200.0);
        for k in 0..n {
            // Just inside of a jump.
            let t =
                |part: f64| ends[0] + h * (f64::from(k) + part).clamp(1e-9, f64::from(n) - 1e-9);
            let at = |y: [f64; 2], part: f64, r: [f64; 2]| {
                [y[0] + part * h * r[0], y[1] + part * h * r[1]]
            };
            let a = rate(t(0.0), y);
            let b = rate(t(0.5), at(y, 0.5, a));
            let c = rate(t(0.5), at(y, 0.5, b));
            let d = rate(t(1.0), at(y, 1.0, c));
            (0..2).for_each(|i| y[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
    }
    y[0]
}

#[test]
fn loads_drag_and_changing_gravity_act_at_their_times_and_close_the_budget() {
    for step in [0.5, 0.05] {
        let mut before = f64::INFINITY;
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let run = run(&pushed(tolerance, step));
            let at = run.positions(run.times().len() - 1)[0];
            let off = (at - pushed_to()).abs();
            assert!(off < 10.0 * SIZE * tolerance && off < before, "{step} {tolerance}: {off}");
            before = off;
            let names: Vec<String> = run.works().into_iter().map(|(name, _)| name).collect();
            let of_contact = ["friction", "impacts", "lifting out of overlap"];
            assert_eq!(names[..3], ["drag", "gravity", "load on block"]);
            assert_eq!(names[3..], of_contact);
            assert!(left(&run).abs() < 200.0 * tolerance, "{tolerance}: {}", left(&run));
        }
    }
    assert_resumes(
        &Scene::parse("a.toml", &pushed(1e-3, 0.005)).unwrap(),
        &[2, 61, 117, 399],
        "chosen-push",
    );
}

/// A pulse of 1e-3 s gives its impulse however long the steps are.
#[test]
fn no_pulse_of_a_load_is_missed() {
    let push = "[[loads]]\non = \"block\"\nforce = [4000, 0]\nstrength = { step = [0, 1], at = 0.4 }\n\
                [[loads]]\non = \"block\"\nforce = [-4000, 0]\nstrength = { step = [0, 1], at = 0.401 }\n";
    let text = sliding(1e-4, 0.5).replace("friction = 0.25\n", "") + push;
    let run = run(&text);
    let exact = 3.0 * 2.0 + 2.0 * (2.0 - 0.4005);
    let at = run.positions(run.times().len() - 1)[0];
    assert!((at - exact).abs() < SIZE * 1e-4, "{at} {exact}");
}

/// A block on rollers whose spring a pin pulls: the pin's work is that of its motion, and `error-controlled` has the
/// answer of the closed form.
#[test]
fn a_pin_that_moves_pulls_at_a_block_that_touches_and_its_work_closes_the_budget() {
    let text = |method: &str| {
        format!(
            "dimension = 2\nintegrator = {method}\nhorizon = 2\n\
             uniform_gravity = {{ acceleration = [0, -{G}] }}\n\
             bodies = [{{ name = \"block\", mass = 2, box = [0.6, 0.8], position = [0, 0.4] }}]\n\
             particles = [{{ name = \"pin\", pinned = true, position = [2, 0.4] }}]\n\
             springs = [{{ between = [\"block\", \"pin\"], stiffness = 18 }}]\n\
             motions = [{{ of = \"pin\", shift = [1, 0], strength = {{ ramp = [0, 1], to = 2 }} }}]\n\
             [contact]\nwalls = [{{ normal = [0, 1], at = [0, 0] }}]\n"
        )
    };
    // x = t/2 - sin(3 t)/6, and the pull 18 (t/2 - x) moves by half a metre a second.
    let exact = 1.0 - 6.0_f64.sin() / 6.0;
    let work_exact = 0.5 * (1.0 - 6.0_f64.cos());
    let chosen = run(&text("\"error-controlled\"\ntolerance = 1e-4\nstep = 0.1"));
    let at = |run: &Run| run.positions(run.times().len() - 1)[0];
    assert!((at(&chosen) - exact).abs() < 1e-4, "{} {exact}", at(&chosen));
    assert!((work(&chosen, "motion of pin") - work_exact).abs() < 1e-3, "{:?}", chosen.works());
    assert!(left(&chosen).abs() < 1e-3, "{}", left(&chosen));
    let fixed = run(&text("\"stormer-verlet\"\nstep = 0.001"));
    assert!((work(&fixed, "motion of pin") - work_exact).abs() < 1e-2, "{:?}", fixed.works());
    assert!(left(&fixed).abs() < 1e-2, "{}", left(&fixed));
}

#[test]
fn the_summary_says_how_many_steps_were_chosen_and_closes_the_budget() {
    let words = run(&sliding(1e-3, 0.05)).summary().to_string();
    assert!(words.contains("steps chosen by their error"), "{words}");
    assert!(words.contains("error of the chosen steps"), "{words}");
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("error-controlled");
    run(&sliding(1e-3, 0.05)).write(&folder).unwrap();
    let rows = std::fs::read_to_string(folder.join("contacts.csv")).unwrap();
    assert!(folder.join("events.csv").exists() && rows.lines().count() > 20, "{rows}");
}

#[test]
fn what_it_has_no_place_for_is_refused() {
    let word = "\"error-controlled\"";
    let marked = dropped(1e-3, 0.125).replace(word, &format!("<<{word}>>"));
    let breaking = "[[particles]]\nname = \"hook\"\npinned = true\nposition = [0, 0, 2]\n\
                    [[particles]]\nname = \"bob\"\nmass = 1\nposition = [1, 0, 2]\n\
                    [[rods]]\nbetween = [\"hook\", \"bob\"]\nstrength = 9\n";
    refused(
        &format!("{marked}{breaking}"),
        "`error-controlled` cannot step rods that break: name `variational-rotation`",
    );
    let pusher = "[[particles]]\nname = \"pusher\"\npinned = true\nradius = 0.1\nposition = [9, 0, 1]\n\
                  [[motions]]\nof = \"pusher\"\nshift = [1, 0, 0]\nstrength = { step = [0, 1], at = 0.5 }\n";
    refused(
        &format!("{marked}{pusher}"),
        "`error-controlled` cannot step pins that jump and hold rods or touch, which takes an infinite speed: \
         make it a `ramp`",
    );
    refused(
        marked.split("[contact]").next().unwrap(),
        "`error-controlled` cannot step bodies that never meet: add `[contact]`, or name `variational-rotation`",
    );
    refused(
        &marked.replace("tolerance = 1e-3\n", ""),
        "this integrator chooses its own steps and needs a `tolerance`",
    );
    let wide = dropped(1e-3, 0.125).replace("1e-3", "<<2>>");
    refused(&wide, "the tolerance is 2e0; it must be at least 1e-14 and below 1");
}

/// The rounding of a place is no accuracy: it is refused, not missed.
#[test]
fn a_tolerance_below_the_rounding_of_places_is_an_error() {
    let far = dropped(1e-12, 0.125).replace("[0, 0, 1.1]", "[1e6, 0, 1.1]");
    let error = Scene::parse("a.toml", &far).unwrap().run().unwrap_err();
    assert!(error.to_string().contains("above the rounding of the coordinates"), "{error}");
}

/// Of order 2 in the steps, so of order 1 in the tolerance: works of halves alone would fall with its root.
#[test]
fn works_of_drag_and_of_a_pin_are_extrapolated_as_the_motion_is() {
    let floor = "[contact]\nwalls = [{ normal = [0, 1], at = [0, 0] }]\n";
    let text = |tolerance: f64, beside: &str, velocity: f64| {
        format!(
            "dimension = 2\nintegrator = \"error-controlled\"\ntolerance = {tolerance:e}\nstep = 0.5\nhorizon = 2\n\
             uniform_gravity = {{ acceleration = [0, -{G}] }}\n\
             bodies = [{{ name = \"block\", mass = 2, box = [0.6, 0.8], position = [0, 0.4], velocity = [{velocity}, 0] }}]\n\
             {beside}\n{floor}"
        )
    };
    let pin = "particles = [{ name = \"pin\", pinned = true, position = [2, 0.4] }]\n\
               springs = [{ between = [\"block\", \"pin\"], stiffness = 18 }]\n\
               motions = [{ of = \"pin\", shift = [1, 0], strength = { ramp = [0, 1], to = 2 } }]";
    // 9 J are braked by exp(-2 c t/m); a pull of 18 (t/2 - x) is moved by half a metre a second.
    let braked = 9.0 * ((-2.0 * 1.6_f64).exp() - 1.0);
    let pulled = 0.5 * (1.0 - 6.0_f64.cos());
    for (beside, velocity, name, exact) in
        [("drag = { coefficient = 1.6 }", 3.0, "drag", braked), (pin, 0.0, "motion of pin", pulled)]
    {
        let of = |tolerance: f64| {
            let run = run(&text(tolerance, beside, velocity));
            ((work(&run, name) - exact).abs(), left(&run).abs())
        };
        let [coarse, fine] = [1e-2, 1e-4].map(of);
        assert!(fine.0 < 1e-3 && coarse.0 > 25.0 * fine.0, "{name}: {coarse:?} {fine:?}");
        assert!(fine.1 < 1e-3 && coarse.1 > 25.0 * fine.1, "{name}: {coarse:?} {fine:?}");
    }
}
