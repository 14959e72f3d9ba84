//! Rigid bodies and point masses that stand for a scene's bodies, derived from their vertices.
//!
//! ```text
//! M = sum m_i,   c = sum m_i x_i / M,   v = sum p_i / M,   r_i = x_i - c
//! I = sum m_i (|r_i|^2 - r_i r_i^T) = R diag(I_1, I_2, I_3) R^T,   w = R^T I^-1 sum r_i x p_i
//! ```
//! `x_i` where vertex i starts, after what hangs has come to rest. Pinned vertices have no mass
//! here: pinned at one place a body turns about it, pinned at several it stays where it is. A point
//! mass lies where the observed vertex does, and has the velocity of the centre: under a uniform
//! weight that is how the centre moves, too.

use nalgebra::{Matrix3, Rotation3, SymmetricEigen, Vector3};
use toml::{Table, Value};

use super::observable::observed;
use crate::model::observable::Observable;
use crate::model::particle::Motion;
use crate::model::scene::Scene;

/// What a body comes to.
struct Lump {
    name: String,
    mass: f64,
    centre: Vector3<f64>,
    velocity: Vector3<f64>,
    /// Mass, place and momentum of each of its parts.
    parts: Vec<(f64, Vector3<f64>, Vector3<f64>)>,
    /// Where it is pinned.
    pins: Vec<Vector3<f64>>,
    /// Its observed particles, by their places in the scene, and where they start.
    observed: Vec<(usize, Vector3<f64>)>,
}

/// The scene with a point mass for each of its bodies.
pub fn points(table: &Table, scene: &Scene) -> Option<Table> {
    if matches!(scene.observables().first(), Some(Observable::AngularVelocity(_))) {
        return None;
    }
    let dimension = scene.dimension();
    let mut names = Vec::new();
    let mut particles = Vec::new();
    for lump in lumps(scene)? {
        let place = match lump.observed.as_slice() {
            _ if !lump.pins.is_empty() => return None,
            [] => lump.centre,
            [(particle, place)] => {
                names.push((*particle, lump.name.clone()));
                *place
            }
            _ => return None,
        };
        let mut particle = Table::new();
        particle.insert("name".to_owned(), lump.name.into());
        particle.insert("mass".to_owned(), lump.mass.into());
        particle.insert("position".to_owned(), vector(place, dimension));
        particle.insert("velocity".to_owned(), vector(lump.velocity, dimension));
        particles.push(Value::Table(particle));
    }
    let mut simple = bare(table, "stormer-verlet");
    simple.insert("particles".to_owned(), Value::Array(particles));
    about(&mut simple, scene, &names)?;
    Some(simple)
}

/// The scene with a rigid body for each of its elastic ones.
pub fn rigid(table: &Table, scene: &Scene) -> Option<Table> {
    let dimension = scene.dimension();
    let (mut names, mut bodies, mut joints) = (Vec::new(), Vec::new(), Vec::new());
    for lump in lumps(scene)? {
        joints.extend(joint(&lump, dimension)?);
        for (number, (particle, _)) in lump.observed.iter().enumerate() {
            names.push((*particle, format!("{}.{number}", lump.name)));
        }
        bodies.push(Value::Table(body(&lump, dimension)?));
    }
    let mut simple =
        bare(table, if dimension == 3 { "variational-rotation" } else { "stormer-verlet" });
    simple.insert("bodies".to_owned(), Value::Array(bodies));
    if !joints.is_empty() {
        simple.insert("joints".to_owned(), Value::Array(joints));
    }
    about(&mut simple, scene, &names)?;
    Some(simple)
}

/// What holds a pinned body; nothing of a free one.
fn joint(lump: &Lump, dimension: usize) -> Option<Vec<Value>> {
    let Some(&first) = lump.pins.first() else { return Some(Vec::new()) };
    let moves = lump.parts.iter().any(|(_, _, p)| p.norm() > 0.0);
    let far = lump.pins.iter().map(|pin| pin - first);
    let farthest = far.clone().max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let beside = far.map(|arm| arm.cross(&farthest).norm()).fold(0.0, f64::max);
    let kind = match (dimension, farthest.norm() > 0.0, beside > 0.0) {
        _ if moves => return None,
        (2, false, _) => "pin",
        (2, true, _) => "weld",
        (3, false, _) => "ball",
        (3, true, true) => "fixed",
        _ => return None,
    };
    let mut joint = Table::new();
    joint.insert("kind".to_owned(), kind.into());
    let between = vec![Value::from("world"), Value::from(lump.name.as_str())];
    joint.insert("between".to_owned(), between.into());
    joint.insert("at".to_owned(), vector(first, dimension));
    Some(vec![Value::Table(joint)])
}

