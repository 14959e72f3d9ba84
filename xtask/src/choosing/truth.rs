//! What an observable of a scene does, by the scene's own model and by none of its methods.
//!
//! ```text
//! particles   M q.. = -dV(q) - c q. + J^T lambda,   J q.. = -J. q.          the scene's own V
//! a body      I w. = (I w) x w + r x F,   R. = R [w]                         about its joint, or free
//! heat        f(t) = f* + exp(-alpha M^-1 K t) (f(0) - f*)                   all modes, dense
//! impacts     parabolas from one impact to the next
//! friction    x(t) = x0 + v t + a t^2 / 2 to its rest
//! ```

use nalgebra::{DMatrix, DVector, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};
use stationary_calculus::{Covector, Potential};
use stationary_scene::{Motion, Observable, Scene, Simplices};
use stationary_trials::kinds::integrators::reference::Slope;

use super::flow;

/// The truth at some times.
pub struct Known {
    /// The observable's numbers at each.
    pub values: Vec<Vec<f64>>,
    /// How far two ways to it are apart.
    pub uncertain: f64,
}

/// What the scene's first observable is at ascending times.
///
/// # Errors
/// In words, where it is not known.
pub fn truth(scene: &Scene, times: &[f64]) -> Result<Known, String> {
    if scene.heat().is_some() {
        return heat(scene, times);
    }
    if !scene.bodies().is_empty() {
        return match scene.contact() {
            Some(_) => sliding(scene, times),
            None => turning(scene, times),
        };
    }
    if scene.contact().is_some() {
        return bouncing(scene, times);
    }
    moving(scene, times)
}

fn asked(scene: &Scene) -> Result<Observable, String> {
    scene.observables().first().copied().ok_or_else(|| "nothing is observed".to_owned())
}

/// The place of a particle among the free ones, or where it is pinned.
enum End {
    Free(usize),
    Fixed([f64; 3]),
}

fn ends(scene: &Scene) -> Vec<End> {
    let mut free = 0;
    let end = |particle: &stationary_scene::Particle| match particle.motion {
        Motion::Free { .. } => {
            free += 1;
            End::Free(free - 1)
        }
        _ => End::Fixed(particle.position),
    };
    scene.particles().iter().map(end).collect()
}

/// Component `c` of a particle, and 0 of one that is pinned where speeds are meant.
fn component(end: &End, x: &[f64], c: usize, d: usize) -> f64 {
    match end {
        End::Free(vertex) => x[d * vertex + c],
        End::Fixed(place) => place[c],
    }
}

