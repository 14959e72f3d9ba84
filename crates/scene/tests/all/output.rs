//! What a run leaves for eyes and for other programs is what it has computed.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use stationary_scene::{Run, Scene};

pub(crate) fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("output").join(name)
}

fn shipped(name: &str) -> Scene {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    Scene::read(scenes.join(format!("{name}.toml"))).unwrap()
}

/// The numbers of the array of this name in a file of VTK.
pub(crate) fn array(text: &str, name: &str) -> Vec<f64> {
    let (_, rest) = text.split_once(&format!("Name=\"{name}\"")).unwrap();
    let (_, rest) = rest.split_once('>').unwrap();
    let (numbers, _) = rest.split_once("</DataArray>").unwrap();
    numbers.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

#[test]
fn paraview_reads_the_bits_of_the_run() {
    let run = shipped("breaking-bridge").with_horizon(0.2).unwrap().run().unwrap();
    let out = folder("vtk");
    run.write_vtk(&out).unwrap();
    let index = fs::read_to_string(out.join("trajectory.pvd")).unwrap();
    let sets: Vec<&str> = index.lines().filter(|line| line.starts_with("<DataSet")).collect();
    assert_eq!(sets.len(), run.times().len());
    let attribute = |line: &str, name: &str| -> String {
        let (_, rest) = line.split_once(&format!("{name}=\"")).unwrap();
        rest.split('"').next().unwrap().to_owned()
    };
    let mut rods_left = Vec::new();
    for (sample, line) in sets.iter().enumerate() {
        assert_eq!(attribute(line, "timestep").parse(), Ok(run.times()[sample]));
        let text = fs::read_to_string(out.join(attribute(line, "file"))).unwrap();
        let points = array(&text, "points");
        let planar: Vec<f64> =
            points.chunks_exact(3).flat_map(|point| [point[0], point[1]]).collect();
        assert_eq!(planar, run.positions(sample));
        assert!(points.chunks_exact(3).all(|point| point[2] == 0.0));

        let (kinds, types) = (array(&text, "kind"), array(&text, "types"));
        let (ends, offsets) = (array(&text, "connectivity"), array(&text, "offsets"));
        assert_eq!(attribute(&text, "NumberOfCells").parse(), Ok(kinds.len()));
        assert_eq!([types.len(), offsets.len()], [kinds.len(); 2]);
        assert_eq!(offsets.last().map(|&last| last as usize), Some(ends.len()));
        assert_eq!(kinds.iter().filter(|&&kind| kind == 0.0).count(), 12);
        assert_eq!(kinds.iter().filter(|&&kind| kind == 1.0).count(), 1);
        // The spring is the cell behind the twelve points.
        assert_eq!((types[12], &ends[12..14]), (3.0, &[3.0, 11.0][..]));
        rods_left.push(kinds.iter().filter(|&&kind| kind == 2.0).count());
    }
    assert_eq!(rods_left[0], 18);
    assert_eq!(rods_left.last(), Some(&(18 - run.broken().len())));
    assert!(!run.broken().is_empty());
}

/// What the scripts of a page read, and the page.
pub(crate) fn page(run: &Run, name: &str) -> (Value, String) {
    let out = folder(name);
    run.write(&out).unwrap();
    let page = fs::read_to_string(out.join("player.html")).unwrap();
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    let (data, _) = rest.split_once("</script>").unwrap();
    (serde_json::from_str(data).unwrap(), page)
}

fn singles(data: &Value) -> Vec<f64> {
    use base64::Engine;
    let bytes = base64::engine::general_purpose::STANDARD.decode(data.as_str().unwrap()).unwrap();
    bytes.as_chunks::<4>().0.iter().map(|&x| f64::from(f32::from_le_bytes(x))).collect()
}

#[test]
fn the_page_has_every_sample_to_seven_digits_of_the_scene() {
    let run = shipped("thrown-racket").run().unwrap();
    let (data, page) = page(&run, "racket");
    let (positions, origin) = (singles(&data["positions"]), &data["origin"]);
    let all: Vec<f64> = (0..run.times().len()).flat_map(|i| run.positions(i).to_vec()).collect();
    let size = all.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    assert_eq!(positions.len(), all.len());
    for (k, (shown, x)) in positions.iter().zip(&all).enumerate() {
        let shown = shown + origin[k % 3].as_f64().unwrap();
        assert!((shown - x).abs() <= 1e-7 * size, "{shown} {x}");
    }
    assert!(page.contains(&format!("All {} samples are shown.", run.times().len())));
    assert!(page.len() < 1_000_000);

    // The drift of the energy, which rounding to 32 bits would hide in the energy itself.
    let drift = &data["charts"][0];
    assert_eq!(drift["title"], "drift of the energy");
    let (energies, shown) = (run.energies(), singles(&drift["lines"][0]["changes"]));
    let last = energies[energies.len() - 1] - energies[0];
    assert!((shown[shown.len() - 1] - last).abs() <= 1e-6 * last.abs());
}

#[test]
fn the_page_of_a_long_run_is_bounded_and_says_what_it_leaves_out() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/outer-solar-system.toml");
    let fine = fs::read_to_string(file).unwrap().replace("sample_every = 10", "sample_every = 1");
    let fine = Scene::parse("fine", &fine.replace("horizon = 200_000", "horizon = 700_000"));
    let run = fine.unwrap().run().unwrap();
    let (data, page) = page(&run, "fine");
    let shown = singles(&data["positions"]).len() / 18;
    assert!(run.times().len() == 70_001 && (50_000..60_000).contains(&shown), "{shown}");
    assert!(page.contains(&format!("{shown} of 70001 samples are shown, evenly chosen")));
    assert!(page.len() < 10_000_000, "{}", page.len());
}

