//! What a scene says of its own run: every shipped scene makes claims that hold, a claim that does not hold
//! is told, and one that cannot be is refused at its place.

use std::fs;
use std::path::PathBuf;

use stationary_scene::{Answer, Fault, Scene, SceneError, Verdict};

/// A stone that falls for a second from rest, by a method that is exact for it.
const STONE: &str = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 1\n\
    sample_every = 10\nobservables = [\"energy\", { position = \"stone\" }]\n\
    uniform_gravity = { acceleration = [0, -10] }\n\
    particles = [{ name = \"stone\", mass = 2, position = [0, 5] }]\n";

fn scene(claim: &str) -> Result<Scene, SceneError> {
    Scene::parse("a.toml", &format!("{STONE}claims = [{{ {claim}, source = \"a test\" }}]\n"))
}

fn shipped() -> Vec<PathBuf> {
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = fs::read_dir(scenes).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    files.sort();
    files
}

/// The claims that do not hold, in words.
fn broken(answers: &[Answer<'_>]) -> Vec<String> {
    let broken = answers.iter().filter(|answer| answer.verdict != Verdict::Holds);
    broken.map(|answer| format!("{answer:?}")).collect()
}

#[test]
fn every_shipped_scene_makes_claims() {
    let files = shipped();
    assert!(files.len() >= 17);
    for path in files {
        let scene = Scene::read(&path).unwrap();
        assert!(scene.claims().len() >= 2, "{}", path.display());
    }
}

#[test]
fn the_claims_of_the_shipped_scenes_hold() {
    let mut wrong = Vec::new();
    for path in shipped() {
        let run = Scene::read(&path).unwrap().run().unwrap();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        wrong.extend(broken(&run.claims()).into_iter().map(|claim| format!("{name}: {claim}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

const HEIGHT: &str = "of = { position = \"stone\" }, component = \"y\"";

#[test]
fn a_claim_holds_within_its_band_and_not_beside_it() {
    // y = 5 - 5 t^2 at the samples t = 0, 0.1, ..., 1; the energy is 100.
    for (claim, measured) in [
        (format!("{HEIGHT}, is = Y"), 0.0),
        (format!("{HEIGHT}, at = 0.5, is = Y"), 3.75),
        (format!("{HEIGHT}, what = \"least\", is = Y"), 0.0),
        (format!("{HEIGHT}, what = \"largest\", is = Y"), 5.0),
        ("of = \"energy\", at = 0, is = Y".to_owned(), 100.0),
    ] {
        for (off, verdict) in [
            (0.0, Verdict::Holds),
            (9e-4, Verdict::Holds),
            (-9e-4, Verdict::Holds),
            (2e-3, Verdict::DoesNotHold),
            (-2e-3, Verdict::DoesNotHold),
        ] {
            let said = format!("{:.6}", measured + off);
            let claim = format!("{}, within = 0.001", claim.replace('Y', &said));
            let run = scene(&claim).unwrap().run().unwrap();
            let answer = run.claims()[0];
            assert_eq!(answer.verdict, verdict, "{claim}: {answer:?}");
            assert!((answer.measured.unwrap() - measured).abs() < 1e-9, "{claim}: {answer:?}");
            let summary = run.summary();
            assert_eq!(summary.broken_claims, usize::from(verdict == Verdict::DoesNotHold));
            assert_eq!(summary.to_string().contains("does not hold"), summary.broken_claims == 1);
        }
    }
}

#[test]
fn drifts_and_rises_are_the_largest_along_the_way() {
    // The stone comes back to where it was thrown from, so that the end alone would show nothing.
    let thrown = STONE.replace("position = [0, 5] }", "position = [0, 5], velocity = [0, 5] }");
    let measured = |claim: &str| {
        let text = format!("{thrown}claims = [{{ {claim}, within = 0, source = \"a test\" }}]\n");
        let run = Scene::parse("a.toml", &text).unwrap().run().unwrap();
        assert_eq!(run.claims()[0].verdict, Verdict::DoesNotHold, "{claim}");
        run.claims()[0].measured.unwrap()
    };
    let (drift, rise) = ("what = \"drift\"", "what = \"rise\"");
    let place = "of = { position = \"stone\" }";
    assert!((measured(&format!("{place}, {drift}")) - 1.25).abs() < 1e-9);
    assert!((measured(&format!("{place}, what = \"relative-drift\"")) - 0.2).abs() < 1e-9);
    assert!((measured(&format!("{HEIGHT}, {rise}")) - 1.25).abs() < 1e-9);
}

#[test]
fn a_run_that_ends_before_leaves_its_claims_open() {
    for claim in ["is = 7", "what = \"least\", is = 7", "what = \"rise\""] {
        let scene = scene(&format!("{HEIGHT}, {claim}, within = 0.1")).unwrap();
        let run = scene.with_horizon(0.5).unwrap().run().unwrap();
        assert_eq!(run.claims()[0].verdict, Verdict::NotReached, "{claim}");
        assert_eq!(run.summary().broken_claims, 0);
    }
    // A longer run is asked no more than what was claimed.
    let scene = scene(&format!("{HEIGHT}, what = \"least\", is = 0, within = 1e-9")).unwrap();
    let run = scene.with_horizon(2.0).unwrap().run().unwrap();
    assert_eq!(run.claims()[0].verdict, Verdict::Holds);
}

#[test]
fn an_event_is_claimed_at_its_time() {
    let balls = |radius: f64, is: f64| {
        format!(
            "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.01\nhorizon = 2\n\
             particles = [{{ name = \"a\", mass = 1, position = [0], velocity = [1], radius = {radius} }},\n\
             {{ name = \"b\", mass = 1, position = [1], radius = 0.1 }}]\n\
             contact = {{ restitution = 1, when = \"at-the-instant\" }}\n\
             claims = [{{ event = \"first-impact\", is = {is}, within = 1e-6, source = \"way over speed\" }}]\n"
        )
    };
    for (is, verdict) in [(0.8, Verdict::Holds), (0.81, Verdict::DoesNotHold)] {
        let scene = Scene::parse("a.toml", &balls(0.1, is)).unwrap();
        let run = scene.run().unwrap();
        assert_eq!(run.claims()[0].verdict, verdict, "{:?}", run.claims());
    }
    // What never happens does not hold, once the run is over.
    let away = balls(0.1, 0.8).replace("velocity = [1]", "velocity = [-1]");
    let run = Scene::parse("a.toml", &away).unwrap().run().unwrap();
    let answer = run.claims()[0];
    assert_eq!((answer.measured, answer.verdict), (None, Verdict::DoesNotHold));
}

/// Asserts that the claim is refused by the fault, at the text of the mark.
#[track_caller]
fn refused(claim: &str, mark: &str, fault: &str) {
    let Err(SceneError::Invalid(error)) = scene(claim) else { panic!("{claim} was taken") };
    let shown = error.to_string();
    assert!(shown.contains(fault), "{claim}: {shown}");
    let place = error.place.as_ref().unwrap_or_else(|| panic!("no place: {shown}"));
    let text = format!("{STONE}claims = [{{ {claim}, source = \"a test\" }}]");
    let line = text.lines().nth(place.line - 1).unwrap_or_default();
    let found: String = line.chars().skip(place.column - 1).take(mark.chars().count()).collect();
    assert_eq!(found, mark, "{shown}");
}

#[test]
fn a_claim_that_cannot_be_is_refused_at_its_place() {
    let y = HEIGHT;
    for (claim, mark, fault) in [
        (format!("{y}, is = nan, within = 1"), "nan", "what is claimed is NaN"),
        (format!("{y}, is = 1, within = -1"), "-1", "the band is -1"),
        (format!("{y}, is = 1, within = nan"), "nan", "the band is NaN"),
        (format!("{y}, is = 1, within = inf"), "inf", "the band is inf"),
        (format!("{y}, at = 1.5, is = 1, within = 1"), "1.5", "from 0 to 1"),
        (format!("{y}, at = -0.5, is = 1, within = 1"), "-0.5", "from 0 to 1"),
        (format!("{y}, at = nan, is = 1, within = 1"), "nan", "the time of a claim is NaN"),
        (format!("{y}, at = 0.55, is = 1, within = 1"), "0.55", "no sample at time 0.55"),
        ("of = \"enrgy\", is = 1, within = 1".into(), "\"enrgy\"", "unknown observable `enrgy`"),
        ("of = \"linear-momentum\", is = 1, within = 1".into(), "\"linear", "add this one"),
        ("of = { position = \"b\" }, is = 1, within = 1".into(), "\"b\"", "`b`"),
        ("of = { position = \"stone\" }, is = 1, within = 1".into(), "{ pos", "2 components"),
        (y.replace("\"y\"", "\"z\"") + ", is = 1, within = 1", "\"z\"", "component `z`"),
        ("of = \"energy\", component = \"x\", is = 1, within = 1".into(), "\"x\"", "no meaning"),
        (format!("{y}, what = \"mean\", is = 1, within = 1"), "\"mean\"", "unknown claim `mean`"),
        (format!("{y}, what = \"drift\", within = 1"), "\"y\"", "`component` has no meaning"),
        (
            "of = \"energy\", what = \"drift\", is = 1, within = 1".into(),
            "1",
            "`is` has no meaning",
        ),
        (format!("{y}, what = \"least\", at = 1, is = 1, within = 1"), "1", "`at` has no meaning"),
        (format!("{y}, within = 1"), "\"a test\"", "needs a number"),
        ("is = 1, within = 1".into(), "\"a test\"", "give one of them"),
        (format!("{y}, event = \"first-impact\", is = 1, within = 1"), "\"a test\"", "one of them"),
        ("event = \"first-impact\", is = 1, within = 1".into(), "\"first", "leads to"),
        ("event = \"first-break\", is = 1, within = 1".into(), "\"first", "leads to"),
        ("event = \"dawn\", is = 1, within = 1".into(), "\"dawn\"", "unknown event `dawn`"),
        ("event = \"first-impact\", at = 1, is = 1, within = 1".into(), "1", "`at` has no meaning"),
    ] {
        refused(&claim, mark, fault);
    }
    let text = format!("{STONE}claims = [{{ {y}, is = 1, within = 1, source = \"\" }}]\n");
    let Err(SceneError::Invalid(error)) = Scene::parse("a.toml", &text) else { panic!() };
    assert!(matches!(error.fault, Fault::Title { what: "a source" }), "{error}");
}

#[test]
fn claims_change_no_bit_of_a_run_and_no_checkpoint() {
    let run = |text: &str| Scene::parse("a.toml", text).unwrap().run().unwrap();
    let with = scene(&format!("{HEIGHT}, is = 0, within = 1e-9")).unwrap().run().unwrap();
    let without = run(STONE);
    assert_eq!(with.observed(10), without.observed(10));
    assert!(without.claims().is_empty() && without.summary().claims.is_none());
}
