//! Islands: bodies that hang together by contacts, and the contacts between them.
//!
//! ```text
//! bodies are joined by contacts;   an island is a connected component
//! ```
//! What does not move joins nothing, so that a floor does not make one island of all that stand on
//! it. Islands, their contacts and their bodies come in ascending order; the memory is kept from
//! call to call.

use crate::impact::inverse_mass::Groups;

/// Connected components, and the memory that finding them takes.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    groups: Groups,
    /// The island of each contact and of each body.
    of_contact: Vec<usize>,
    of_body: Vec<usize>,
    contacts: Sorted,
    bodies: Sorted,
}

/// Numbers sorted by what they belong to.
#[derive(Debug, Default)]
struct Sorted {
    starts: Vec<usize>,
    members: Vec<usize>,
}

const NONE: usize = usize::MAX;

impl Islands {
    /// Finds the islands of `bodies` bodies, given the two of each contact; the body numbered
    /// `bodies` stands for what does not move. A contact has at least one body that does.
    pub(crate) fn find(&mut self, bodies: usize, contacts: impl Iterator<Item = [usize; 2]>) {
        self.groups.reset(bodies);
        self.of_contact.clear();
        for [a, b] in contacts {
            if a < bodies && b < bodies {
                self.groups.join(a, b);
            }
            self.of_contact.push(a.min(b));
        }
        self.of_body.clear();
        self.of_body.resize(bodies, NONE);
        let mut islands = 0;
        for of in &mut self.of_contact {
            let root = self.groups.find(*of);
            if self.of_body[root] == NONE {
                self.of_body[root] = islands;
                islands += 1;
            }
            *of = self.of_body[root];
        }
        for body in 0..bodies {
            self.of_body[body] = self.of_body[self.groups.find(body)];
        }
        self.contacts.sort(islands, &self.of_contact);
        self.bodies.sort(islands, &self.of_body);
    }

    /// The contacts and the bodies of each island.
    #[inline]
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&[usize], &[usize])> {
        self.contacts.iter().zip(self.bodies.iter())
    }
}

impl Sorted {
    /// Sorts the numbers of these by what they belong to, in ascending order; what belongs to none of so many is
    /// left out.
    fn sort(&mut self, groups: usize, of: &[usize]) {
        self.starts.clear();
        self.starts.resize(groups + 1, 0);
        of.iter().filter(|&&of| of < groups).for_each(|&of| self.starts[of] += 1);
        let mut sum = 0;
        for start in &mut self.starts {
            (*start, sum) = (sum, sum + *start);
        }
        self.members.clear();
        self.members.resize(sum, 0);
        for (i, &of) in of.iter().enumerate().filter(|&(_, &of)| of < groups) {
            let place = &mut self.starts[of];
            self.members[*place] = i;
            *place += 1;
        }
        // Each start has moved on to the next one.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    #[inline]
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
            islands.find(6, contacts.into_iter());
            let found: Vec<_> = islands.iter().map(|(c, b)| (c.to_vec(), b.to_vec())).collect();
            assert_eq!(found, [(vec![0, 1, 3], vec![1, 4, 5]), (vec![2, 4], vec![3])]);
        }
    }

    #[test]
    fn without_contacts_there_are_no_islands() {
        let mut islands = Islands::default();
        islands.find(3, std::iter::empty());
        assert_eq!(islands.iter().count(), 0);
    }
}