#[test]
fn a_title_cannot_end_an_element_of_the_page() {
    let scene = "title = \"</script><script>alert(1)</script> {{data}} & <b>\"\ndimension = 1\n\
                 integrator = \"stormer-verlet\"\nstep = 0.5\nhorizon = 1\n\
                 units = { length = \"</script>\" }\n\
                 particles = [{ name = \"a\", mass = 1, position = [0], velocity = [1] }]";
    let run = Scene::parse("bad.toml", scene).unwrap().run().unwrap();
    let (data, page) = page(&run, "title");
    assert_eq!(page.matches("</script>").count(), 2);
    assert_eq!(page.matches("<script").count(), 2);
    assert_eq!(data["units"]["length"], "</script>");
    assert!(page.contains("{{data}} &amp; &lt;b&gt;"));
}

#[test]
fn the_page_names_nothing_outside_of_itself() {
    let run = shipped("heavy-top").with_horizon(0.01).unwrap().run().unwrap();
    let (_, page) = page(&run, "top");
    for reference in ["http://", "https://", "src=", "@import", "fetch(", "url("] {
        assert!(!page.contains(reference), "{reference}");
    }
}

#[test]
fn rods_that_break_leave_the_page_and_the_film_at_their_time() {
    let run = shipped("breaking-bridge").run().unwrap();
    let (data, _) = page(&run, "bridge");
    let broken: Vec<(u64, f64)> = serde_json::from_value(data["broken"].clone()).unwrap();
    let expected: Vec<(u64, f64)> = run.broken().iter().map(|b| (b.rod as u64, b.time)).collect();
    assert_eq!(broken, expected);
    let film = run.film();
    let rods: Vec<usize> = film
        .split("<path ")
        .filter(|path| path.starts_with("class=\"strong pen\" stroke-width=\"2\""))
        .map(|line| line.matches('M').count())
        .collect();
    assert_eq!((rods.len(), rods[0]), (6, 18));
    assert_eq!(rods[5], 18 - run.broken().len());
    assert!(rods.is_sorted_by(|a, b| a >= b));
}

