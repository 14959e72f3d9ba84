//! Families of stiff problems: reactions with rates over many decades, relaxation oscillations, and
//! fast parts that are driven along a known path.

use super::problem::InitialValue;
use crate::Draw;

/// A reaction: what goes in, what comes out, and its rate by mass action.
#[derive(Clone, Debug)]
struct Reaction {
    takes: Vec<usize>,
    gives: Vec<usize>,
    rate: f64,
}

fn mass_action(
    reactions: Vec<Reaction>,
    start: Vec<f64>,
    end: f64,
    sizes: Vec<f64>,
) -> InitialValue {
    let n = start.len();
    let again = reactions.clone();
    InitialValue {
        name: "kinetics",
        slope: Box::new(move |_, y, f| {
            f.fill(0.0);
            for Reaction { takes, gives, rate } in &reactions {
                let speed = takes.iter().fold(*rate, |speed, &i| speed * y[i]);
                takes.iter().for_each(|&i| f[i] -= speed);
                gives.iter().for_each(|&i| f[i] += speed);
            }
        }),
        derivative: Box::new(move |_, y, df| {
            df.fill(0.0);
            for Reaction { takes, gives, rate } in &again {
                for (place, &j) in takes.iter().enumerate() {
                    let others = takes.iter().enumerate().filter(|&(other, _)| other != place);
                    let speed = others.fold(*rate, |speed, (_, &i)| speed * y[i]);
                    takes.iter().for_each(|&i| df[i + n * j] -= speed);
                    gives.iter().for_each(|&i| df[i + n * j] += speed);
                }
            }
        }),
        start,
        end,
        sizes,
        truth: None,
        stiff: true,
        masses: None,
        energy: None,
    }
}

/// A random network that neither makes nor loses molecules, rates over up to nine decades.
pub fn network(draw: &mut Draw) -> InitialValue {
    let n = draw.between(2, 7);
    let count = draw.between(n, 2 * n + 2);
    let decades = draw.uniform(0.0, 9.0);
    let reactions: Vec<Reaction> = (0..count)
        .map(|i| {
            let pair = draw.chance(0.4);
            // Each kind of molecule reacts at least once.
            let first = if i < n { i } else { draw.below(n) };
            let (mut takes, mut gives) = (vec![first], vec![draw.below(n)]);
            if pair {
                takes.push(draw.below(n));
                gives.push(draw.below(n));
            }
            Reaction { takes, gives, rate: 10_f64.powf(draw.uniform(-0.4, 0.6) * decades) }
        })
        .collect();
    let mut start: Vec<f64> =
        (0..n).map(|_| if draw.chance(0.5) { draw.unit() } else { 0.0 }).collect();
    start[0] += 1.0;
    let end = draw.log_uniform(0.1, 1e3);
    let reactions = that_happen(reactions, &start);
    draw.note(format!("network {reactions:?} from {start:?} until {end}"));
    let total: f64 = start.iter().sum();
    mass_action(reactions, start, end, vec![total; n])
}

/// The reactions whose molecules are there or come to be there. The others never begin, unless the
/// rounding of the one who integrates them begins them.
fn that_happen(reactions: Vec<Reaction>, start: &[f64]) -> Vec<Reaction> {
    let mut there: Vec<bool> = start.iter().map(|&y| y > 0.0).collect();
    for _ in 0..start.len() {
        for reaction in &reactions {
            if reaction.takes.iter().all(|&i| there[i]) {
                reaction.gives.iter().for_each(|&i| there[i] = true);
            }
        }
    }
    let happens = |reaction: &Reaction| reaction.takes.iter().all(|&i| there[i]);
    reactions.into_iter().filter(happens).collect()
}

/// Three reactions like Robertson's: slow decay, fast catalysis, and a very fast reaction between
/// two of one kind.
pub fn catalysis(draw: &mut Draw) -> InitialValue {
    let rates =
        [draw.log_uniform(1e-3, 1.0), draw.log_uniform(1e2, 1e6), draw.log_uniform(1e4, 1e9)];
    let end = draw.log_uniform(0.3, 1e4);
    draw.note(format!("catalysis at {rates:?} until {end}"));
    let reactions = vec![
        Reaction { takes: vec![0], gives: vec![1], rate: rates[0] },
        Reaction { takes: vec![1, 2], gives: vec![0, 2], rate: rates[1] },
        Reaction { takes: vec![1, 1], gives: vec![1, 2], rate: rates[2] },
    ];
    mass_action(reactions, vec![1.0, 0.0, 0.0], end, vec![1.0, 1e-4, 1.0])
}

