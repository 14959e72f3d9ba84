//! A random scene of a few bodies, in the plane or in space: ugly ones over-represented.

use nalgebra::Vector3;

use crate::Draw;

/// What a body looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// A disc or a ball of the first half size.
    Round,
    Box,
    /// A regular triangle or tetrahedron, its corners as far from the centre as the first half size.
    Simplex,
}

/// A body. In the plane the last coordinate is unused, and turns are about it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thing {
    pub(super) form: Form,
    /// Half sizes, m.
    pub(super) half: [f64; 3],
    pub(super) mass: f64,
    pub(super) restitution: f64,
    pub(super) friction: f64,
    pub(super) place: Vector3<f64>,
    /// A rotation vector.
    pub(super) turn: Vector3<f64>,
    /// World axes, m/s and rad/s.
    pub(super) velocity: Vector3<f64>,
    pub(super) spin: Vector3<f64>,
}

/// By which law impacts go; Jacobi's is not among them, which says of itself that it gains energy.
#[derive(Clone, Copy, Debug)]
pub(super) enum Law {
    Reflections,
    GaussSeidel,
    Blended,
    Inelastic,
}

/// Things over half-planes or half-spaces whose borders go through the origin, or in free flight.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) flat: bool,
    pub(super) things: Vec<Thing>,
    /// Whether nothing slows the first thing down.
    pub(super) pushed: bool,
    /// Lengths of rolling and of torsional friction of all pairs, m.
    pub(super) rolling: [f64; 2],
    /// The size of its things, m.
    scale: f64,
    /// Normals of what is solid below.
    pub(super) grounds: Vec<Vector3<f64>>,
    /// Downwards, m/s^2.
    pub(super) gravity: f64,
    pub(super) law: Law,
    pub(super) tolerance: Option<f64>,
    pub(super) step: f64,
    pub(super) steps: usize,
}

impl Case {
    pub(super) fn up(&self) -> Vector3<f64> {
        up(self.flat)
    }

    /// Pairs of what can touch: things, and behind them grounds.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        let (things, all) = (self.things.len(), self.things.len() + self.grounds.len());
        (0..things).flat_map(move |one| (one + 1..all).map(move |other| [one, other]))
    }
}