fn moving(scene: &Scene, times: &[f64]) -> Result<Known, String> {
    let d = scene.dimension();
    let problem = scene.problem().map_err(|error| error.to_string())?;
    let seen = scene.problem().map_err(|error| error.to_string())?;
    let mut masses = Vec::new();
    for particle in scene.particles() {
        if let Motion::Free { mass, .. } = particle.motion {
            masses.extend(std::iter::repeat_n(mass, d));
        }
    }
    let (n, q) = (masses.len(), problem.initial.q.clone());
    let p = problem.initial.p.components();
    let v: Vec<f64> = p.iter().zip(&masses).map(|(p, m)| p / m).collect();
    let (size, horizon) = (problem.scale, scene.timing().horizon());
    let speed = v.iter().fold(size / horizon, |speed, v| speed.max(v.abs()));
    let sizes = [vec![size; n], vec![speed; n]].concat();
    let (rods, of_rods) = (scene.rods().to_vec(), ends(scene));
    let (drag, weights) = (scene.drag().unwrap_or(0.0), masses.clone());
    let slope: Slope = Box::new(move |_, y, f| {
        let (q, v) = y.split_at(n);
        let (dq, dv) = f.split_at_mut(n);
        dq.copy_from_slice(v);
        dv.fill(0.0);
        problem.system.potential().add_differential(q, Covector(&mut *dv));
        for i in 0..n {
            dv[i] = -(dv[i] + drag * v[i]) / weights[i];
        }
        if rods.is_empty() {
            return;
        }
        let mut rows = DMatrix::zeros(rods.len(), n);
        let mut right = DVector::zeros(rods.len());
        for (row, rod) in rods.iter().enumerate() {
            let [a, b] = rod.ends.map(|end| &of_rods[end]);
            for c in 0..d {
                let apart = component(b, q, c, d) - component(a, q, c, d);
                for (end, sign) in [(a, -1.0), (b, 1.0)] {
                    if let End::Free(vertex) = end {
                        rows[(row, d * vertex + c)] = sign * apart;
                    }
                }
                let speed = |end: &End| match end {
                    End::Free(vertex) => v[d * vertex + c],
                    End::Fixed(_) => 0.0,
                };
                right[row] -= (speed(b) - speed(a)).powi(2);
            }
        }
        let free = DVector::from_column_slice(dv);
        let per_mass = DMatrix::from_fn(n, rods.len(), |i, row| rows[(row, i)] / weights[i]);
        let multipliers = (&rows * &per_mass).lu().solve(&(right - &rows * &free));
        let Some(multipliers) = multipliers else { return dv.fill(f64::NAN) };
        let forced = free + per_mass * multipliers;
        dv.copy_from_slice(forced.as_slice());
    });
    let (observable, of_particles) = (asked(scene)?, ends(scene));
    let observe = |y: &[f64]| {
        let (q, v) = y.split_at(n);
        let kinetic = || v.iter().zip(&masses).map(|(v, m)| 0.5 * m * v * v).sum::<f64>();
        let potential = || seen.system.potential().energy(q);
        let place = |particle: usize| (0..d).map(move |c| (particle, c)).collect::<Vec<_>>();
        match observable {
            Observable::Energy => vec![kinetic() + potential()],
            Observable::KineticEnergy => vec![kinetic()],
            Observable::PotentialEnergy => vec![potential()],
            Observable::AngularMomentum => {
                let mut total = Vector3::zeros();
                for (i, (q, v)) in q.chunks(d).zip(v.chunks(d)).enumerate() {
                    let full =
                        |x: &[f64]| Vector3::from_fn(|c, _| x.get(c).copied().unwrap_or(0.0));
                    total += masses[d * i] * full(q).cross(&full(v));
                }
                if d == 2 { vec![total.z] } else { total.iter().copied().collect() }
            }
            Observable::Position(particle) => place(particle)
                .into_iter()
                .map(|(particle, c)| component(&of_particles[particle], q, c, d))
                .collect(),
            Observable::Velocity(particle) => place(particle)
                .into_iter()
                .map(|(particle, c)| match of_particles[particle] {
                    End::Free(vertex) => v[d * vertex + c],
                    End::Fixed(_) => 0.0,
                })
                .collect(),
            Observable::Distance([a, b]) => {
                let at = |particle: usize, c| component(&of_particles[particle], q, c, d);
                vec![(0..d).map(|c| (at(a, c) - at(b, c)).powi(2)).sum::<f64>().sqrt()]
            }
            _ => vec![f64::NAN],
        }
    };
    flow::observed(slope, [q, v].concat(), &sizes, times, &observe)
}

