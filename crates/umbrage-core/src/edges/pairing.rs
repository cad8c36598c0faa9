//! Which sides of faces meet: each edge's uses one way are joined with those the other way.

/// A side of a face, as its face runs through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// Where it begins: a welded vertex.
    pub from: u32,
    /// Where it ends. Not `from`.
    pub to: u32,
    /// Which side; whoever asks for pairs gives the numbers.
    pub id: u32,
    /// The face.
    pub face: u32,
}

/// Two sides that meet, or one that meets none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// The use one way.
    pub left: Side,
    /// Runs the other way. `None`: the edge is open here.
    pub right: Option<Side>,
}

/// All pairs, and what was seen on the way.
#[derive(Debug, Default)]
pub struct Pairs {
    /// By edge: lower vertex, then higher.
    pub pairs: Vec<Pair>,
    /// Edges, whatever the number of their faces.
    pub distinct: usize,
    /// Edges with more than two sides.
    pub shared_by_more: usize,
    /// For each face, its part's number: faces that share an edge are of one part.
    pub part_of: Vec<u32>,
    /// For each part: has it an open edge?
    pub open: Vec<bool>,
}

/// Pairs the sides of `faces` faces: the first use one way with the first use the other way, and so on, in the order of
/// the sides' numbers.
///
/// Cost: one sort of the sides.
pub fn pair(mut sides: Vec<Side>, faces: usize) -> Pairs {
    let edge = |s: &Side| (s.from.min(s.to), s.from.max(s.to));
    sides.sort_unstable_by_key(|s| (edge(s), s.from > s.to, s.id));
    let mut found = Pairs { pairs: Vec::with_capacity(sides.len() / 2), ..Pairs::default() };
    let mut parts = Parts::new(faces);
    let mut open_faces = Vec::new();
    for uses in sides.chunk_by(|a, b| edge(a) == edge(b)) {
        found.distinct += 1;
        found.shared_by_more += usize::from(uses.len() > 2);
        uses.iter().skip(1).for_each(|other| parts.join(uses[0].face, other.face));
        let (up, down) = uses.split_at(uses.partition_point(|s| s.from < s.to));
        found.pairs.extend(up.iter().zip(down).map(|(&left, &right)| Pair { left, right: Some(right) }));
        let alone = if up.len() > down.len() { &up[down.len()..] } else { &down[up.len()..] };
        found.pairs.extend(alone.iter().map(|&left| Pair { left, right: None }));
        open_faces.extend(alone.iter().map(|s| s.face));
    }
    (found.part_of, found.open) = parts.number();
    for face in open_faces {
        found.open[found.part_of[face as usize] as usize] = true;
    }
    found
}

/// Sets of faces that grow together.
struct Parts(Vec<u32>);

impl Parts {
    fn new(faces: usize) -> Self {
        Self((0..=u32::MAX).take(faces).collect())
    }

    /// The face that stands for the part.
    fn root(&mut self, mut face: u32) -> u32 {
        while self.0[face as usize] != face {
            let above = self.0[face as usize];
            // Halves the way for whoever comes next.
            self.0[face as usize] = self.0[above as usize];
            face = above;
        }
        face
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        // The lower face stands for both, so that parts are numbered in the order of faces.
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// The part of each face, and room for a word on each part.
    fn number(mut self) -> (Vec<u32>, Vec<bool>) {
        let mut numbers = vec![0; self.0.len()];
        let mut parts = 0;
        for face in 0..self.0.len() as u32 {
            let root = self.root(face);
            if root == face {
                numbers[face as usize] = parts;
                parts += 1;
            } else {
                numbers[face as usize] = numbers[root as usize];
            }
        }
        (numbers, vec![false; parts as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides(faces: &[[u32; 3]]) -> Vec<Side> {
        let side = |(f, t): (usize, &[u32; 3])| {
            let t = *t;
            (0..3).map(move |i| Side {
                from: t[i],
                to: t[(i + 1) % 3],
                id: (3 * f + i) as u32,
                face: f as u32,
            })
        };
        faces.iter().enumerate().flat_map(side).collect()
    }

    #[test]
    fn three_faces_at_an_edge_leave_one_over() {
        let faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4], [7, 8, 9]];
        let found = pair(sides(&faces), faces.len());
        assert_eq!((found.distinct, found.shared_by_more), (10, 1));
        let at: Vec<_> = found.pairs.iter().filter(|p| (p.left.from, p.left.to) == (0, 1)).collect();
        assert_eq!((at[0].left.face, at[0].right.map(|s| s.face)), (0, Some(1)));
        assert_eq!((at[1].left.face, at[1].right), (2, None));
        assert_eq!((found.part_of, found.open), (vec![0, 0, 0, 1], vec![true, true]));
    }

    #[test]
    fn a_tetrahedron_is_a_part_without_open_edges_whatever_the_order() {
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mut mixed = sides(&faces);
        mixed.reverse();
        let found = pair(mixed, faces.len());
        assert_eq!(found.pairs, pair(sides(&faces), faces.len()).pairs);
        assert!(found.pairs.len() == 6 && found.pairs.iter().all(|p| p.right.is_some()));
        assert_eq!(found.open, [false]);
    }
}
