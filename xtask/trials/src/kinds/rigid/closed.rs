//! Random mechanisms of several loops: reduced coordinates with few rows beside full ones, also where loops lie flat.
//!
//! In space a loop is closed by a joint whose frames coincide where the tree stands, of any kind; in the plane all
//! hinges are parallel, and the full coordinates have redundant equations everywhere. The accelerations are compared
//! as those of `driven-trees` are. Loops that depend on each other are judged by the rank in full coordinates.

use nalgebra::Vector3;
use stationary_rigid::tree::{Tree, TreeBuilder, TreeError, TreeLoops, TreeMotion};
use stationary_rigid::{
    Body, BodyMetric, Joint, JointEnd, JointKind, LieGroup, Poses, RigidMotion, Rotation, mobility,
};

use super::driven::{compare, direction, frame, kind};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "closed-loops",
    krate: "rigid",
    rule: "the accelerations of a random tree with one to three loops closed by rows differ from those of the same \
           bodies under the joints' equations by more than 1e-6 of the largest; loops that are closed as they \
           stand, and independent, are said not to close; loops that leave no more freedoms than they have rows \
           fewer are said to depend on each other",
    in_tests: 50,
    trial,
};

/// The bodies of a tree and its joints.
struct Bodies {
    tree: Tree,
    bodies: Vec<Body>,
    joints: Vec<Joint<Poses>>,
}

fn along_x(size: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::x() * size, rotation: Rotation::identity() }
}

fn bodies(draw: &mut Draw, planar: bool) -> Result<Bodies, String> {
    let n = draw.between(3, 10);
    let ratio = draw.one_of(&[1.0 + 1e-9, 1e1, 1e3, 1e6]);
    draw.note(format!("{n} bodies, planar {planar}, ratio {ratio:.0e}"));
    let (mut builder, mut joints, mut bodies) = (TreeBuilder::default(), vec![], vec![]);
    for body in 0..n {
        let half = [0; 3].map(|_| draw.log_uniform(0.05, 0.5));
        let mass = draw.log_uniform(1.0, ratio);
        let own = Body::solid_box(mass, half).map_err(|error| error.to_string())?;
        // Mostly in a row, so that loops are long.
        let parent =
            body.checked_sub(1).map(|last| if draw.chance(0.7) { last } else { draw.below(body) });
        let (kind, frames) = if planar {
            let size = |draw: &mut Draw| draw.log_uniform(0.1, 1.0);
            let foot = if parent.is_none() { 0.0 } else { size(draw) };
            (JointKind::Hinge { axis: Vector3::z() }, [along_x(foot), along_x(-size(draw))])
        } else {
            let free = if draw.chance(0.5) { JointKind::Ball } else { kind(draw) };
            (free, [frame(draw), frame(draw)])
        };
        builder.hang(parent, kind, frames, own);
        bodies.push(own);
        let ends = [
            JointEnd { body: parent, frame: frames[0] },
            JointEnd { body: Some(body), frame: frames[1] },
        ];
        joints.push(Joint::new(Poses, n, kind, ends).map_err(|error| error.to_string())?);
    }
    let tree = builder.build().map_err(|error| error.to_string())?;
    Ok(Bodies { tree, bodies, joints })
}

/// A joint between two bodies where they stand: that of the tree, and that of full coordinates.
fn closing(
    draw: &mut Draw,
    motion: &TreeMotion,
    bodies: [usize; 2],
    planar: bool,
) -> Option<([JointKind; 2], [JointEnd; 2])> {
    let [one, other] = bodies.map(|body| motion.pose(body).ok());
    let (one, other) = (one?, other?);
    if planar {
        // Where the second body ends.
        let place = other.apply(&(Vector3::x() * draw.log_uniform(0.1, 1.0)));
        let here = RigidMotion { translation: place, rotation: Rotation::identity() };
        let ends = [
            JointEnd::where_it_stands(bodies[0], &one, &here),
            JointEnd::where_it_stands(bodies[1], &other, &here),
        ];
        let (line, hinge) =
            (JointKind::OnLine { axis: Vector3::z() }, JointKind::Hinge { axis: Vector3::z() });
        return Some(([line, hinge], ends));
    }
    let (axis, across) = (direction(draw), direction(draw));
    let across = axis.cross(&across).try_normalize(1e-3)?;
    if draw.chance(0.3) {
        let ends =
            bodies.map(|body| JointEnd::on(body, direction(draw) * draw.log_uniform(0.05, 1.0)));
        let place = |end: &JointEnd, pose: &RigidMotion| pose.apply(&end.frame.translation);
        let length = (place(&ends[0], &one) - place(&ends[1], &other)).norm();
        return Some(([JointKind::Rod { length }; 2], ends));
    }
    let kind = match draw.below(5) {
        0 => JointKind::OnLine { axis },
        1 => JointKind::Planar { axes: [axis, across] },
        2 => JointKind::Cylinder { axis },
        3 => JointKind::Universal { axes: [axis, across] },
        _ => JointKind::Ball,
    };
    let here = frame(draw);
    let ends = [
        JointEnd::where_it_stands(bodies[0], &one, &here),
        JointEnd::where_it_stands(bodies[1], &other, &here),
    ];
    Some(([kind; 2], ends))
}