/// Round bodies of one scene each, in the plane and in space.
fn rolling(dimension: usize) -> Run {
    let [positions, floor, spin] = match dimension {
        2 => [["[0, 0.2]", "[1, 0.1]"], ["[0, 1]", "[0, 0]"], ["-5", "3"]],
        _ => {
            [["[0, 0, 0.2]", "[1, 0, 0.1]"], ["[0, 0, 1]", "[0, 0, 0]"], ["[0, 5, 0]", "[1, 0, 2]"]]
        }
    };
    let velocity = if dimension == 2 { "[1, 0]" } else { "[1, 0, 0]" };
    let method = if dimension == 2 { "stormer-verlet" } else { "variational-rotation" };
    let scene = format!(
        "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.01\nhorizon = 1\n\
         bodies = [{{ name = \"wheel\", mass = 1, ball = 0.2, position = {}, velocity = {velocity}, \
         angular_velocity = {} }}, {{ name = \"top\", mass = 1, ball = 0.1, position = {}, \
         angular_velocity = {} }}]\n\
         [contact]\nfriction = 0.5\nwalls = [{{ normal = {}, at = {} }}]",
        positions[0], spin[0], positions[1], spin[1], floor[0], floor[1],
    );
    Scene::parse("rolling", &scene).unwrap().run().unwrap()
}

#[test]
fn the_page_knows_how_every_ball_is_turned_at_every_sample() {
    for dimension in [2, 3] {
        let run = rolling(dimension);
        let (data, page) = page(&run, "rolling");
        assert_eq!(singles(&data["radii"]), [0.2_f32, 0.1].map(f64::from));
        let expected: Vec<f64> = (0..run.times().len())
            .flat_map(|sample| run.bodies(sample))
            .flat_map(|body| match dimension {
                2 => vec![body.angle],
                _ => body.orientation.to_vec(),
            })
            .collect();
        let turns = singles(&data["turns"]);
        assert_eq!(turns.len(), expected.len());
        assert!(turns.iter().zip(&expected).all(|(turn, x)| (turn - x).abs() <= 1e-6));
        // They do turn.
        let each = turns.len() / run.times().len();
        let moved =
            turns[turns.len() - each..].iter().zip(&turns).map(|(x, from)| (x - from).abs());
        assert!(moved.fold(0.0, f64::max) > 0.5);
        let way = if dimension == 3 { "the shorter way" } else { "evenly" };
        assert!(page.contains(&format!(", and what is round turns {way}.")));
    }
}

#[test]
fn particles_are_round_and_do_not_turn() {
    let run = shipped("newtons-cradle").with_horizon(0.01).unwrap().run().unwrap();
    let (data, page) = page(&run, "round");
    assert_eq!(singles(&data["radii"]), [f64::from(0.05_f32); 5]);
    assert_eq!(data["turns"], "");
    assert!(!page.contains("and balls turn"));
}

#[test]
fn what_is_nothing_but_rounding_does_not_fill_a_chart() {
    let scenes =
        ["newtons-cradle", "nine-ball-break", "warm-sphere", "tumbling-wrench", "box-stack"];
    let mut rounded = 0;
    for name in scenes {
        let (data, _) = page(&shipped(name).run().unwrap(), name);
        for chart in data["charts"].as_array().unwrap() {
            let least = chart["least"].as_f64().unwrap();
            let moved = chart["lines"]
                .as_array()
                .unwrap()
                .iter()
                .flat_map(|line| singles(&line["changes"]))
                .fold(0.0_f64, |moved, x| moved.max(x.abs()));
            // Rounding is told from motion, which is larger by a thousand of the least axes.
            assert!(moved <= 0.25 * least || moved >= 1e3 * least, "{name}: {moved} {least}");
            rounded += usize::from(moved <= 0.25 * least);
        }
    }
    assert!(rounded >= 6, "{rounded}");
}

