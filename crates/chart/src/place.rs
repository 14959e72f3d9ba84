//! Labels that do not overlap: a column of them pushed apart, or the free spot beside a curve.

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rect {
    pub(crate) fn around((x, y): (f64, f64), width: f64, height: f64) -> Self {
        let (w, h) = (0.5 * width, 0.5 * height);
        Rect { left: x - w, top: y - h, right: x + w, bottom: y + h }
    }

    pub(crate) fn contains(&self, (x, y): (f64, f64)) -> bool {
        self.left <= x && x <= self.right && self.top <= y && y <= self.bottom
    }

    pub(crate) fn encloses(&self, other: &Rect) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right, other.bottom))
    }

    pub(crate) fn overlaps(&self, other: &Rect) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// The part of a segment inside, if any (Liang-Barsky).
    pub(crate) fn clip(&self, a: (f64, f64), b: (f64, f64)) -> Option<[(f64, f64); 2]> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (slope, room) in [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ] {
            if slope == 0.0 && room < 0.0 {
                return None;
            } else if slope < 0.0 {
                enter = enter.max(room / slope);
            } else if slope > 0.0 {
                leave = leave.min(room / slope);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        (enter < leave).then(|| [at(enter), at(leave)])
    }
}

/// What is already drawn: a label must not cover it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Crowd {
    ink: Vec<(f64, f64)>,
    labels: Vec<Rect>,
}

impl Crowd {
    /// Ink along a polyline, sampled every few pixels.
    pub(crate) fn add_polyline(&mut self, points: &[(f64, f64)]) {
        self.ink.extend_from_slice(points);
        for pair in points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let pieces = ((b.0 - a.0).hypot(b.1 - a.1) / 4.0).ceil().clamp(1.0, 500.0);
            let between = (1..pieces as usize).map(|i| i as f64 / pieces);
            self.ink.extend(between.map(|t| (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1))));
        }
    }

    pub(crate) fn add_label(&mut self, label: Rect) {
        self.labels.push(label);
    }

    /// How bad a label would be there: nothing is worse than covering another label.
    fn cost(&self, label: &Rect) -> usize {
        let covered = self.labels.iter().filter(|other| other.overlaps(label)).count();
        let padded = Rect {
            left: label.left - 2.0,
            top: label.top - 1.0,
            right: label.right + 2.0,
            bottom: label.bottom + 1.0,
        };
        let inked = self.ink.iter().filter(|&&point| padded.contains(point)).count();
        10_000 * covered + inked
    }

    /// Whether a label would cover no other.
    pub(crate) fn has_no_label(&self, spot: &Rect) -> bool {
        self.labels.iter().all(|other| !other.overlaps(spot))
    }

    /// The first spot that covers nothing.
    pub(crate) fn free(&self, spots: impl IntoIterator<Item = Rect>, page: &Rect) -> Option<Rect> {
        spots.into_iter().find(|spot| page.encloses(spot) && self.cost(spot) == 0)
    }

    /// The spot that covers least, the first of equals; `None` when each leaves the page or covers
    /// another label.
    pub(crate) fn best(&self, spots: impl IntoIterator<Item = Rect>, page: &Rect) -> Option<Rect> {
        let spots = spots.into_iter().filter(|spot| page.encloses(spot));
        spots
            .map(|spot| (self.cost(&spot), spot))
            .min_by_key(|(cost, _)| *cost)
            .filter(|(cost, _)| *cost < 10_000)
            .map(|(_, spot)| spot)
    }
}

/// Moves positions as little as possible (least squares) so that they are `gap` apart and between
/// `low` and `high`. Order is kept; if there is no room for all, they are evenly spaced.
///
/// With `z_i = y_i - i gap` this is isotonic regression, solved by pooling neighbours.
pub(crate) fn spread(ideal: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    let count = ideal.len();
    let gap = gap.min((high - low) / (count.max(2) - 1) as f64);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&i, &j| ideal[i].total_cmp(&ideal[j]));
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (rank, &i) in order.iter().enumerate() {
        let mut pool = (ideal[i] - rank as f64 * gap, 1);
        while let Some(&(mean, size)) = pools.last().filter(|(mean, _)| *mean > pool.0) {
            pools.pop();
            let total = size + pool.1;
            pool = ((mean * size as f64 + pool.0 * pool.1 as f64) / total as f64, total);
        }
        pools.push(pool);
    }
    let highest = high - count.saturating_sub(1) as f64 * gap;
    let pooled = pools.iter().flat_map(|&(mean, size)| std::iter::repeat_n(mean, size));
    let mut positions = vec![0.0; count];
    for ((rank, &i), mean) in order.iter().enumerate().zip(pooled) {
        positions[i] = mean.min(highest).max(low) + rank as f64 * gap;
    }
    positions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_with_room_stay_where_they_are() {
        assert_eq!(spread(&[10.0, 50.0, 90.0], 16.0, 0.0, 100.0), [10.0, 50.0, 90.0]);
    }

    #[test]
    fn labels_that_collide_move_apart_about_their_middle() {
        assert_eq!(spread(&[50.0, 50.0, 50.0], 16.0, 0.0, 100.0), [34.0, 50.0, 66.0]);
    }

    #[test]
    fn labels_stay_apart_and_inside_whatever_their_ends() {
        for ideal in [vec![0.0; 6], vec![100.0; 6], vec![99.0, 3.0, 98.0, 2.0, 50.0, 51.0]] {
            let mut placed = spread(&ideal, 16.0, 0.0, 100.0);
            placed.sort_by(f64::total_cmp);
            assert!(placed.windows(2).all(|p| p[1] - p[0] > 16.0 - 1e-9), "{placed:?}");
            assert!(placed[0] >= 0.0 && placed[5] <= 100.0 + 1e-9, "{placed:?}");
        }
    }

    #[test]
    fn too_many_labels_share_the_room_evenly() {
        let placed = spread(&[5.0; 11], 16.0, 0.0, 100.0);
        assert!(placed.windows(2).all(|p| (p[1] - p[0] - 10.0).abs() < 1e-9), "{placed:?}");
        assert!(spread(&[], 16.0, 0.0, 100.0).is_empty());
    }

    #[test]
    fn a_free_spot_covers_neither_ink_nor_labels() {
        let page = Rect { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };
        let mut crowd = Crowd::default();
        crowd.add_polyline(&[(0.0, 20.0), (100.0, 20.0)]);
        crowd.add_label(Rect::around((50.0, 50.0), 40.0, 16.0));
        let spots = [20.0, 45.0, 80.0].map(|y| Rect::around((50.0, y), 40.0, 16.0));
        assert_eq!(crowd.free(spots, &page), Some(spots[2]));
        let outside = Rect::around((95.0, 80.0), 40.0, 16.0);
        assert_eq!(crowd.free([outside], &page), None);
        assert_eq!(crowd.best([spots[0], spots[1]], &page), Some(spots[0]));
    }

    #[test]
    fn a_segment_is_cut_at_the_border() {
        let page = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        assert_eq!(page.clip((-5.0, 5.0), (15.0, 5.0)), Some([(0.0, 5.0), (10.0, 5.0)]));
        assert_eq!(page.clip((-5.0, 20.0), (15.0, 20.0)), None);
        let nowhere = page.clip((f64::NAN, 0.0), (1.0, 1.0));
        assert!(!nowhere.is_some_and(|[a, _]| a.0.is_finite()));
    }
}
