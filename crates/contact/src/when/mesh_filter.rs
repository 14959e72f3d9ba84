//! The velocity filter of a deforming mesh: nothing passes through, at any speed.
//!
//! ```text
//! q -> q + h v,  straight;   each vertex against each triangle, each edge against each edge
//! a meeting at (u, v):  n.(sum_i w_i v_i) >= 0      w the weights of the two places, n across
//! ```
//! Meetings are found by times of impact, whose "never" is a proof. Rounds of projections (11.1) of
//! all meetings found so far turn approach into no approach. What still meets after some rounds
//! moves as one: the vertices of such meetings get their common velocity, zone by zone, until
//! nothing meets (in the end the whole mesh would be one zone, in which nothing can). Where even
//! that is impossible, because pinned vertices move against each other, the mesh stays where it was
//! proved free. Inelastic; momentum of what is not pinned is kept, kinetic energy never grows.
//! Source: notes 11.1, 11.4; Bridson, Fedkiw and Anderson 2002 (zones), Harmon, Vouga, Tamstorf and
//! Grinspun 2008 (projection).

use std::collections::BTreeSet;

use nalgebra::Vector3;
use stationary_calculus::{DiagonalMetric, SizeError, Vector};
use stationary_integrators::StepError;

use crate::error::check_finite;
use crate::impact::inverse_mass::Groups;
use crate::when::swept_boxes::{SweptBox, overlapping};
use crate::{
    Closeness, ContactError, ContactRows, Impact, InverseMass, Moving, edge_meets_edge,
    particle_meets_triangle, project,
};

/// Vertices, triangles and edges that must not pass through each other.
#[derive(Clone, Debug)]
pub struct MeshFilter {
    triangles: Vec<[usize; 3]>,
    edges: Vec<[usize; 2]>,
    masses: Vec<f64>,
    pinned: Vec<bool>,
    mass: InverseMass,
    tolerance: f64,
    rounds: usize,
}

/// What the filter did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilterReport {
    /// Meetings turned into contacts.
    pub contacts: usize,
    /// Rounds of projections.
    pub rounds: usize,
    /// Vertices that move as one with others.
    pub zoned: usize,
    /// Whether the mesh stays where it was.
    pub held: bool,
}

/// Rounds of projections before what meets moves as one.
const ROUNDS: usize = 20;

/// Distances below this part of the coordinates are none: they have no side.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// Two places that meet: four vertices with weights, and the direction across.
struct Meeting {
    vertices: [usize; 4],
    weights: [f64; 4],
    across: Vector3<f64>,
}

