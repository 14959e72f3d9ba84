//! Mass, centre and inertia of random polygons and closed surfaces against sums in 32 digits.

use nalgebra::{Matrix3, Vector2, Vector3};
use stationary_mesh::{ClosedSurface, Mesh, Polygon, cuboid, icosphere};
use stationary_rigid::{LieGroup, PlanarMass, RigidMotion, Rotation, SpatialMass};

use super::double_double::{Triple, Twofold, cross, dot, triple};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "mass-properties",
    krate: "rigid",
    rule: "mass, centre or inertia are off by more than roundings of the shape's extent; a piece far \
           away loses digits that its corners have; pieces do not add up; principal axes are none",
    in_tests: 300,
    trial,
};

/// Roundings that a sum over a shape may have, relative to its extent.
const SUM: f64 = 1e-14;

fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.5) { polygon(draw) } else { solid(draw) }
}

/// A scale, and a distance from the origin in units of it.
fn place(draw: &mut Draw) -> (f64, f64) {
    (draw.log_uniform(1e-6, 1e6), draw.one_of(&[0.0, 1.0, 1e3, 1e6]))
}

fn polygon(draw: &mut Draw) -> Verdict {
    let (size, far) = place(draw);
    let n = draw.between(3, 40);
    let flat = draw.one_of(&[1.0, 1.0, 1e-3, 1e-6]);
    let centre = Vector2::new(draw.symmetric(), draw.symmetric()) * (far * size);
    let ragged = draw.one_of(&[0.0, 0.5, 0.95]);
    let corners: Vec<Vector2<f64>> = (0..n)
        .map(|k| {
            let angle = std::f64::consts::TAU * (k as f64 + 0.4 * draw.symmetric()) / n as f64;
            let radius = size * (1.0 - ragged * draw.unit());
            centre + Vector2::new(radius * angle.cos(), flat * radius * angle.sin())
        })
        .collect();
    let density = draw.log_uniform(1e-3, 1e4);
    draw.note(format!(
        "{n} corners of size {size:.1e} at {far:e} sizes, flat {flat:e}: {corners:?}"
    ));
    let shape = match Polygon::new(vec![corners.clone()]) {
        Ok(shape) => shape,
        // Corners that rounding makes one, or lets cross.
        Err(error) => {
            return if flat * 1e12 > far { Verdict::refused(error) } else { Verdict::due() };
        }
    };
    let got = match PlanarMass::of(density, &shape.moments()) {
        Ok(mass) => mass,
        Err(error) => return Verdict::refused(error),
    };
    // About the first corner, in 32 digits.
    let seen: Vec<[Twofold; 2]> = corners
        .iter()
        .map(|c| [0, 1].map(|k| Twofold::from(c[k]) - Twofold::from(corners[0][k])))
        .collect();
    let zero = Twofold::from(0.0);
    let (mut area, mut first, mut polar) = (zero, [zero; 2], zero);
    for k in 0..n {
        let (p, q) = (&seen[k], &seen[(k + 1) % n]);
        let part = p[0] * q[1] - p[1] * q[0];
        area += part * 0.5;
        for c in 0..2 {
            first[c] += part * (p[c] + q[c]) / Twofold::from(6.0);
            polar += part * (p[c] * p[c] + p[c] * q[c] + q[c] * q[c]) / Twofold::from(12.0);
        }
    }
    let middle = first.map(|f| f / area);
    let inertia = polar - (first[0] * first[0] + first[1] * first[1]) / area;
    let extent = 2.0 * size;
    // Rounding of products of the extents along and across.
    let area_size = extent * extent * flat;
    let thin = area_size / area.abs().hi;
    let off = |got: f64, exact: Twofold| (exact - Twofold::from(got)).abs().hi;
    let mass = off(got.mass / density, area.abs());
    let verdict = Verdict::of(mass, SUM * area_size, "the area");
    let shift = (0..2).map(|c| {
        let exact = middle[c] + Twofold::from(corners[0][c]);
        off(got.centre[c], exact)
    });
    let allowed = SUM * extent * thin + 2.0 * f64::EPSILON * centre.amax();
    let verdict = verdict.and(Verdict::of(shift.fold(0.0, f64::max), allowed, "the centre"));
    let turn = off(got.inertia / density, inertia.abs());
    verdict.and(Verdict::of(turn, 4.0 * SUM * area_size * extent * extent, "the polar moment"))
}

fn surface(draw: &mut Draw) -> Option<Mesh<3, 3>> {
    match draw.below(3) {
        0 => cuboid([1.0, 1.0, 1.0], [1; 3]).ok().map(|mesh| mesh.boundary().mesh),
        1 => icosphere(1.0, draw.between(0, 2)).ok(),
        _ => {
            let v = Vector3::new;
            let corners =
                vec![v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)];
            let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
            Mesh::new(corners, faces).ok()
        }
    }
}