#[test]
fn the_scale_of_heat_holds_every_sample_and_more_than_rounding() {
    let (data, _) = page(&shipped("warm-sphere").run().unwrap(), "scale");
    let field = &data["field"];
    let [least, largest] = ["least", "largest"].map(|end| field[end].as_f64().unwrap());
    assert_eq!([least, largest], [0.0, 2.0]);
    assert!(singles(&field["values"]).iter().all(|x| (least..=largest).contains(x)));
    assert_eq!([&field["title"], &field["unit"]], ["temperature", "the scene's unit"]);
    // Warm all over, it stays so: the colours are not those of rounding.
    let text = "dimension = 2\nintegrator = \"implicit-euler\"\nstep = 0.1\nhorizon = 1\n[heat]\n\
                name = \"plate\"\nshape = { kind = \"rectangle\", size = [1, 1], cells = [6, 6] }\n\
                diffusivity = 1\nwarm = [{ at = [0.5, 0.5], radius = 2, temperature = 300 }]";
    let run = Scene::parse("even", text).unwrap().run().unwrap();
    let (data, _) = page(&run, "even");
    let [least, largest] = ["least", "largest"].map(|end| data["field"][end].as_f64().unwrap());
    for value in singles(&data["field"]["values"]) {
        let along = (value - least) / (largest - least);
        assert!((0.2..0.8).contains(&along), "{value} between {least} and {largest}");
    }
}

#[test]
fn the_film_shows_six_moments_to_one_scale() {
    let run = shipped("heavy-top").run().unwrap();
    let film = run.film();
    for time in ["0", "0.4", "0.8", "1.2", "1.6", "2"] {
        assert!(film.contains(&format!(">t = {time} s<")), "{time}");
    }
    assert_eq!(film.matches("<g transform").count(), 6);
}

#[test]
fn a_run_on_a_line_is_written_like_any_other() {
    let scene = "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 2\n\
                 particles = [{ name = \"a\", mass = 1, position = [0] },\n\
                 { name = \"b\", mass = 1, position = [2] }]\n\
                 springs = [{ between = [\"a\", \"b\"], stiffness = 3, rest_length = 1 }]";
    let run = Scene::parse("line", scene).unwrap().run().unwrap();
    let (data, _) = page(&run, "line");
    assert_eq!(data["dimension"], 1);
    assert_eq!(singles(&data["positions"]).len(), 2 * run.times().len());
    assert!(run.film().contains("<path class=\"strong pen\" stroke-width=\"0.9\""));
}

#[test]
fn every_file_of_a_run_is_one_that_is_tried_before_it() {
    let out = folder("all-files");
    fs::remove_dir_all(&out).ok();
    let scenes = ["breaking-bridge", "cantilever", "warm-sphere", "nine-ball-break", "box-stack"];
    for name in scenes {
        let scene = shipped(name);
        let end = 2.0 * scene.timing().step();
        let run = scene.with_horizon(end).unwrap().run().unwrap();
        stationary_scene::make_folder(&out).unwrap();
        run.write(&out).unwrap();
        run.write_vtk(&out).unwrap();
    }
    let mut written: Vec<String> = fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "trajectory")
        .collect();
    written.sort();
    let mut tried = Run::FILES.map(str::to_owned).to_vec();
    tried.sort();
    assert_eq!(written, tried);
}

#[test]
fn a_folder_is_tried_without_changing_a_byte_of_what_is_there() {
    let out = folder("tried");
    fs::remove_dir_all(&out).ok();
    stationary_scene::make_folder(out.join("deep")).unwrap();
    fs::write(out.join("bodies.csv"), "mine").unwrap();
    stationary_scene::make_folder(&out).unwrap();
    assert_eq!(fs::read_to_string(out.join("bodies.csv")).unwrap(), "mine");
    assert_eq!(fs::read_dir(&out).unwrap().count(), 2);
    let error = stationary_scene::make_folder(out.join("bodies.csv")).unwrap_err().to_string();
    assert!(
        error.ends_with("bodies.csv: cannot be written: it is a file; name a folder"),
        "{error}"
    );
    fs::create_dir(out.join("stress.csv")).unwrap();
    let error = stationary_scene::make_folder(&out).unwrap_err();
    assert_eq!(error.path, out.join("stress.csv"));
}