/// One body, free or on a joint that leaves it every turn.
fn turning(scene: &Scene, times: &[f64]) -> Result<Known, String> {
    let [body] = scene.bodies() else { return Err("more than one body".to_owned()) };
    let space = scene.dimension() == 3;
    let weight = Vector3::from(scene.gravity().acceleration.unwrap_or_default());
    let (mass, centre) = (body.mass, Vector3::from(body.position));
    let turned = UnitQuaternion::from_scaled_axis(match space {
        true => Vector3::from(body.rotation),
        false => {
            Vector3::new(0.0, 0.0, body.rotation.iter().copied().find(|x| *x != 0.0).unwrap_or(0.0))
        }
    });
    let pivot = scene.joints().first().map(|joint| Vector3::from(joint.place));
    // From the pivot to the centre, in body axes.
    let arm = pivot.map_or(Vector3::zeros(), |pivot| turned.inverse() * (centre - pivot));
    let mut moments = nalgebra::Matrix3::from_diagonal(&Vector3::from(body.moments));
    if !space {
        // Only the third moment is felt.
        moments = nalgebra::Matrix3::identity() * body.moments[2];
    }
    let about = moments
        + mass * (nalgebra::Matrix3::identity() * arm.norm_squared() - arm * arm.transpose());
    let inverse = about.try_inverse().ok_or("no moments")?;
    let spin = match space {
        true => Vector3::from(body.angular_velocity),
        false => Vector3::new(
            0.0,
            0.0,
            body.angular_velocity.iter().copied().find(|x| *x != 0.0).unwrap_or(0.0),
        ),
    };
    let slope: Slope = Box::new(move |_, y, f| {
        let turn = Quaternion::new(y[0], y[1], y[2], y[3]);
        let w = Vector3::new(y[4], y[5], y[6]);
        let rate = turn * Quaternion::new(0.0, w.x, w.y, w.z) * 0.5;
        let unit = UnitQuaternion::from_quaternion(turn);
        let torque = arm.cross(&(unit.inverse() * (weight * mass)));
        let speed = inverse * ((about * w).cross(&w) + torque);
        f.copy_from_slice(&[rate.w, rate.i, rate.j, rate.k, speed.x, speed.y, speed.z]);
    });
    let start = [turned.w, turned.i, turned.j, turned.k, spin.x, spin.y, spin.z];
    let speed = spin.norm().max(1.0 / scene.timing().horizon());
    let sizes = [[1.0; 4].as_slice(), &[speed; 3]].concat();
    let thrown = Vector3::from(body.velocity);
    let joined = pivot.is_some();
    let states = flow::observed(slope, start.to_vec(), &sizes, times, &|y| y.to_vec())?;
    let observable = asked(scene)?;
    let mut values = Vec::new();
    for (y, &t) in states.values.iter().zip(times) {
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(y[0], y[1], y[2], y[3]));
        let w = Vector3::new(y[4], y[5], y[6]);
        let (x, v) = match pivot {
            Some(pivot) if joined => (pivot + turn * arm, turn * w.cross(&arm)),
            _ => (centre + thrown * t + weight * (0.5 * t * t), thrown + weight * t),
        };
        let kinetic = 0.5 * mass * v.norm_squared() + 0.5 * w.dot(&(moments * w));
        let leading = |x: Vector3<f64>| x.iter().copied().take(scene.dimension()).collect();
        values.push(match observable {
            Observable::Energy => vec![kinetic - mass * weight.dot(&x)],
            Observable::KineticEnergy => vec![kinetic],
            Observable::Position(particle) => match scene.particles()[particle].motion {
                Motion::Carried { point, .. } => leading(x + turn * Vector3::from(point)),
                _ => vec![f64::NAN],
            },
            Observable::AngularVelocity(_) if space => w.iter().copied().collect(),
            Observable::AngularVelocity(_) => vec![w.z],
            _ => vec![f64::NAN],
        });
    }
    // Of the observable, the uncertainty of an angle times the largest length that it turns.
    let length = 10.0 * (1.0 + arm.norm() + speed * speed * mass);
    Ok(Known { values, uncertain: length * states.uncertain })
}