fn up(flat: bool) -> Vector3<f64> {
    if flat { Vector3::y() } else { Vector3::z() }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Family {
    Tossed,
    Tower,
    Pyramid,
    Thrown,
    Valley,
    Pushed,
    Wall,
}

#[derive(Clone, Copy, Debug)]
enum Masses {
    Equal,
    Alternating(f64),
    Random,
    /// Each ten times as heavy as the one before.
    Heavier,
    Lighter,
}

/// The lengths, times and surfaces of a scene.
struct Maker {
    flat: bool,
    scale: f64,
    speed: f64,
    turned: f64,
    form: Option<Form>,
    masses: Masses,
    restitution: f64,
    friction: f64,
}

/// A scene, and what it is in words.
pub(super) fn drawn(draw: &mut Draw, flat: bool) -> Case {
    use Family::{Pushed, Pyramid, Thrown, Tossed, Tower, Valley, Wall};
    let family =
        draw.one_of(&[Tossed, Tower, Thrown, Pyramid, Valley, Pushed, Tower, Tossed, Pyramid]);
    let family = if draw.chance(0.01) { Wall } else { family };
    let scale = if draw.chance(0.3) { draw.log_uniform(1e-6, 1e6) } else { 1.0 };
    let gravity = match family {
        Thrown => draw.one_of(&[0.0, 0.0, 9.81 * scale]),
        _ => draw.one_of(&[9.81 * scale, 9.81 * scale, 9.81, 0.0]),
    };
    let time = if gravity > 0.0 { (scale / gravity).sqrt() } else { 1.0 };
    let masses = draw.one_of(&[
        Masses::Equal,
        Masses::Equal,
        Masses::Alternating(1e3),
        Masses::Alternating(1e9),
        Masses::Random,
        Masses::Heavier,
        Masses::Lighter,
    ]);
    let speed = draw.one_of(&[0.0, 0.0, 1.0, 0.1, 10.0, 1e3]) * scale / time;
    let form = draw.one_of(&[Some(Form::Box), Some(Form::Round), None]);
    let maker = Maker {
        flat,
        scale,
        speed: if family == Thrown { speed.max(scale / time) } else { speed },
        turned: draw.one_of(&[0.0, 1.0, 1e-3, 1e-9]),
        form,
        masses,
        restitution: draw.one_of(&[0.0, 0.0, 0.5, 1.0, 1e-12]),
        friction: draw.one_of(&[0.0, 0.5, 0.1, 1.0, 3.0]),
    };
    let things = maker.things(draw, family);
    let lean: f64 = draw.one_of(&[0.0, 0.1, 0.5]);
    let tilted = |by: f64| (up(flat) + Vector3::x() * by).normalize();
    let grounds = match family {
        Thrown => Vec::new(),
        Valley => vec![tilted(lean.max(0.1)), tilted(-(lean.max(0.1)))],
        Tossed => vec![tilted(lean)],
        _ => vec![up(flat)],
    };
    let law = draw.one_of(&[
        Law::Reflections,
        Law::Reflections,
        Law::Reflections,
        Law::GaussSeidel,
        Law::Blended,
        Law::Inelastic,
    ]);
    let tolerance = draw.chance(0.15).then(|| draw.log_uniform(1e-9, 1e-1) * scale / time);
    let step = time * draw.one_of(&[1e-2, 1e-3, 0.1, 1e-5, 1.0, 10.0]);
    let most = if family == Wall { 3 } else { 30 };
    let steps = draw.between(1, most);
    let case = Case {
        flat,
        things,
        pushed: family == Pushed,
        rolling: [0.0; 2],
        scale,
        grounds,
        gravity,
        law,
        tolerance,
        step,
        steps,
    };
    draw.note(case.told(family));
    case
}

impl Case {
    /// The same, whose pairs resist rolling and torsion.
    pub(super) fn rolling(self, draw: &mut Draw) -> Self {
        let rolling = [(); 2].map(|()| draw.one_of(&[1e-2, 1e-3, 0.1, 0.0]) * self.scale);
        draw.note(format!("rolling {rolling:?}"));
        Case { rolling, ..self }
    }

    /// Its first thing as a box that is about to land nearly flat on the ground or on the second, which lies there:
    /// what one corner hits may take another along within the step.
    pub(super) fn landing(self, draw: &mut Draw) -> Self {
        let Case { flat, scale, mut things, .. } = self;
        let up = up(flat);
        let time = if self.gravity > 0.0 { (scale / self.gravity).sqrt() } else { 1.0 };
        let step = time * draw.one_of(&[1e-2, 1e-3, 1e-4, 1e-5]);
        let speed = draw.one_of(&[0.1, 1.0, 10.0]) * scale / time;
        things.truncate(2);
        let mut low = 0.0;
        for (k, thing) in things.iter_mut().enumerate().rev() {
            let high = if flat { 1 } else { 2 };
            let widest = (0..high).map(|k| thing.half[k]).fold(0.0, f64::max);
            let falls = if k == 0 { speed } else { 0.0 };
            let tilt = 2.0 * step * falls / widest;
            let [x, y, gap] = [tilt * draw.symmetric(), tilt * draw.symmetric(), draw.unit()];
            thing.form = Form::Box;
            thing.turn = if flat { Vector3::z() * x } else { Vector3::new(x, y, 0.0) };
            let lean = thing.turn.norm() * widest * 2.0_f64.sqrt();
            thing.place = up * (low + thing.half[high] + lean + step * falls * gap);
            thing.velocity = up * -falls;
            thing.spin = Vector3::zeros();
            low += 2.0 * thing.half[high];
        }
        draw.note(format!("a box lands: step {step:?}, {things:?}"));
        Case { things, pushed: false, grounds: vec![up], step, ..self }
    }

    fn told(&self, family: Family) -> String {
        let Case { gravity, law, tolerance, step, steps, grounds, .. } = self;
        let heading = format!(
            "{family:?}, gravity {gravity:?}, law {law:?}, tolerance {tolerance:?}, step {step:?}, \
             {steps} steps, grounds {grounds:?}"
        );
        let thing = |t: &Thing| {
            let three = |v: &Vector3<f64>| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
            format!(
                "\n        {:?} half {:?} mass {:?} c {:?} mu {:?} at {} turned {} v {} w {}",
                t.form,
                t.half,
                t.mass,
                t.restitution,
                t.friction,
                three(&t.place),
                three(&t.turn),
                three(&t.velocity),
                three(&t.spin)
            )
        };
        heading + &self.things.iter().map(thing).collect::<String>()
    }
}

impl Maker {
    fn things(&self, draw: &mut Draw, family: Family) -> Vec<Thing> {
        let s = self.scale;
        match family {
            Family::Tower => {
                let count = draw.between(1, 10);
                let gap = draw.one_of(&[0.0, 1e-9, 1e-3, -1e-3, -0.2]) * s;
                let off = draw.one_of(&[0.0, 1e-3, 0.2]) * s;
                let mut height = 0.0;
                let one = |k: usize| {
                    let mut thing = self.thing(draw, k);
                    let half = self.reach(&thing);
                    height += gap + half;
                    let [x, y] = [(); 2].map(|()| off * draw.symmetric());
                    thing.place = self.at(x, y, height);
                    height += half;
                    thing
                };
                (0..count).map(one).collect()
            }
            Family::Pyramid => {
                let base = draw.between(1, 4);
                let gap = draw.one_of(&[0.0, 1e-9, 1e-3, -1e-3, -0.2]) * s;
                let mut things = Vec::new();
                let model = self.thing(draw, 0);
                let round = model.form == Form::Round;
                let (half, rise) = (model.half[0], if round { 3.0_f64.sqrt() } else { 2.0 });
                let up = if round { half } else { self.reach(&model) };
                for row in 0..base {
                    for k in 0..base - row {
                        let x = (2.0 * half + gap) * (k as f64 + 0.5 * row as f64);
                        let z = up + gap + (rise * up + gap) * row as f64;
                        let mass = self.mass(draw, things.len());
                        things.push(Thing { place: self.at(x, 0.0, z), mass, ..model });
                    }
                }
                things
            }
            Family::Wall => {
                let (wide, high) = (draw.between(4, 6), draw.between(4, 7));
                let half = [s, 0.5 * s, 0.5 * s];
                let brick = |k: usize| {
                    let (row, column) = (k / wide, k % wide);
                    let x = 2.0 * s * (column as f64 + 0.5 * (row % 2) as f64);
                    let place = self.at(x, 0.0, s * (row as f64 + 0.5));
                    let none = Vector3::zeros();
                    Thing {
                        form: Form::Box,
                        half,
                        mass: 1.0,
                        restitution: self.restitution,
                        friction: self.friction,
                        place,
                        turn: none,
                        velocity: none,
                        spin: none,
                    }
                };
                let mut things: Vec<Thing> = (0..wide * high).map(brick).collect();
                let mut struck = self.thing(draw, 0);
                struck.place = self.at(-2.0 * s, 0.0, 0.5 * s * high as f64);
                struck.velocity = Vector3::x() * self.speed;
                things.push(struck);
                things
            }
            _ => {
                let count = draw.between(1, 7);
                let spread = draw.one_of(&[0.6, 1.0, 0.3]) * s * (count as f64).sqrt();
                let one = |k: usize| {
                    let mut thing = self.thing(draw, k);
                    let [x, y, z] = [(); 3].map(|()| spread * draw.symmetric());
                    let low = if family == Family::Thrown { 0.0 } else { self.reach(&thing) };
                    thing.place = self.at(x, 0.3 * y, low + z.abs() * 2.0);
                    if family == Family::Thrown {
                        thing.velocity -= thing.place * (self.speed / s);
                    }
                    if family == Family::Pushed && k == 0 {
                        thing.place = self.at(x, y, low + 0.2 * s);
                        thing.velocity -= self.up() * self.up().dot(&thing.velocity);
                    }
                    thing
                };
                (0..count).map(one).collect()
            }
        }
    }

    fn up(&self) -> Vector3<f64> {
        up(self.flat)
    }

    /// Aside, away, and above the ground.
    fn at(&self, x: f64, y: f64, z: f64) -> Vector3<f64> {
        if self.flat { Vector3::new(x, z, 0.0) } else { Vector3::new(x, y, z) }
    }

    /// From its centre to its lowest point when not turned.
    fn reach(&self, thing: &Thing) -> f64 {
        match thing.form {
            Form::Box => thing.half[if self.flat { 1 } else { 2 }],
            _ => thing.half[0],
        }
    }

    fn mass(&self, draw: &mut Draw, k: usize) -> f64 {
        match self.masses {
            Masses::Equal => 1.0,
            Masses::Alternating(ratio) => [1.0, ratio][k % 2],
            Masses::Random => draw.log_uniform(1.0, 1e9),
            Masses::Heavier => 10_f64.powi(k as i32),
            Masses::Lighter => 10_f64.powi(9 - k as i32),
        }
    }

    fn thing(&self, draw: &mut Draw, k: usize) -> Thing {
        let size =
            0.5 * self.scale * if draw.chance(0.3) { draw.log_uniform(0.1, 1.0) } else { 1.0 };
        let slender = if draw.chance(0.2) { draw.log_uniform(0.05, 1.0) } else { 1.0 };
        let any = || [Form::Box, Form::Round, Form::Simplex];
        let form = self.form.unwrap_or_else(|| draw.one_of(&any()));
        let mut three = |by: f64, round_only: bool| {
            let [x, y, z] = [(); 3].map(|()| by * draw.symmetric());
            match (self.flat, round_only) {
                (true, true) => Vector3::new(0.0, 0.0, z),
                (true, false) => Vector3::new(x, y, 0.0),
                (false, _) => Vector3::new(x, y, z),
            }
        };
        let turn = three(self.turned, true);
        let velocity = three(self.speed, false);
        let spin = three(self.speed / self.scale, true);
        let half = [size, size * slender, size * if slender < 0.3 { 1.0 } else { slender }];
        Thing {
            form,
            half,
            mass: self.mass(draw, k),
            restitution: if draw.chance(0.2) { draw.unit() } else { self.restitution },
            friction: if draw.chance(0.2) { draw.unit() } else { self.friction },
            place: Vector3::zeros(),
            turn,
            velocity,
            spin,
        }
    }
}
