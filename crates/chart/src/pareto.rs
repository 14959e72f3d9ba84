//! The Pareto front: the points that no other point beats on cost and on error at once.

/// Indices of the points on the front, by increasing cost. A point is `(cost, error)`, smaller is
/// better for both; points with a number that is not finite are on no front.
///
/// ```
/// let points = [(1.0, 9.0), (2.0, 3.0), (3.0, 4.0), (4.0, 1.0)];
/// assert_eq!(stationary_chart::pareto(&points), [0, 1, 3]);
/// ```
pub fn pareto(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    order.sort_by(|&i, &j| {
        points[i].0.total_cmp(&points[j].0).then(points[i].1.total_cmp(&points[j].1))
    });
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        let beats_the_last = front.last().is_none_or(|&last| points[i].1 < points[last].1);
        let equals_the_last = front.last().is_some_and(|&last| points[i] == points[last]);
        if beats_the_last || equals_the_last {
            front.push(i);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dominated_point_is_not_on_the_front() {
        assert_eq!(pareto(&[(1.0, 1.0), (2.0, 2.0)]), [0]);
        assert_eq!(pareto(&[(2.0, 2.0), (1.0, 1.0)]), [1]);
    }

    #[test]
    fn at_equal_cost_only_the_smaller_error_is_on_the_front() {
        assert_eq!(pareto(&[(1.0, 2.0), (1.0, 1.0)]), [1]);
    }

    #[test]
    fn equal_points_share_the_front() {
        assert_eq!(pareto(&[(1.0, 1.0), (1.0, 1.0)]), [0, 1]);
    }

    #[test]
    fn points_that_are_not_finite_are_on_no_front() {
        assert_eq!(pareto(&[(f64::NAN, 0.0), (1.0, f64::INFINITY), (2.0, 1.0)]), [2]);
        assert!(pareto(&[]).is_empty());
    }
}
