//! What is round or a solid of its own, as it is seen on paper: the hull of its projected points.
//!
//! ```text
//! a ball        a circle of its radius
//! a convex part of a body        the convex hull of its points on paper; in the plane its rim
//! ```

use std::f64::consts::TAU;

use crate::run::samples::Run;
use crate::show::projection::Projection;

/// Corners of a circle.
const AROUND: usize = 48;

/// Outlines on paper, in the scene's units.
pub(crate) type Outlines = Vec<Vec<[f64; 2]>>;

impl Run {
    /// The outlines of balls, discs and solids at a sample.
    pub(crate) fn silhouettes(&self, sample: usize, projection: &Projection) -> Outlines {
        let all = self.scene.particles.iter().enumerate();
        let round = all.filter(|(_, particle)| particle.radius > 0.0);
        let balls = round.map(|(particle, of)| {
            circle(projection.of(self.position(sample, particle)), of.radius)
        });
        let mut outlines: Outlines = balls.collect();
        let fields = self.bodies(sample);
        for (body, centre, surfaces) in self.surfaces() {
            let Some(field) = fields.get(body) else { continue };
            outlines.extend(surfaces.iter().map(|surface| {
                let place = |&point| projection.of(self.placed(sample, centre, field, point));
                match self.scene.dimension {
                    2 => surface.rim().iter().map(place).collect(),
                    _ => hull(surface.points.iter().map(place).collect()),
                }
            }));
        }
        outlines
    }

    /// The outlines of balls that stay.
    pub(crate) fn fixed_balls(&self, projection: &Projection) -> Outlines {
        let balls = self.scene.contact.iter().flat_map(|contact| &contact.balls);
        balls.map(|ball| circle(projection.of(ball.centre), ball.radius)).collect()
    }

    /// How far each particle reaches: what is round or has a surface does so from its centre.
    pub(crate) fn reaches(&self) -> Vec<f64> {
        let mut reaches: Vec<f64> = self.scene.particles.iter().map(|p| p.radius).collect();
        for (_, centre, surfaces) in self.surfaces() {
            let reach = surfaces.iter().map(|surface| surface.reach());
            reaches[centre] = reach.fold(reaches[centre], f64::max);
        }
        reaches
    }
}

fn circle([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / AROUND as f64).sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    (0..AROUND).map(at).collect()
}

/// The convex hull of points on paper, counterclockwise: Andrew's monotone chain.
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let left =
        |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && !left([a, b, point])
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut around = chain(&mut points.iter().copied());
    around.extend(chain(&mut points.iter().rev().copied()));
    around
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_has_the_outermost_points_in_order() {
        let inside = [[0.5, 0.5], [0.2, 0.7], [0.5, 0.0]];
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(hull([inside.to_vec(), square.to_vec()].concat()), square);
    }
}
