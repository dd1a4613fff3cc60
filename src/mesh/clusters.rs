//! What hangs together, by links from one to the next (union-find).

/// Numbers from zero on, in clusters that can be joined.
pub(super) struct Clusters {
    /// No larger than the number itself.
    parent: Vec<u32>,
}

impl Clusters {
    /// So many, each alone.
    pub(super) fn new(count: usize) -> Self {
        Clusters { parent: (0..count as u32).collect() }
    }

    /// The least of a cluster, by which all of it are known.
    pub(super) fn root(&mut self, mut member: u32) -> u32 {
        while self.parent[member as usize] != member {
            self.parent[member as usize] = self.parent[self.parent[member as usize] as usize];
            member = self.parent[member as usize];
        }
        member
    }

    /// Joins the clusters of two members; false where they are one already.
    pub(super) fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }
}
