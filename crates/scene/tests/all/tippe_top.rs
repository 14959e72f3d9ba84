//! The shipped tippe-top against the smooth equations of a sphere that slides.
//!
//! ```text
//! m v' = N (z - mu u/|u|) - m g z,   L' = r x F,   u = v + w x r,   r = d e - R z,   e' = w x e
//! N from  v_z = -d e_z'                                   the lowest point stays on the table
//! ```
//! `e` the axis, `d` how far the centre of mass is below the middle, `L = I1 (w - (w.e) e) + I3 (w.e) e`.
//! Classical method of order 4. Source: Ebenfeld and Scheck 1995.

use nalgebra::Vector3;
use stationary_scene::{Run, Scene};

type V = Vector3<f64>;

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.02;
const MASS: f64 = 0.02;
const BELOW: f64 = 0.002;
const I3: f64 = 0.4 * 0.01 * (RADIUS * RADIUS + 0.002 * 0.002);
const I1: f64 = I3 + 0.005 * 0.004 * 0.004;

/// Horizontal velocity of the centre of mass, axis and angular velocity.
type Top = [V; 3];

struct Rates {
    top: Top,
    slip: f64,
    /// Over the weight.
    normal: f64,
}

fn rates(&[v, e, w]: &Top, friction: f64) -> Rates {
    let spread =
        |x: V, across: f64, along: f64| (x - e * x.dot(&e)) * across + e * (x.dot(&e) * along);
    let r = e * BELOW - V::z() * RADIUS;
    let mut u = v + w.cross(&r);
    u.z = 0.0;
    let push = V::z() - u * (friction / u.norm());
    let free = spread(-w.cross(&spread(w, I1, I3)), I1.recip(), I3.recip());
    let pushed = spread(r.cross(&push), I1.recip(), I3.recip());
    let up = (free.cross(&e) + w.cross(&w.cross(&e))).z;
    let normal = MASS * (GRAVITY - BELOW * up) / (1.0 + MASS * BELOW * pushed.cross(&e).z);
    let mut along = push * (normal / MASS);
    along.z = 0.0;
    let top = [along, w.cross(&e), free + pushed * normal];
    Rates { top, slip: u.norm(), normal: normal / (MASS * GRAVITY) }
}

fn moved(top: &Top, rate: &Top, h: f64) -> Top {
    [0, 1, 2].map(|k| top[k] + rate[k] * h)
}

/// The top some seconds later, and the least slip and normal force on the way.
fn slide(mut top: Top, friction: f64, time: f64, h: f64) -> (Top, f64, f64) {
    let (mut slip, mut normal) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..(time / h).round() as usize {
        let first = rates(&top, friction);
        (slip, normal) = (slip.min(first.slip), normal.min(first.normal));
        let second = rates(&moved(&top, &first.top, 0.5 * h), friction).top;
        let third = rates(&moved(&top, &second, 0.5 * h), friction).top;
        let fourth = rates(&moved(&top, &third, h), friction).top;
        let mean =
            [0, 1, 2].map(|k| (first.top[k] + second[k] * 2.0 + third[k] * 2.0 + fourth[k]) / 6.0);
        top = moved(&top, &mean, h);
    }
    (top, slip, normal)
}

/// The shipped scene to a time, with other words in it.
fn run(words: &[[&str; 2]], h: f64, horizon: f64) -> Run {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/tippe-top.toml");
    let mut text = std::fs::read_to_string(path).unwrap();
    let step = format!("step = {h}");
    let horizon = format!("horizon = {horizon}");
    for [from, to] in [["step = 0.0001", &step], ["horizon = 5", &horizon]].iter().chain(words) {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let claims = text.find("[[claims]]").unwrap();
    Scene::parse("top.toml", &text[..claims]).unwrap().run().unwrap()
}

#[test]
fn while_it_slides_steps_lead_to_the_smooth_motion_at_order_one() {
    let tilt = 0.3_f64;
    let start = [V::zeros(), V::new(0.0, -tilt.sin(), tilt.cos()), V::z() * 300.0];
    let (smooth, slip, normal) = slide(start, 0.1, 1.5, 1e-5);
    // It slides all the way, and is held to the table.
    assert!(slip > 0.1 && normal > 0.5 && smooth[1].z < 0.1, "{slip} {normal} {smooth:?}");
    let height = RADIUS - BELOW * slide(start, 0.1, 0.5, 1e-5).0[1].z;
    let off = |h: f64| {
        let run = run(&[], h, 0.5);
        run.positions(run.times().len() - 1)[2] - height
    };
    let off = [4e-4, 2e-4, 1e-4].map(off);
    let orders = [off[0] / off[1], off[1] / off[2]].map(f64::log2);
    assert!(orders.iter().all(|order| (0.7..1.4).contains(order)), "{off:?} {orders:?}");
}

#[test]
fn one_that_rolls_is_turned_over_by_nothing_but_the_error_of_its_steps() {
    let tilt = 0.1_f64;
    let axis = V::new(0.0, -tilt.sin(), tilt.cos());
    // Friction along one direction stops the slip, after which nothing takes energy.
    let (_, slip, _) = slide([V::zeros(), axis, axis * 400.0], 0.3, 0.05, 1e-6);
    assert!(slip < 1e-3, "{slip}");
    let words = [
        ["tilt = 0.3", "tilt = 0.1"],
        ["n = 300", "n = 400"],
        ["\"= n*sin(tilt)\", \"= n*cos(tilt)\"", "0, \"= n\""],
        ["friction = 0.1", "friction = 0.3"],
    ];
    // How fast the nodding grows, 1/s.
    let growth = |h: f64| {
        let run = run(&words, h, 0.5);
        let across = run
            .headings()
            .iter()
            .position(|name| name.starts_with("angular velocity of top x"))
            .unwrap();
        let nod = |t: f64| {
            let sample = run.times().iter().position(|time| (time - t).abs() < 1e-9).unwrap();
            let observed = run.observed(sample);
            observed[across].hypot(observed[across + 1])
        };
        (nod(0.5) / nod(0.1)).ln() / 0.4
    };
    let growth = [2e-4, 1e-4].map(growth);
    // Twice as fast at twice the step: none is left in the limit.
    let part = growth[0] / growth[1];
    assert!(growth[1] > 0.5 && (part - 2.0).abs() < 0.2, "{growth:?}");
}