/// Linear elements assembled anew and all their modes, by a dense solver.
fn heat(scene: &Scene, times: &[f64]) -> Result<Known, String> {
    let body = scene.heat().ok_or("no heat")?;
    let places: Vec<Vector3<f64>> =
        scene.particles().iter().map(|particle| particle.position.into()).collect();
    let n = places.len();
    let (mut stiffness, mut share) = (DMatrix::zeros(n, n), DVector::zeros(n));
    match &body.simplices {
        Simplices::Segments(all) => {
            for &[a, b] in all {
                let length: f64 = (places[b] - places[a]).norm();
                for (i, j, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    stiffness[(i, j)] += sign / length;
                }
                share[a] += 0.5 * length;
                share[b] += 0.5 * length;
            }
        }
        Simplices::Triangles(all) => {
            for corners in all {
                // The edge opposite of each corner.
                let edge = |k: usize| places[corners[(k + 2) % 3]] - places[corners[(k + 1) % 3]];
                let area = 0.5 * edge(0).cross(&edge(1)).norm();
                for i in 0..3 {
                    share[corners[i]] += area / 3.0;
                    for j in 0..3 {
                        stiffness[(corners[i], corners[j])] += edge(i).dot(&edge(j)) / (4.0 * area);
                    }
                }
            }
        }
        Simplices::Tetrahedra(_) => return Err("no heat in space".to_owned()),
    }
    let free: Vec<usize> = (0..n).filter(|&vertex| !body.held[vertex]).collect();
    let held: Vec<usize> = (0..n).filter(|&vertex| body.held[vertex]).collect();
    let within = DMatrix::from_fn(free.len(), free.len(), |i, j| stiffness[(free[i], free[j])]);
    let pull = DVector::from_fn(free.len(), |i, _| {
        -held.iter().map(|&h| stiffness[(free[i], h)] * body.start[h]).sum::<f64>()
    });
    let steady = match held.is_empty() {
        true => DVector::zeros(free.len()),
        false => within.clone().lu().solve(&pull).ok_or("no steady state")?,
    };
    let root = DVector::from_fn(free.len(), |i, _| f64::sqrt(share[free[i]]));
    let scaled =
        DMatrix::from_fn(free.len(), free.len(), |i, j| within[(i, j)] / (root[i] * root[j]));
    let modes = SymmetricEigen::new(scaled);
    let off = DVector::from_fn(free.len(), |i, _| root[i] * (body.start[free[i]] - steady[i]));
    let parts = modes.eigenvectors.transpose() * off;
    let observable = asked(scene)?;
    let mut values = Vec::new();
    for &t in times {
        let decayed = DVector::from_fn(free.len(), |i, _| {
            parts[i] * (-body.diffusivity * modes.eigenvalues[i].max(0.0) * t).exp()
        });
        let moved = &modes.eigenvectors * decayed;
        let mut f = DVector::from_column_slice(&body.start);
        for (i, &vertex) in free.iter().enumerate() {
            f[vertex] = steady[i] + moved[i] / root[i];
        }
        values.push(vec![match observable {
            Observable::Temperature(vertex) => f[vertex],
            Observable::Heat => share.dot(&f),
            Observable::DirichletEnergy => 0.5 * f.dot(&(&stiffness * &f)),
            _ => f64::NAN,
        }]);
    }
    let largest = values.iter().flatten().fold(0.0_f64, |a, x| a.max(x.abs()));
    Ok(Known { values, uncertain: 1e-12 * largest })
}

/// A lone ball between flat walls across the axes, from impact to impact.
fn bouncing(scene: &Scene, times: &[f64]) -> Result<Known, String> {
    let contact = scene.contact().ok_or("no contact")?;
    let [ball] = scene.particles() else { return Err("more than one ball".to_owned()) };
    let Motion::Free { mass, momentum } = ball.motion else {
        return Err("it is pinned".to_owned());
    };
    let weight = scene.gravity().acceleration.unwrap_or_default();
    let dimension = scene.dimension();
    let mut ways = Vec::new();
    for axis in 0..dimension {
        let mut bounds = [f64::NEG_INFINITY, f64::INFINITY];
        for wall in &contact.walls {
            if wall.normal[axis] > 0.5 {
                bounds[0] = wall.offset + ball.radius;
            } else if wall.normal[axis] < -0.5 {
                bounds[1] = -wall.offset - ball.radius;
            }
        }
        let start = (ball.position[axis], momentum[axis] / mass);
        ways.push(along(start, weight[axis], bounds, contact.restitution, times)?);
    }
    let observable = asked(scene)?;
    let value = |k: usize| match observable {
        Observable::Position(_) => ways.iter().map(|way| way[k].0).collect(),
        Observable::Energy => {
            let each = ways.iter().zip(weight);
            vec![each.map(|(way, g)| mass * (0.5 * way[k].1.powi(2) - g * way[k].0)).sum()]
        }
        _ => vec![f64::NAN],
    };
    Ok(Known { values: (0..times.len()).map(value).collect(), uncertain: 1e-12 })
}