fn body(lump: &Lump, dimension: usize) -> Option<Table> {
    let mut inertia = Matrix3::zeros();
    let mut spin = Vector3::zeros();
    for (mass, x, p) in &lump.parts {
        let r = x - lump.centre;
        inertia += *mass * (Matrix3::identity() * r.norm_squared() - r * r.transpose());
        spin += r.cross(p);
    }
    let mut body = Table::new();
    body.insert("name".to_owned(), lump.name.as_str().into());
    body.insert("mass".to_owned(), lump.mass.into());
    body.insert("position".to_owned(), vector(lump.centre, dimension));
    let mut axes = Matrix3::identity();
    let (moments, turn) = if dimension == 2 {
        (inertia[(2, 2)].into(), (spin.z / inertia[(2, 2)]).into())
    } else {
        let principal = SymmetricEigen::new(inertia);
        axes = principal.eigenvectors;
        if axes.determinant() < 0.0 {
            axes.column_mut(0).neg_mut();
        }
        let rotation = Rotation3::from_matrix_unchecked(axes).scaled_axis();
        body.insert("rotation".to_owned(), vector(rotation, 3));
        let turn = (axes.transpose() * spin).component_div(&principal.eigenvalues);
        (vector(principal.eigenvalues, 3), vector(turn, 3))
    };
    body.insert("moments".to_owned(), moments);
    if lump.pins.is_empty() {
        body.insert("velocity".to_owned(), vector(lump.velocity, dimension));
        body.insert("angular_velocity".to_owned(), turn);
    }
    let point =
        |(_, x): &(usize, Vector3<f64>)| vector(axes.transpose() * (x - lump.centre), dimension);
    body.insert("points".to_owned(), Value::Array(lump.observed.iter().map(point).collect()));
    Some(body)
}

fn vector(x: Vector3<f64>, dimension: usize) -> Value {
    Value::Array(x.iter().take(dimension).map(|&x| Value::from(x)).collect())
}

/// The scene without its bodies, and with a method that moves what will stand for them.
fn bare(table: &Table, integrator: &str) -> Table {
    let mut bare = table.clone();
    for key in ["solids", "bodies", "tolerance", "modes"] {
        bare.remove(key);
    }
    bare.insert("integrator".to_owned(), integrator.into());
    bare
}

/// Asks for the same of the particles by their new names.
fn about(simple: &mut Table, scene: &Scene, names: &[(usize, String)]) -> Option<()> {
    let asked = observed(scene);
    if asked.is_empty() {
        return Some(());
    }
    let name = |particle: &usize| {
        let own = names.iter().find(|(own, _)| own == particle)?;
        Some(Value::from(own.1.as_str()))
    };
    let renamed = asked.iter().map(name).collect::<Option<Vec<Value>>>()?;
    let observable = simple.get_mut("observables")?.as_array_mut()?.first_mut()?.as_table_mut()?;
    for (_, value) in observable.iter_mut() {
        *value = match value {
            Value::Array(_) => Value::Array(renamed.clone()),
            _ => renamed.first()?.clone(),
        };
    }
    Some(())
}

/// Every elastic or rigid body of a scene that has no other things.
fn lumps(scene: &Scene) -> Option<Vec<Lump>> {
    let places = if scene.solids().is_empty() { Vec::new() } else { starts(scene)? };
    let asked = observed(scene);
    let solids = scene.solids().iter().map(|solid| {
        let vertices = solid.first..solid.first + solid.rest.len();
        let mut parts = Vec::new();
        let mut pins = Vec::new();
        for vertex in vertices.clone() {
            match scene.particles()[vertex].motion {
                Motion::Free { mass, momentum } => {
                    parts.push((mass, places[vertex], Vector3::from(momentum)));
                }
                _ => pins.push(places[vertex]),
            }
        }
        let own = asked.iter().filter(|particle| vertices.contains(particle));
        let observed = own.map(|&particle| (particle, places[particle])).collect();
        lump(solid.name.clone(), parts, pins, observed)
    });
    let bodies = scene.bodies().iter().enumerate().map(|(index, body)| {
        let part = (body.mass, body.position.into(), body.mass * Vector3::from(body.velocity));
        let carried = |particle: &&usize| match scene.particles()[**particle].motion {
            Motion::Carried { body, .. } => body == index,
            _ => false,
        };
        let place = |particle: &usize| (*particle, scene.particles()[*particle].position.into());
        let observed = asked.iter().filter(carried).map(place).collect();
        lump(body.name.clone(), vec![part], Vec::new(), observed)
    });
    let all: Vec<Lump> = solids.chain(bodies).collect();
    (!all.is_empty()).then_some(all)
}

fn lump(
    name: String,
    parts: Vec<(f64, Vector3<f64>, Vector3<f64>)>,
    pins: Vec<Vector3<f64>>,
    observed: Vec<(usize, Vector3<f64>)>,
) -> Lump {
    let mass = parts.iter().map(|(mass, ..)| mass).sum::<f64>();
    let centre = parts.iter().map(|(m, x, _)| *m * x).sum::<Vector3<f64>>() / mass;
    let velocity = parts.iter().map(|(_, _, p)| p).sum::<Vector3<f64>>() / mass;
    Lump { name, mass, centre, velocity, parts, pins, observed }
}

/// Where every vertex of a scene of elastic bodies starts.
fn starts(scene: &Scene) -> Option<Vec<Vector3<f64>>> {
    let problem = scene.problem().ok()?;
    let mut free = problem.initial.q.chunks_exact(scene.dimension());
    let place = |particle: &crate::Particle| {
        let mut x = Vector3::from(particle.position);
        if let Motion::Free { .. } = particle.motion {
            x.iter_mut().zip(free.next()?).for_each(|(x, q)| *x = *q);
        }
        Some(x)
    };
    scene.particles().iter().map(place).collect()
}
