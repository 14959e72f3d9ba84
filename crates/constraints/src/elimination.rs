//! The order in which equations are eliminated, and where the factor has entries: found once.
//!
//! ```text
//! P S P^T = L L^T,     S = sum over elements of dense blocks
//! ```
//! `S` m x m; an element is a set of equations that share a freedom, and that all meet in S. Eliminating
//! an equation makes one element of all that it was in, which is a clique of the factor: equations with
//! the fewest neighbours go first (minimum degree), ties by number. The order is then one in which
//! descendants in the elimination tree come just before their ancestor. For a chain it runs from one
//! end to the other, and the factor has no more entries than S.
//!
//! Source: Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134; Davis, Direct Methods for Sparse Linear
//! Systems (2006), chapters 4 and 7. Knows no numbers.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// No parent in the elimination tree.
const ROOT: u32 = u32::MAX;

/// The order and the places of the factor's entries below its diagonal, by rows and by columns.
#[derive(Clone, Debug)]
pub(crate) struct Elimination {
    /// Of each place its equation.
    pub(crate) order: Vec<u32>,
    /// Of each equation its place.
    pub(crate) place: Vec<u32>,
    /// Columns of each row, ascending.
    pub(crate) row_starts: Vec<usize>,
    pub(crate) row_columns: Vec<u32>,
    /// Rows of each column, ascending.
    pub(crate) column_starts: Vec<usize>,
    pub(crate) column_rows: Vec<u32>,
}

impl Elimination {
    /// Of `count` equations that meet where they are in an element together.
    pub(crate) fn of(count: usize, elements: &[Vec<u32>]) -> Self {
        let order = minimum_degree(count, elements);
        let parents = tree(&stars(count, elements, &inverse(&order)));
        let order: Vec<u32> = postorder(&parents).into_iter().map(|p| order[p]).collect();
        let place = inverse(&order);
        let stars = stars(count, elements, &place);
        let parents = tree(&stars);
        let (mut row_starts, mut row_columns) = (vec![0], Vec::new());
        let mut column_counts = vec![0_usize; count];
        let mut seen = vec![ROOT; count];
        for (row, firsts) in stars.iter().enumerate() {
            let start = row_columns.len();
            seen[row] = row as u32;
            for &first in firsts {
                let mut at = first;
                while seen[at as usize] != row as u32 {
                    seen[at as usize] = row as u32;
                    row_columns.push(at);
                    column_counts[at as usize] += 1;
                    at = parents[at as usize];
                }
            }
            row_columns[start..].sort_unstable();
            row_starts.push(row_columns.len());
        }
        let mut column_starts = vec![0];
        for count in column_counts {
            column_starts.push(column_starts.last().copied().unwrap_or(0) + count);
        }
        let mut column_rows = vec![0; row_columns.len()];
        let mut next = column_starts.clone();
        for row in 0..count {
            for &column in &row_columns[row_starts[row]..row_starts[row + 1]] {
                column_rows[next[column as usize]] = row as u32;
                next[column as usize] += 1;
            }
        }
        Elimination { order, place, row_starts, row_columns, column_starts, column_rows }
    }

    /// The entries below the diagonal.
    pub(crate) fn len(&self) -> usize {
        self.row_columns.len()
    }

    /// Where the entry of two places of an element is kept: among those below the diagonal by rows, or
    /// after all of them on it.
    pub(crate) fn slot(&self, a: u32, b: u32) -> usize {
        let (row, column) = (a.max(b) as usize, a.min(b));
        let start = self.row_starts[row];
        match self.row_columns[start..self.row_starts[row + 1]].binary_search(&column) {
            Ok(at) => start + at,
            Err(_) => self.len() + row,
        }
    }
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut place = vec![0; order.len()];
    for (at, &equation) in order.iter().enumerate() {
        place[equation as usize] = at as u32;
    }
    place
}

