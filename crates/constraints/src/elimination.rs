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
//! Columns one after the other with the same rows below them, such as the equations of one joint, make a
//! front (supernode), kept as a dense block of its rows. What a front takes from the entries of later ones
//! goes by runs of consecutive entries of a row.
//!
//! Source: Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134; Davis, Direct Methods for Sparse Linear
//! Systems (2006), chapters 4 and 7. Knows no numbers.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

/// No parent in the elimination tree.
const ROOT: u32 = u32::MAX;

/// Columns of a front, at most: so many numbers stay in registers.
pub(crate) const WIDEST: usize = 6;

/// The order, and the places of the factor's entries below its diagonal.
#[derive(Clone, Debug)]
pub(crate) struct Elimination {
    /// Of each place its equation.
    pub(crate) order: Vec<u32>,
    /// Of each equation its place.
    pub(crate) place: Vec<u32>,
    /// The first column of each row, or the row itself.
    pub(crate) first: Vec<u32>,
    pub(crate) fronts: Vec<Front>,
    /// The front of each column.
    fronts_of: Vec<u32>,
    /// The rows of all fronts, those of its own columns first.
    rows: Vec<u32>,
    /// The updates of all fronts.
    pub(crate) updates: Vec<Update>,
    /// The numbers of all blocks.
    len: usize,
}

/// Columns with the same rows below them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Front {
    /// The first column, and how many.
    pub(crate) start: usize,
    pub(crate) width: usize,
    /// Where its rows start, and how many.
    rows: usize,
    height: usize,
    /// Where its block starts, `height` rows of `width` numbers.
    pub(crate) block: usize,
    /// How many updates it makes.
    pub(crate) updates: usize,
}

/// A run of entries in a row of a later front, which products of a row of the block with consecutive others
/// change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Update {
    /// The row and the first of the others, counted from the first below the front's columns.
    pub(crate) row: u32,
    pub(crate) from: u32,
    pub(crate) len: u32,
    /// Where the run starts among the blocks of later fronts.
    pub(crate) to: u32,
}

impl Front {
    /// Where its block is.
    #[inline]
    pub(crate) fn block(&self) -> Range<usize> {
        self.block..self.block + self.height * self.width
    }
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
        let mut columns: Vec<Vec<u32>> = vec![Vec::new(); count];
        let mut first: Vec<u32> = (0..count as u32).collect();
        let mut seen = vec![ROOT; count];
        for (row, firsts) in stars.iter().enumerate() {
            seen[row] = row as u32;
            for &star in firsts {
                let mut at = star;
                while seen[at as usize] != row as u32 {
                    seen[at as usize] = row as u32;
                    columns[at as usize].push(row as u32);
                    first[row] = first[row].min(at);
                    at = parents[at as usize];
                }
            }
        }
        let (fronts, fronts_of, rows, updates) = <_>::default();
        let mut found =
            Elimination { order, place, first, fronts, fronts_of, rows, updates, len: 0 };
        let mut start = 0;
        for end in 1..=count {
            let goes_on = end < count
                && end - start < WIDEST
                && columns[end - 1].first() == Some(&(end as u32))
                && columns[end - 1].len() == columns[end].len() + 1;
            if !goes_on {
                found.push_front(start, &columns[start..end]);
                start = end;
            }
        }
        found.find_updates();
        found
    }

    fn push_front(&mut self, start: usize, columns: &[Vec<u32>]) {
        let (rows, width) = (self.rows.len(), columns.len());
        self.rows.push(start as u32);
        self.rows.extend_from_slice(&columns[0]);
        let height = 1 + columns[0].len();
        self.fronts_of.resize(start + width, self.fronts.len() as u32);
        self.fronts.push(Front { start, width, rows, height, block: self.len, updates: 0 });
        self.len += height * width;
    }

    fn find_updates(&mut self) {
        for front in 0..self.fronts.len() {
            let before = self.updates.len();
            let later = self.fronts[front].block().end;
            let below = self.below(&self.fronts[front]).to_vec();
            for (row, &at) in below.iter().enumerate() {
                let mut run: Option<Update> = None;
                for (from, &column) in below[..row].iter().enumerate() {
                    let to = (self.slot(at, column) - later) as u32;
                    match &mut run {
                        Some(run) if run.to + run.len == to => run.len += 1,
                        _ => {
                            let (row, from) = (row as u32, from as u32);
                            self.updates.extend(run.replace(Update { row, from, len: 1, to }));
                        }
                    }
                }
                self.updates.extend(run);
            }
            self.fronts[front].updates = self.updates.len() - before;
        }
    }

    /// The numbers of all blocks.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// The rows of a front: its columns, and those below them.
    #[inline]
    fn rows(&self, front: &Front) -> &[u32] {
        &self.rows[front.rows..front.rows + front.height]
    }

    /// The rows of a front below its columns.
    #[inline]
    pub(crate) fn below(&self, front: &Front) -> &[u32] {
        &self.rows(front)[front.width..]
    }

    /// Of a column the rows below its diagonal, and where their entries are.
    #[inline]
    pub(crate) fn column(&self, column: usize) -> impl Iterator<Item = (usize, usize)> {
        let front = &self.fronts[self.fronts_of[column] as usize];
        let own = column - front.start;
        let rows = self.rows(front).iter().enumerate().skip(own + 1);
        rows.map(move |(at, &row)| (row as usize, front.block + at * front.width + own))
    }

    /// Where the entry of two places of an element is kept: among those below the diagonal, or after all
    /// blocks on it.
    pub(crate) fn slot(&self, a: u32, b: u32) -> usize {
        let (row, column) = (a.max(b), a.min(b) as usize);
        let front = &self.fronts[self.fronts_of[column] as usize];
        match self.rows(front).binary_search(&row) {
            Ok(at) if row as usize != column => {
                front.block + at * front.width + column - front.start
            }
            _ => self.len() + row as usize,
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

    fn entries(elimination: &Elimination) -> usize {
        (0..elimination.order.len()).map(|column| elimination.column(column).count()).sum()
    }

    #[test]
    fn a_chain_is_eliminated_without_fill_and_a_star_from_its_ends() {
        let chain: Vec<Vec<u32>> = (0..99).map(|i| vec![i, i + 1]).collect();
        let found = Elimination::of(100, &chain);
        assert_eq!(entries(&found), 99);
        let star: Vec<Vec<u32>> = (1..50).map(|i| vec![0, i]).collect();
        let found = Elimination::of(50, &star);
        assert_eq!(entries(&found), 49);
        assert!(found.place[0] >= 48);
    }

    #[test]
    fn joints_of_a_chain_are_fronts() {
        let joints = 40_u32;
        let bodies = (0..joints).map(|k| (3 * k..3 * (k + 2).min(joints)).collect());
        let found = Elimination::of(120, &bodies.collect::<Vec<Vec<u32>>>());
        // The last two joints meet no others when their turn comes.
        assert_eq!(found.fronts.len(), 39);
        assert!(found.fronts[..38].iter().all(|front| front.width == 3 && front.updates == 2));
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
        for (column, row) in meets.iter().enumerate() {
            let below = (column + 1..count).filter(|&row| meets[row][column]);
            let expected: Vec<u32> = below.map(|row| row as u32).collect();
            let own: Vec<u32> = found.column(column).map(|entry| entry.0 as u32).collect();
            assert_eq!(own, expected, "column {column}");
            let first = (0..=column).find(|&before| row[before] || before == column);
            assert_eq!(Some(found.first[column] as usize), first, "row {column}");
        }
        let mut sorted = found.order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..count as u32).collect::<Vec<_>>());
    }
}