fn solid(draw: &mut Draw) -> Verdict {
    let (size, far) = place(draw);
    let Some(mesh) = surface(draw) else { return Verdict::wrong("no surface to begin with") };
    let thin = [1.0, draw.one_of(&[1.0, 1e-3]), draw.one_of(&[1.0, 1e-2, 1e-5])];
    let turned = Rotation::exp(Vector3::from_fn(|_, _| 3.0 * draw.symmetric())).matrix();
    let centre = Vector3::from_fn(|_, _| draw.symmetric()) * (far * size);
    let rough = draw.one_of(&[0.0, 0.05]);
    let noise: Vec<f64> = mesh.vertices().iter().map(|_| 1.0 + rough * draw.symmetric()).collect();
    let mut vertices = mesh.vertices().to_vec();
    for (x, noise) in vertices.iter_mut().zip(noise) {
        let scaled = x.component_mul(&Vector3::from(thin)) * (size * noise);
        *x = centre + turned * scaled;
    }
    draw.note(format!(
        "size {size:.1e} at {far:e} sizes, sides {thin:?}, rough {rough}: {vertices:?}"
    ));
    let density = draw.log_uniform(1e-3, 1e4);
    let smallest = thin[1] * thin[2];
    let faces = mesh.simplices().to_vec();
    let made = Mesh::new(vertices.clone(), faces.clone()).and_then(ClosedSurface::new);
    let shape = match made {
        Ok(shape) => shape,
        // Rounding of far corners may turn a thin one inside out.
        Err(error) => {
            let kept = smallest.min(thin[2]) > 1e-12 * far;
            return if kept { Verdict::refused(error) } else { Verdict::due() };
        }
    };
    let got = match SpatialMass::of(density, &shape.moments()) {
        Ok(mass) => mass,
        Err(error) => return Verdict::refused(error),
    };
    let (volume, middle, second) = exact(&vertices, &faces);
    let extent = 2.0 * size;
    let volume_size = extent.powi(3);
    // A thin and tilted solid's volume is a difference of larger ones.
    let condition = volume_size / volume.hi;
    let off = |got: f64, exact: Twofold| (exact - Twofold::from(got)).abs().hi;
    let verdict = Verdict::of(off(got.mass / density, volume), SUM * volume_size, "the volume");
    let shift = (0..3).map(|c| off(got.centre[c], middle[c])).fold(0.0, f64::max);
    let allowed = SUM * extent * condition + 2.0 * f64::EPSILON * centre.amax();
    let verdict = verdict.and(Verdict::of(shift, allowed, "the centre"));
    let trace = second[0][0] + second[1][1] + second[2][2];
    let mut worst = 0.0_f64;
    for (i, row) in second.iter().enumerate() {
        for (j, &moment) in row.iter().enumerate() {
            let expected = if i == j { trace - moment } else { -moment };
            worst = worst.max(off(got.inertia[(i, j)] / density, expected));
        }
    }
    let inertia_size = volume_size * extent * extent;
    let verdict = verdict.and(Verdict::of(worst, 4.0 * SUM * inertia_size, "the inertia"));
    verdict.and(body(draw, &got, condition)).and(pieces(draw, &got))
}

/// Volume, centre and central second moments, summed about the first corner.
fn exact(vertices: &[Vector3<f64>], faces: &[[usize; 3]]) -> (Twofold, Triple, [Triple; 3]) {
    let origin = triple(vertices[0].into());
    let seen: Vec<Triple> =
        vertices.iter().map(|v| [0, 1, 2].map(|c| Twofold::from(v[c]) - origin[c])).collect();
    let zero = Twofold::from(0.0);
    let (mut volume, mut first, mut second) = (zero, [zero; 3], [[zero; 3]; 3]);
    for face in faces {
        let [a, b, c] = face.map(|vertex| seen[vertex]);
        let part = dot(&a, &cross(&b, &c)) / Twofold::from(6.0);
        volume += part;
        for i in 0..3 {
            let s = |i: usize| a[i] + b[i] + c[i];
            first[i] += part * s(i) * 0.25;
            for j in 0..3 {
                let squares = a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s(i) * s(j);
                second[i][j] += part * squares / Twofold::from(20.0);
            }
        }
    }
    let middle = first.map(|f| f / volume);
    for i in 0..3 {
        for j in 0..3 {
            second[i][j] = second[i][j] - first[i] * middle[j];
        }
    }
    (volume, [0, 1, 2].map(|c| middle[c] + origin[c]), second)
}

/// The principal axes make the tensor diagonal.
fn body(draw: &mut Draw, mass: &SpatialMass, condition: f64) -> Verdict {
    match mass.body() {
        Err(error) if condition > 1e4 => {
            draw.note(format!("{error}"));
            Verdict::due()
        }
        Err(error) => Verdict::refused(error),
        Ok((body, pose)) => {
            let q = pose.rotation.matrix();
            let back = q * Matrix3::from_diagonal(&body.moments()) * q.transpose();
            let off = (back - mass.inertia).amax() / mass.inertia.amax();
            Verdict::of(off, 1e-14, "the principal axes")
        }
    }
}

/// A solid and itself elsewhere make one of twice the mass, by the parallel-axis rule.
fn pieces(draw: &mut Draw, mass: &SpatialMass) -> Verdict {
    let apart = Vector3::from_fn(|_, _| draw.symmetric()) * draw.log_uniform(1e-3, 1e3);
    let other = mass.moved(&RigidMotion { translation: apart, rotation: Rotation::identity() });
    match SpatialMass::composite(&[*mass, other]) {
        Err(error) => Verdict::refused(error),
        Ok(both) => {
            let centre = mass.centre + (other.centre - mass.centre) * 0.5;
            let d = (other.centre - mass.centre) * 0.5;
            let rule = (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * both.mass;
            let expected = mass.inertia * 2.0 + rule;
            let off = (both.inertia - expected).amax() / expected.amax();
            let shift = (both.centre - centre).amax() / centre.amax().max(d.amax());
            Verdict::of((both.mass / mass.mass - 2.0).abs(), 1e-15, "the mass of two")
                .and(Verdict::of(shift, 1e-15, "the centre of two"))
                .and(Verdict::of(off, 1e-14, "the inertia of two"))
        }
    }
}
