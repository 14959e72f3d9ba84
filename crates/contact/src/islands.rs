//! Islands: bodies that hang together by contacts, and the contacts between them.
//!
//! ```text
//! bodies are joined by contacts;   an island is a connected component
//! ```
//! What does not move joins nothing, so that a floor does not make one island of all that stand on
//! it. Islands, their contacts and their bodies come in ascending order; the memory is kept from
//! call to call.

use crate::inverse_mass::Groups;

/// Connected components, and the memory that finding them takes.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    groups: Groups,
    /// The island of each body, by the representative of its group.
    island_of: Vec<usize>,
    contacts: Sorted,
    bodies: Sorted,
}

/// Numbers sorted by the island that they belong to.
#[derive(Debug, Default)]
struct Sorted {
    starts: Vec<usize>,
    members: Vec<usize>,
}

const NONE: usize = usize::MAX;

impl Islands {
    /// Finds the islands of `bodies` bodies; the body numbered `bodies` stands for what does not
    /// move. A contact has at least one body that does.
    pub(crate) fn find(
        &mut self,
        bodies: usize,
        contacts: impl Fn(usize) -> [usize; 2],
        count: usize,
    ) {
        self.groups.reset(bodies);
        for contact in 0..count {
            let [a, b] = contacts(contact);
            if a < bodies && b < bodies {
                self.groups.join(a, b);
            }
        }
        self.island_of.clear();
        self.island_of.resize(bodies, NONE);
        let mut islands = 0;
        for contact in 0..count {
            let root = self.groups.find(contacts(contact)[0].min(contacts(contact)[1]));
            if self.island_of[root] == NONE {
                self.island_of[root] = islands;
                islands += 1;
            }
        }
        for body in 0..bodies {
            let root = self.groups.find(body);
            self.island_of[body] = self.island_of[root];
        }
        let island_of = &self.island_of;
        let of_contact = |i: usize| island_of[contacts(i)[0].min(contacts(i)[1])];
        self.contacts.sort(islands, count, of_contact);
        self.bodies.sort(islands, bodies, |body| island_of[body]);
    }

    /// The contacts and the bodies of each island.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&[usize], &[usize])> {
        self.contacts.iter().zip(self.bodies.iter())
    }
}

impl Sorted {
    fn sort(&mut self, islands: usize, count: usize, of: impl Fn(usize) -> usize) {
        self.starts.clear();
        self.starts.resize(islands + 1, 0);
        let belongs = |&i: &usize| of(i) != NONE;
        (0..count).filter(belongs).for_each(|i| self.starts[of(i)] += 1);
        let mut sum = 0;
        for start in &mut self.starts {
            (*start, sum) = (sum, sum + *start);
        }
        self.members.clear();
        self.members.resize(sum, 0);
        for i in (0..count).filter(belongs) {
            let place = &mut self.starts[of(i)];
            self.members[*place] = i;
            *place += 1;
        }
        // Each start has moved on to the next one.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    fn iter(&self) -> impl Iterator<Item = &[usize]> {
        self.starts.windows(2).map(|range| &self.members[range[0]..range[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_floor_joins_nothing_and_chains_are_one_island() {
        let contacts = [[6, 1], [1, 4], [3, 6], [4, 5], [6, 3]];
        let mut islands = Islands::default();
        for _ in 0..2 {
            islands.find(6, |i| contacts[i], contacts.len());
            let found: Vec<_> = islands.iter().map(|(c, b)| (c.to_vec(), b.to_vec())).collect();
            assert_eq!(found, [(vec![0, 1, 3], vec![1, 4, 5]), (vec![2, 4], vec![3])]);
        }
    }

    #[test]
    fn without_contacts_there_are_no_islands() {
        let mut islands = Islands::default();
        islands.find(3, |_| [0, 0], 0);
        assert_eq!(islands.iter().count(), 0);
    }
}