/// Equations in the order of their number of neighbours, which changes as they go.
fn minimum_degree(count: usize, elements: &[Vec<u32>]) -> Vec<u32> {
    let mut elements = elements.to_vec();
    let mut own: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (element, equations) in elements.iter().enumerate() {
        equations.iter().for_each(|&equation| own[equation as usize].push(element as u32));
    }
    let mut seen = vec![ROOT; count];
    // The neighbours of an equation; the mark is of this question alone.
    let union = |own: &[u32], elements: &[Vec<u32>], seen: &mut [u32], mark: u32, of: u32| {
        seen[of as usize] = mark;
        let all = own.iter().flat_map(|&element| &elements[element as usize]);
        let fresh =
            |equation: &&u32| std::mem::replace(&mut seen[**equation as usize], mark) != mark;
        all.filter(fresh).copied().collect::<Vec<u32>>()
    };
    let mut mark = 0;
    let mut degree = vec![0_usize; count];
    let mut queue = BinaryHeap::new();
    for equation in 0..count as u32 {
        mark += 1;
        degree[equation as usize] =
            union(&own[equation as usize], &elements, &mut seen, mark, equation).len();
        queue.push(Reverse((degree[equation as usize], equation)));
    }
    let mut order = Vec::with_capacity(count);
    let mut done = vec![false; count];
    while let Some(Reverse((asked, equation))) = queue.pop() {
        let at = equation as usize;
        if done[at] || asked != degree[at] {
            continue;
        }
        done[at] = true;
        order.push(equation);
        mark += 1;
        let absorbed = std::mem::take(&mut own[at]);
        let neighbours = union(&absorbed, &elements, &mut seen, mark, equation);
        absorbed.iter().for_each(|&element| elements[element as usize].clear());
        let made = elements.len() as u32;
        elements.push(neighbours.clone());
        for &neighbour in &neighbours {
            let own = &mut own[neighbour as usize];
            own.retain(|&element| !elements[element as usize].is_empty());
            own.push(made);
        }
        for &neighbour in &neighbours {
            mark += 1;
            let own = &own[neighbour as usize];
            let now = union(own, &elements, &mut seen, mark, neighbour).len();
            if now != degree[neighbour as usize] {
                degree[neighbour as usize] = now;
                queue.push(Reverse((now, neighbour)));
            }
        }
    }
    order
}

/// For each place the first places of the elements that it is in: enough to tell the factor's entries,
/// because the elimination of the first makes a clique of the others.
fn stars(count: usize, elements: &[Vec<u32>], place: &[u32]) -> Vec<Vec<u32>> {
    let mut stars: Vec<Vec<u32>> = vec![Vec::new(); count];
    for element in elements {
        let Some(first) = element.iter().map(|&e| place[e as usize]).min() else { continue };
        for &equation in element {
            let at = place[equation as usize];
            if at != first {
                stars[at as usize].push(first);
            }
        }
    }
    stars
}

/// The parent of each place: the first place that its elimination touches.
fn tree(stars: &[Vec<u32>]) -> Vec<u32> {
    let mut parents = vec![ROOT; stars.len()];
    let mut ancestors = parents.clone();
    for (row, firsts) in stars.iter().enumerate() {
        for &first in firsts {
            let mut at = first;
            while at != ROOT && at as usize != row {
                let next = std::mem::replace(&mut ancestors[at as usize], row as u32);
                if next == ROOT {
                    parents[at as usize] = row as u32;
                }
                at = next;
            }
        }
    }
    parents
}

/// Places so that the descendants of each come just before it.
fn postorder(parents: &[u32]) -> Vec<usize> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parents.len()];
    let mut order = Vec::with_capacity(parents.len());
    for (place, &parent) in parents.iter().enumerate() {
        if parent != ROOT {
            children[parent as usize].push(place);
        }
    }
    let mut open = Vec::new();
    for root in (0..parents.len()).filter(|&place| parents[place] == ROOT) {
        open.push((root, 0));
        while let Some((place, next)) = open.pop() {
            match children[place].get(next) {
                Some(&child) => open.extend([(place, next + 1), (child, 0)]),
                None => order.push(place),
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_is_eliminated_without_fill_and_a_star_from_its_ends() {
        let chain: Vec<Vec<u32>> = (0..99).map(|i| vec![i, i + 1]).collect();
        let found = Elimination::of(100, &chain);
        assert_eq!(found.len(), 99);
        let star: Vec<Vec<u32>> = (1..50).map(|i| vec![0, i]).collect();
        let found = Elimination::of(50, &star);
        assert_eq!(found.len(), 49);
        assert!(found.place[0] >= 48);
    }

    #[test]
    fn the_factors_entries_are_those_of_an_elimination_by_hand() {
        // A grid whose nodes meet along its edges, with one element of three.
        let side = 7_u32;
        let mut elements = vec![vec![0, 9, 40]];
        for x in 0..side {
            for y in 0..side {
                let i = x * side + y;
                elements.extend((y + 1 < side).then(|| vec![i, i + 1]));
                elements.extend((x + 1 < side).then(|| vec![i + side, i]));
            }
        }
        let count = (side * side) as usize;
        let found = Elimination::of(count, &elements);
        let mut meets = vec![vec![false; count]; count];
        for element in &elements {
            for &a in element {
                for &b in element {
                    meets[found.place[a as usize] as usize][found.place[b as usize] as usize] =
                        true;
                }
            }
        }
        for pivot in 0..count {
            let after: Vec<usize> = (pivot + 1..count).filter(|&i| meets[i][pivot]).collect();
            for &a in &after {
                after.iter().for_each(|&b| meets[a][b] = true);
            }
        }
        for (row, meets) in meets.iter().enumerate() {
            let expected: Vec<u32> =
                (0..row).filter(|&column| meets[column]).map(|c| c as u32).collect();
            let own = &found.row_columns[found.row_starts[row]..found.row_starts[row + 1]];
            assert_eq!(own, expected, "row {row}");
        }
        let mut sorted = found.order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..count as u32).collect::<Vec<_>>());
    }
}