/// Whether loops that are said to depend on each other leave more freedoms than they would if they did not, by the
/// rank of the joints' equations in full coordinates.
fn dependent(
    motion: &TreeMotion,
    bodies: &[Body],
    joints: &Vec<Joint<Poses>>,
    left: isize,
    said: TreeError,
) -> Verdict {
    let metric = BodyMetric::<Poses>::new(bodies.to_vec());
    let motions: Vec<_> =
        (0..bodies.len()).map(|body| motion.body(body).expect("a body that is there")).collect();
    let state = match metric.state(&motions) {
        Ok(state) => state,
        Err(error) => return Verdict::wrong(error),
    };
    match mobility(&metric, joints, 0.0, &state.q) {
        Ok(found) if found.freedoms as isize > left => Verdict::due(),
        Ok(_) => Verdict::refused(said),
        Err(error) => Verdict::not_judged(error),
    }
}

fn trial(draw: &mut Draw) -> Verdict {
    let planar = draw.chance(0.4);
    let flat = planar && draw.chance(0.3);
    let Bodies { tree, bodies, mut joints } = match bodies(draw, planar) {
        Ok(bodies) => bodies,
        Err(error) => return Verdict::wrong(error),
    };
    let n = bodies.len();
    let (mut q, mut v) = (tree.rest(), vec![0.0; tree.speeds()]);
    let turn = |draw: &mut Draw| {
        if flat { draw.one_of(&[0.0, std::f64::consts::PI]) } else { draw.symmetric() }
    };
    q.iter_mut().for_each(|q| *q += turn(draw));
    v.iter_mut().for_each(|v| *v = 2.0 * draw.symmetric());
    for (body, joint) in joints.iter().enumerate() {
        let Ok(range) = tree.coordinates_of(body) else { continue };
        if matches!(joint.kind(), JointKind::Ball | JointKind::Free) {
            let quaternion = &mut q[range.end - 4..range.end];
            let length = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
            quaternion.iter_mut().for_each(|c| *c /= length);
        }
    }
    let mut motion = TreeMotion::new(tree.clone());
    if let Err(error) = motion.place(&q, &v) {
        return Verdict::wrong(error);
    }
    let mut loops = TreeLoops::new(&tree);
    for _ in 0..draw.between(1, 3) {
        let first = draw.below(n);
        let second = (first + draw.between(1, n - 1)) % n;
        let Some(([kind, full], ends)) = closing(draw, &motion, [first, second], planar) else {
            continue;
        };
        draw.note(format!("{kind:?} between {first} and {second}"));
        if let Err(error) = loops.join(&tree, kind, ends) {
            return Verdict::wrong(error);
        }
        match Joint::new(Poses, n, full, ends) {
            Ok(joint) => joints.push(joint),
            Err(error) => return Verdict::wrong(error),
        }
    }
    let start = motion.clone();
    match loops.close(&mut motion, &mut q, &mut v) {
        Ok(()) => {}
        Err(error @ TreeError::DependentLoops { .. }) => {
            let left = tree.speeds() as isize - loops.multipliers().len() as isize;
            return dependent(&start, &bodies, &joints, left, error);
        }
        Err(error) => return Verdict::wrong(error),
    }
    let y = [q, v].concat();
    compare(draw, (&tree, loops), &bodies, &joints, &[], Vector3::new(0.0, -9.0, 1.0), &y)
}