/// Twelve changes of seven kinds into each other, and a binding of two of eight that is undone three
/// ways, at any rates.
pub fn response(draw: &mut Draw) -> InitialValue {
    let mut rate = |from: f64, to: f64| draw.log_uniform(from, to);
    let k: [f64; 9] = std::array::from_fn(|_| rate(0.02, 20.0));
    let (binding, feed, free) = (rate(1.0, 1e4), rate(1e-5, 1e-2), rate(1e-3, 1e-1));
    let (chosen, part) = (draw.chance(0.3), draw.uniform(0.1, 0.9));
    let latest = draw.log_uniform(3000.0, 100.0);
    draw.note(format!(
        "response at {k:?}, binding {binding}, feed {feed}, {free} free, latest {latest}, {chosen}, {part}"
    ));
    // Linear rates as (from, to, rate): what leaves `from` arrives at `to`.
    let linear = [
        (0, 1, k[0]),
        (1, 0, k[1]),
        (2, 0, k[2]),
        (3, 2, k[1]),
        (4, 2, k[4]),
        (1, 3, k[5]),
        (2, 3, k[6]),
        (3, 5, k[3]),
        (4, 5, k[7]),
        (5, 4, k[1]),
        (6, 4, k[1]),
        (6, 5, k[8]),
    ];
    // What leaves 6 by all three ways arrives at 7, too.
    let (again, lost, gained) = (linear, k[3], k[1] + k[8] + k[3]);
    let problem = InitialValue {
        name: "response",
        slope: Box::new(move |_, y, f| {
            f.fill(0.0);
            f[0] = feed;
            for (from, to, rate) in linear {
                f[from] -= rate * y[from];
                f[to] += rate * y[from];
            }
            let bound = binding * y[5] * y[7];
            f[5] -= bound;
            f[6] += bound - lost * y[6];
            f[7] += gained * y[6] - bound;
        }),
        derivative: Box::new(move |_, y, df| {
            df.fill(0.0);
            for (from, to, rate) in again {
                df[from + 8 * from] -= rate;
                df[to + 8 * from] += rate;
            }
            df[6 + 8 * 6] -= lost;
            df[7 + 8 * 6] += gained;
            for (row, sign) in [(5, -1.0), (6, 1.0), (7, -1.0)] {
                df[row + 8 * 5] += sign * binding * y[7];
                df[row + 8 * 7] += sign * binding * y[5];
            }
        }),
        start: vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, free],
        end: latest,
        sizes: vec![0.01; 8],
        truth: None,
        stiff: true,
        masses: None,
        energy: None,
    };
    // Where nobody chose the end, it lies where the response is on its way: there an error shows.
    let end = match chosen {
        true => latest,
        false => turn(&problem, part).unwrap_or(latest),
    };
    InitialValue { end, ..problem }
}

/// The time at which the last kind, bound at first, has come back to this part of its start.
fn turn(problem: &InitialValue, part: f64) -> Option<f64> {
    let followed = problem.reference(&problem.begin(), &[problem.end], 1e-6)?;
    let turned = followed.way.iter().rfind(|(_, y)| y[7] < part * problem.start[7]);
    turned.map(|(t, _)| *t)
}

/// Van der Pol's oscillator, mild to very stiff.
pub fn relaxation(draw: &mut Draw) -> InitialValue {
    let mu = draw.log_uniform(1.0, 1e3);
    let start = vec![draw.uniform(1.0, 2.5), draw.symmetric()];
    let end = mu * draw.uniform(0.05, 1.5);
    draw.note(format!("relaxation, mu {mu} from {start:?} until {end}"));
    InitialValue {
        name: "relaxation",
        slope: Box::new(move |_, y, f| {
            f[0] = y[1];
            f[1] = mu * (1.0 - y[0] * y[0]) * y[1] - y[0];
        }),
        derivative: Box::new(move |_, y, df| {
            let square = 1.0 - y[0] * y[0];
            df.copy_from_slice(&[0.0, -2.0 * mu * y[0] * y[1] - 1.0, 1.0, mu * square]);
        }),
        start,
        end,
        sizes: vec![1.0; 2],
        truth: None,
        stiff: true,
        masses: None,
        energy: None,
    }
}

/// Prothero and Robinson: `y_i' = -rate_i (y_i - g_i(t)) + g_i'(t)`, whose solution is `g`.
pub fn driven(draw: &mut Draw) -> InitialValue {
    let n = draw.between(1, 3);
    let rates: Vec<f64> = (0..n).map(|_| draw.log_uniform(1.0, 1e8)).collect();
    let waves: Vec<[f64; 3]> =
        (0..n).map(|_| [draw.symmetric(), draw.log_uniform(0.3, 10.0), draw.symmetric()]).collect();
    let end = draw.uniform(0.3, 5.0);
    draw.note(format!("driven at {rates:?} along {waves:?} until {end}"));
    let at = move |waves: &[[f64; 3]], t: f64| -> Vec<f64> {
        waves.iter().map(|[a, w, b]| 1.0 + a * (w * t).sin() + b * (w * t).cos()).collect()
    };
    let (slopes, paths, again) = (rates.clone(), waves.clone(), waves.clone());
    InitialValue {
        name: "driven",
        slope: Box::new(move |t, y, f| {
            for (i, [a, w, b]) in paths.iter().enumerate() {
                let (sin, cos) = (w * t).sin_cos();
                let (g, dg) = (1.0 + a * sin + b * cos, w * (a * cos - b * sin));
                f[i] = -slopes[i] * (y[i] - g) + dg;
            }
        }),
        derivative: Box::new(move |_, _, df| {
            df.fill(0.0);
            for (i, rate) in rates.iter().enumerate() {
                df[i + n * i] = -rate;
            }
        }),
        start: at(&waves, 0.0),
        end,
        sizes: vec![1.0; n],
        truth: Some(Box::new(move |t| at(&again, t))),
        stiff: true,
        masses: None,
        energy: None,
    }
}