/// Impacts after which a ball's way is not followed.
const MOST_IMPACTS: usize = 200;

/// Place and speed along a line at times.
fn along(
    (mut x, mut v): (f64, f64),
    a: f64,
    [low, high]: [f64; 2],
    restitution: f64,
    times: &[f64],
) -> Result<Vec<(f64, f64)>, String> {
    let (mut now, mut found, mut impacts) = (0.0, Vec::with_capacity(times.len()), 0);
    // The first time from now at which a bound is met by what moves towards it.
    let next = |x: f64, v: f64| {
        let mut first = (f64::INFINITY, 0.0);
        for (bound, side) in [(low, -1.0), (high, 1.0)] {
            let gap = bound - x;
            if !gap.is_finite() {
                continue;
            }
            let roots = if a == 0.0 {
                vec![gap / v]
            } else {
                let inside = v * v + 2.0 * a * gap;
                if inside < 0.0 {
                    continue;
                }
                vec![(-v + inside.sqrt()) / a, (-v - inside.sqrt()) / a]
            };
            for t in roots {
                if t > 1e-12 && side * (v + a * t) > 0.0 && t < first.0 {
                    first = (t, bound);
                }
            }
        }
        first
    };
    let mut meets = next(x, v);
    for &t in times {
        while now + meets.0 < t {
            impacts += 1;
            if impacts > MOST_IMPACTS || restitution < 1.0 && meets.0 < 1e-3 * (1.0 + now) {
                return Err("too many impacts".to_owned());
            }
            v = -restitution * (v + a * meets.0);
            (x, now) = (meets.1, now + meets.0);
            meets = next(x, v);
        }
        let s = t - now;
        found.push((x + v * s + 0.5 * a * s * s, v + a * s));
    }
    Ok(found)
}

/// A block on a slope with its weight: what is left of gravity and friction, to its rest.
fn sliding(scene: &Scene, times: &[f64]) -> Result<Known, String> {
    let contact = scene.contact().ok_or("no contact")?;
    let ([body], [wall]) = (scene.bodies(), contact.walls.as_slice()) else {
        return Err("not a block on a slope".to_owned());
    };
    let (place, velocity) = (Vector3::from(body.position), Vector3::from(body.velocity));
    let normal = Vector3::from(wall.normal);
    let weight = Vector3::from(scene.gravity().acceleration.unwrap_or_default());
    let down = weight - normal * weight.dot(&normal);
    let most = contact.friction * -weight.dot(&normal);
    let (steep, speed) = (down.norm(), velocity.norm());
    let way = if speed > 0.0 {
        velocity / speed
    } else if steep > 0.0 {
        down / steep
    } else {
        Vector3::zeros()
    };
    if speed > 0.0 && way.dot(&down) < 0.0 {
        return Err("it slides up".to_owned());
    }
    let faster = if speed > 0.0 || steep > most { steep - most } else { 0.0 };
    let rest = if faster < 0.0 { -speed / faster } else { f64::INFINITY };
    let at = |t: f64| {
        let t = t.min(rest);
        (place + way * (speed * t + 0.5 * faster * t * t), way * (speed + faster * t))
    };
    let observable = asked(scene)?;
    let value = |&t: &f64| {
        let (x, mut v) = at(t);
        if t >= rest {
            v = Vector3::zeros();
        }
        let kinetic = 0.5 * body.mass * v.norm_squared();
        match observable {
            Observable::Position(_) => x.iter().copied().collect(),
            Observable::Velocity(_) => v.iter().copied().collect(),
            Observable::KineticEnergy => vec![kinetic],
            Observable::Energy => vec![kinetic - body.mass * weight.dot(&x)],
            _ => vec![f64::NAN],
        }
    };
    Ok(Known { values: times.iter().map(value).collect(), uncertain: 1e-12 })
}