impl MeshFilter {
    /// A filter for vertices of these masses (kg), some of them pinned (they move as they are
    /// told), and these triangles. Meetings are found to `tolerance` metres.
    ///
    /// # Errors
    /// [`ContactError::Size`] unless each vertex is said to be pinned or not;
    /// [`ContactError::NoSuchVertex`]; [`ContactError::Flat`] for a triangle that names a vertex
    /// twice; [`ContactError::Mass`] for one that is not positive and finite;
    /// [`ContactError::Tolerance`] for one that is not.
    pub fn new(
        masses: Vec<f64>,
        pinned: Vec<bool>,
        triangles: Vec<[usize; 3]>,
        tolerance: f64,
    ) -> Result<Self, ContactError> {
        SizeError::check("the vertices that may be pinned", masses.len(), pinned.len())?;
        Closeness { thickness: 0.0, tolerance }.check(0.0)?;
        let vertices = masses.len();
        let mut edges = BTreeSet::new();
        for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
            if let Some(&vertex) = [a, b, c].iter().find(|&&vertex| vertex >= vertices) {
                return Err(ContactError::NoSuchVertex { triangle, vertex, vertices });
            }
            if a == b || b == c || c == a {
                return Err(ContactError::Flat { shape: "triangle" });
            }
            edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
        }
        let metric = DiagonalMetric::particles::<3>(&masses)?;
        let held = (0..3 * vertices).filter(|freedom| pinned[freedom / 3]);
        let mass = InverseMass::of(&metric)?.holding(held.collect::<Vec<_>>());
        let edges = edges.into_iter().collect();
        Ok(MeshFilter { triangles, edges, masses, pinned, mass, tolerance, rounds: ROUNDS })
    }

    /// The same with another number of rounds before what meets moves as one; none, and it does at
    /// once.
    pub fn with_rounds(self, rounds: usize) -> Self {
        MeshFilter { rounds, ..self }
    }

    /// Changes the velocities of the vertices so that nothing meets on the way from `q` to `q + h
    /// v`.
    ///
    /// # Errors
    /// [`ContactError::Step`] unless `h` is positive and finite; [`ContactError::Size`];
    /// [`ContactError::Touching`] where what meets starts at distance 0, so that no side is its own;
    /// [`ContactError::NonFinite`] and [`ContactError::Tolerance`], as of
    /// [`particle_meets_triangle`] for what comes near; [`ContactError::Immovable`] for a meeting
    /// along which nothing can move; [`ContactError::NotConverged`]. The velocities are then as
    /// they were.
    pub fn filter(
        &self,
        q: &[f64],
        h: f64,
        v: Vector<&mut [f64]>,
    ) -> Result<FilterReport, ContactError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(StepError::Step(h).into());
        }
        let freedoms = 3 * self.masses.len();
        SizeError::check("the mesh's coordinates", freedoms, q.len())?;
        SizeError::check("the mesh's velocities", freedoms, v.0.len())?;
        check_finite("the mesh", q)?;
        check_finite("the mesh's velocity", v.0)?;
        let (mut next, mut report) = (Vector(v.0.to_vec()), FilterReport::default());
        let mut meetings = Vec::new();
        for _ in 0..self.rounds {
            let found = self.meetings(q, h, &next)?;
            if found.is_empty() {
                v.0.copy_from_slice(&next.0);
                return Ok(report);
            }
            report.rounds += 1;
            report.contacts += found.len();
            meetings.extend(found);
            next.0.copy_from_slice(v.0);
            self.project(&meetings, &mut next)?;
        }
        self.move_as_one(q, h, &mut next, &mut report)?;
        v.0.copy_from_slice(&next.0);
        Ok(report)
    }

    /// Meetings on the way; none is a proof that there are none.
    fn meetings(
        &self,
        q: &[f64],
        h: f64,
        v: &Vector<Vec<f64>>,
    ) -> Result<Vec<Meeting>, ContactError> {
        let moving = |vertex: usize| {
            let start = Vector3::from_column_slice(&q[3 * vertex..][..3]);
            let go = Vector3::from_column_slice(&v.0[3 * vertex..][..3]);
            Moving { start, end: start + go * h }
        };
        let corners: Vec<Moving> = (0..self.masses.len()).map(moving).collect();
        let close = Closeness { thickness: 0.0, tolerance: self.tolerance };
        let boxed = |of: &[usize]| {
            let moves: Vec<Moving> = of.iter().map(|&vertex| corners[vertex]).collect();
            SweptBox::of(&moves, self.tolerance)
        };
        let particles: Vec<_> = (0..corners.len()).map(|vertex| boxed(&[vertex])).collect();
        let triangles: Vec<_> = self.triangles.iter().map(|t| boxed(t)).collect();
        let edges: Vec<_> = self.edges.iter().map(|e| boxed(e)).collect();
        let mut found = Vec::new();
        for (p, t) in overlapping(&particles, &triangles) {
            let [a, b, c] = self.triangles[t];
            if [a, b, c].contains(&p) || self.all_pinned(&[p, a, b, c]) {
                continue;
            }
            let triangle = [corners[a], corners[b], corners[c]];
            if let Some(hit) = particle_meets_triangle(&corners[p], &triangle, close)? {
                let [u, v] = hit.place;
                let weights = [1.0, u + v - 1.0, -u, -v];
                let [x, y, z] = triangle.map(|corner| corner.at(hit.time));
                let across = (y - x).cross(&(z - x));
                found.push(Meeting::new([p, a, b, c], weights, across, &corners)?);
            }
        }
        for (i, j) in overlapping(&edges, &edges).into_iter().filter(|(i, j)| i < j) {
            let ([a, b], [c, d]) = (self.edges[i], self.edges[j]);
            if [c, d].contains(&a) || [c, d].contains(&b) || self.all_pinned(&[a, b, c, d]) {
                continue;
            }
            let (first, second) = ([corners[a], corners[b]], [corners[c], corners[d]]);
            if let Some(hit) = edge_meets_edge(&first, &second, close)? {
                let [u, v] = hit.place;
                let weights = [1.0 - u, u, v - 1.0, -v];
                let [first, second] =
                    [first, second].map(|[from, to]| to.at(hit.time) - from.at(hit.time));
                found.push(Meeting::new([a, b, c, d], weights, first.cross(&second), &corners)?);
            }
        }
        Ok(found)
    }

    fn all_pinned(&self, vertices: &[usize]) -> bool {
        vertices.iter().all(|&vertex| self.pinned[vertex])
    }

    fn project(&self, meetings: &[Meeting], v: &mut Vector<Vec<f64>>) -> Result<(), ContactError> {
        let mut rows = ContactRows::new();
        for meeting in meetings {
            let corners = meeting.vertices.into_iter().zip(meeting.weights);
            rows.push(corners.flat_map(|(vertex, weight)| {
                [0, 1, 2].map(|k| (3 * vertex + k, weight * meeting.across[k]))
            }));
        }
        let impact = Impact::new(rows, &self.mass, vec![0.0; meetings.len()])?;
        project(&impact, v.view_mut())?;
        Ok(())
    }

    /// Gives what still meets common velocities.
    fn move_as_one(
        &self,
        q: &[f64],
        h: f64,
        v: &mut Vector<Vec<f64>>,
        report: &mut FilterReport,
    ) -> Result<(), ContactError> {
        let mut zones = Groups::new(self.masses.len());
        // Each round joins at least two vertices.
        for _ in 0..self.masses.len() {
            let found = self.meetings(q, h, v)?;
            if found.is_empty() {
                return Ok(());
            }
            for meeting in &found {
                let [first, rest @ ..] = meeting.vertices;
                rest.into_iter().for_each(|vertex| zones.join(first, vertex));
            }
            report.zoned = self.unite(&mut zones, v);
        }
        report.held = true;
        v.0.fill(0.0);
        Ok(())
    }

    /// The velocity of each zone becomes that of its centre of mass, or of what is pinned in it;
    /// says how many vertices are in zones.
    fn unite(&self, zones: &mut Groups, v: &mut Vector<Vec<f64>>) -> usize {
        let vertices = self.masses.len();
        let root: Vec<usize> = (0..vertices).map(|vertex| zones.find(vertex)).collect();
        let mut mean = vec![(0.0, Vector3::zeros(), false, 0_usize); vertices];
        for vertex in 0..vertices {
            let own = Vector3::from_column_slice(&v.0[3 * vertex..][..3]);
            let (mass, momentum, pinned, count) = &mut mean[root[vertex]];
            *count += 1;
            if self.pinned[vertex] && !*pinned {
                (*mass, *momentum, *pinned) = (1.0, own, true);
            } else if !*pinned {
                *mass += self.masses[vertex];
                *momentum += own * self.masses[vertex];
            }
        }
        for vertex in (0..vertices).filter(|&vertex| !self.pinned[vertex]) {
            let (mass, momentum, _, count) = &mean[root[vertex]];
            if *count > 1 {
                v.0[3 * vertex..][..3].copy_from_slice((momentum / *mass).as_slice());
            }
        }
        mean.iter().map(|zone| zone.3).filter(|&count| count > 1).sum()
    }
}

impl Meeting {
    /// A meeting across a direction, which is turned to the side on which it starts; an error where
    /// that is on neither.
    fn new(
        vertices: [usize; 4],
        weights: [f64; 4],
        across: Vector3<f64>,
        corners: &[Moving],
    ) -> Result<Self, ContactError> {
        let places = vertices.map(|vertex| corners[vertex].start);
        let start: Vector3<f64> = places.iter().zip(&weights).map(|(x, w)| x * *w).sum();
        let rounding = ROUNDINGS * places.iter().fold(0.0, |most: f64, x| most.max(x.amax()));
        let across = match across.try_normalize(0.0) {
            Some(n) if n.dot(&start).abs() > rounding => n * n.dot(&start).signum(),
            _ if start.norm() > rounding => start.normalize(),
            _ => return Err(ContactError::Touching { vertices }),
        };
        Ok(Meeting { vertices, weights, across })
    }
}
