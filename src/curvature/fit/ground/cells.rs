//! Vertices taken together, for windows that hold hundreds of them.
//!
//! A polynomial in a window is known as well from the means of small groups of samples as from the samples: what varies
//! within a group tells of what is smaller than the window. A cell is a site and those of its neighbours that are
//! nearer to it than to the middles of other cells, some 4.4 of them on a triangulated surface. The mean lies off the
//! surface, but by much the same everywhere, and a fit has a constant term.

use super::fans::Fans;
use super::lists::Lists;
use super::seeds::{Draw, mixed};
use super::sites::Sites;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Sites in a group, nearly.
const GROUP: f64 = 4.4;

/// Cells of fans, or of such cells.
pub(in crate::curvature::fit) struct Cells<'g> {
    fans: &'g Fans<'g>,
    /// The cell of each fan.
    cell_of: Vec<u32>,
    cells: Vec<Cell>,
    neighbours: Lists,
    /// Fans in a cell, on average.
    pub(in crate::curvature::fit) size: f64,
    /// For each cell that of the fan in its middle: see [`Cells::of_fans`].
    numbers: Vec<u64>,
}

/// What windows ask of a cell, in one line of memory.
struct Cell {
    /// The mean of the fans' positions.
    position: DVec3,
    /// Number of its fans, against the mean of all cells.
    weight: f64,
    /// The sum of the fans' normals.
    normal: Vec3,
    direction: Vec3,
    count: Count,
}

/// Of how many fans a cell is made.
#[derive(Clone, Copy)]
struct Count {
    all: u32,
    /// Those of vertices that lie neither on a border nor on a sharp edge.
    inside: u32,
}

impl<'g> Cells<'g> {
    /// The largest cells of about `most` fans or fewer, on average; `None` where a fan and its neighbours are more.
    pub(in crate::curvature::fit) fn new(fans: &'g Fans<'g>, most: f64) -> Option<Self> {
        let mut cells = (most >= GROUP).then(|| Cells::of_fans(fans))?;
        let mut before = 1.0;
        while cells.size > before && cells.size * GROUP <= most {
            before = cells.size;
            cells = cells.coarser();
        }
        Some(cells)
    }

    fn of_fans(fans: &'g Fans<'g>) -> Self {
        let draw = Draw::of_width(fans.ground);
        let all = 0..fans.count() as u32;
        let hung = hung_together(fans);
        let number = |fan: u32| {
            let place = draw.lasting(fans.position(fan));
            hung[fan as usize] & !u64::from(u32::MAX) | u64::from(place)
        };
        let numbers: Vec<u64> = all.clone().into_par_iter().map(number).collect();
        let count = |fan: u32| {
            let is_inside = fans.ground.stars.is_inside(fans.vertex(fan));
            Count { all: 1, inside: u32::from(is_inside) }
        };
        Cells::grouped(fans, fans, all.collect(), &numbers, count)
    }

    fn coarser(&self) -> Self {
        Cells::grouped(self.fans, self, self.cell_of.clone(), &self.numbers, |cell| self.cells[cell as usize].count)
    }

    /// Groups of sites, of which `site_of` says which one each fan belongs to.
    fn grouped<S: Sites>(
        fans: &'g Fans<'g>,
        sites: &S,
        site_of: Vec<u32>,
        numbers: &[u64],
        count_of: impl Fn(u32) -> Count + Sync,
    ) -> Self {
        let (middles, group_of) = groups(sites, numbers);
        let count = middles.len();
        let size = fans.count() as f64 / count as f64;
        let members = Lists::of_pairs(count, || group_of.iter().zip(0..).map(|(&group, site)| (group, site)));
        let groups = || (0..count as u32).into_par_iter();
        let cell = |group: u32| {
            let members = || members.of(group).iter().copied();
            let first = sites.position(middles[group as usize]);
            let (mut all, mut inside, mut sum) = (0, 0, DVec3::ZERO);
            for (site, count) in members().map(|site| (site, count_of(site))) {
                all += count.all;
                inside += count.inside;
                sum += (sites.position(site) - first) * f64::from(count.all);
            }
            let normal: Vec3 = members().map(|site| sites.normal(site)).sum();
            Cell {
                position: first + sum / f64::from(all),
                weight: f64::from(all) / size,
                normal,
                direction: normal.normalize_or_zero(),
                count: Count { all, inside },
            }
        };
        let around = |group: u32| {
            let of_members = members.of(group).iter().flat_map(|&site| sites.neighbours(site));
            let others = of_members.map(|&site| group_of[site as usize]).filter(|&other| other != group);
            let mut around: Vec<u32> = others.collect();
            around.sort_unstable();
            around.dedup();
            around
        };
        let neighbours: Vec<Vec<u32>> = groups().map(around).collect();
        let pairs = || neighbours.iter().zip(0..).flat_map(|(around, group)| around.iter().map(move |&n| (group, n)));
        Cells {
            fans,
            cell_of: site_of.into_par_iter().map(|site| group_of[site as usize]).collect(),
            cells: groups().map(cell).collect(),
            neighbours: Lists::of_pairs(count, pairs),
            size,
            numbers: middles.par_iter().map(|&middle| numbers[middle as usize]).collect(),
        }
    }
}

impl Sites for Cells<'_> {
    /// Fewer are better told apart, as fans.
    const LEAST: usize = 48;

    fn fans(&self) -> &Fans<'_> {
        self.fans
    }

    fn count(&self) -> usize {
        self.cells.len()
    }

    #[inline]
    fn of_fan(&self, fan: u32) -> u32 {
        self.cell_of[fan as usize]
    }

    #[inline]
    fn position(&self, cell: u32) -> DVec3 {
        self.cells[cell as usize].position
    }

    #[inline]
    fn normal(&self, cell: u32) -> Vec3 {
        self.cells[cell as usize].normal
    }

    #[inline]
    fn direction(&self, cell: u32) -> Vec3 {
        self.cells[cell as usize].direction
    }

    #[inline]
    fn neighbours(&self, cell: u32) -> &[u32] {
        self.neighbours.of(cell)
    }

    #[inline]
    fn weight(&self, cell: u32) -> f64 {
        self.cells[cell as usize].weight
    }

    #[inline]
    fn shared_vertex(&self, _: u32) -> Option<u32> {
        None
    }

    fn coverage(&self, cells: &[u32]) -> f64 {
        let counts = cells.iter().map(|&cell| self.cells[cell as usize].count);
        let (all, inside) = counts.fold((0.0, 0.0), |(a, b), c| (a + f64::from(c.all), b + f64::from(c.inside)));
        inside / all
    }
}

/// A number for each site from how those around it hang together, that no noise changes: from how many neighbours it
/// has, they have, and theirs. (Weisfeiler and Leman, 1968: refinement of colours.)
fn hung_together(sites: &impl Sites) -> Vec<u64> {
    const ROUNDS: usize = 2;
    let all = || (0..sites.count() as u32).into_par_iter();
    let mut numbers: Vec<u64> = all().map(|site| mixed(sites.neighbours(site).len() as u64)).collect();
    for _ in 0..ROUNDS {
        let refined = |site: u32| {
            let around = sites.neighbours(site).iter().map(|&other| numbers[other as usize]);
            // In any order.
            mixed(numbers[site as usize].rotate_left(1) ^ around.fold(0, u64::wrapping_add))
        };
        numbers = all().map(refined).collect();
    }
    numbers
}

/// Middles of groups, of which none is a neighbour of another, and the group of each site. A site is a middle if its
/// number is greater than those of all its neighbours that could be one; after many rounds, its lot.
fn groups(sites: &impl Sites, numbers: &[u64]) -> (Vec<u32>, Vec<u32>) {
    /// Numbers in no order take about as many as the logarithm of the sites (Fischer and Noever 2018).
    const ORDERLY_ROUNDS: usize = 64;
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        Open,
        Middle,
        Beside,
    }
    // A site has to wait for all greater ones around. Where numbers rise steadily, as towards the middle of a cell of
    // the grid that many sites share, that takes as many rounds as there are sites on the way: after some, lots are
    // drawn.
    let mut rounds = 0..ORDERLY_ROUNDS;
    // Each its own.
    let lot = |site: u32| site.reverse_bits().wrapping_mul(0x9E37_79B1);
    let mut states = vec![State::Open; sites.count()];
    let mut open: Vec<u32> = (0..sites.count() as u32).collect();
    while !open.is_empty() {
        let is_orderly = rounds.next().is_some();
        let rank = |site: u32| (if is_orderly { numbers[site as usize] } else { 0 }, lot(site));
        let is_greatest = |site: &u32| {
            let wins = |other: u32| states[other as usize] != State::Open || rank(other) <= rank(*site);
            sites.neighbours(*site).iter().all(|&other| wins(other))
        };
        let middles: Vec<u32> = open.par_iter().copied().filter(is_greatest).collect();
        middles.into_iter().for_each(|site| states[site as usize] = State::Middle);
        let is_beside = |site: u32| {
            let is_middle = |&other: &u32| states[other as usize] == State::Middle;
            states[site as usize] == State::Open && sites.neighbours(site).iter().any(is_middle)
        };
        let beside: Vec<u32> = open.par_iter().copied().filter(|&site| is_beside(site)).collect();
        beside.into_iter().for_each(|site| states[site as usize] = State::Beside);
        open.retain(|&site| states[site as usize] == State::Open);
    }
    let is_middle = |site: u32| states[site as usize] == State::Middle;
    let middles: Vec<u32> = (0..sites.count() as u32).filter(|&site| is_middle(site)).collect();
    let mut group_of = vec![0; sites.count()];
    middles.iter().zip(0..).for_each(|(&middle, group)| group_of[middle as usize] = group);
    let nearest = |site: u32| {
        let away = |other: u32| sites.position(other).distance_squared(sites.position(site));
        let around = sites.neighbours(site).iter().copied().filter(|&other| is_middle(other));
        let nearer = |a: &u32, b: &u32| {
            away(*a)
                .total_cmp(&away(*b))
                .then_with(|| (numbers[*b as usize], lot(*b)).cmp(&(numbers[*a as usize], lot(*a))))
        };
        let own = if is_middle(site) { site } else { around.min_by(nearer).unwrap_or(site) };
        group_of[own as usize]
    };
    let group_of = (0..sites.count() as u32).into_par_iter().map(nearest).collect();
    (middles, group_of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::ground::Ground;
    use crate::curvature::fit::ground::work::Work;
    use crate::progress::NoProgress;
    use crate::synth::{Grid, Surface};
    use crate::{Mesh, MeshOptions, Positions, Soup};

    fn torus() -> Soup {
        let torus = Surface::Torus { major: 3.0, minor: 1.0 };
        Grid { jitter: 0.3, ..Grid::with_faces(torus, 20_000, 1.0) }.build().soup
    }

    fn with_fans<T>(soup: &Soup, look: impl FnOnce(&Fans<'_>) -> T) -> T {
        let mesh = Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh");
        let work = Work::new(&NoProgress, 0);
        look(&Fans::new(&Ground::new(&mesh, false, &work)))
    }

    #[test]
    fn each_fan_is_in_a_cell_beside_its_middle() {
        with_fans(&torus(), |fans| {
            assert!(Cells::new(fans, 3.0).is_none());
            let cells = Cells::new(fans, 5.0).expect("cells");
            assert!((3.9..4.9).contains(&cells.size), "{}", cells.size);
            let edge = (4.0 * std::f64::consts::PI.powi(2) * 3.0 / fans.count() as f64).sqrt();
            let mut counts = vec![0; cells.count()];
            for fan in 0..fans.count() as u32 {
                let cell = cells.of_fan(fan);
                counts[cell as usize] += 1;
                assert!(cells.position(cell).distance(fans.position(fan)) < 3.0 * edge);
                assert!(cells.direction(cell).dot(fans.direction(fan)) > 0.9);
                // Whoever hangs together with the fan is in the cell or in one beside it.
                let around = fans.neighbours(fan).iter().map(|&other| cells.of_fan(other));
                assert!(around.into_iter().all(|other| other == cell || cells.neighbours(cell).contains(&other)));
            }
            let weight = |cell: usize| (cells.weight(cell as u32) * cells.size).round();
            assert!((0..cells.count()).all(|cell| weight(cell) == f64::from(counts[cell])));
            assert_eq!(cells.coverage(&[0, 1, 2]), 1.0);
        });
    }

    #[test]
    fn cells_of_cells_hold_the_same_surface() {
        with_fans(&torus(), |fans| {
            let cells = Cells::new(fans, 100.0).expect("cells");
            assert!((50.0..100.0).contains(&cells.size), "{}", cells.size);
            let total: f64 = (0..cells.count() as u32).map(|cell| cells.weight(cell) * cells.size).sum();
            assert_eq!(total.round() as usize, fans.count());
            let all = |of: &dyn Fn(u32) -> DVec3, count: usize| (0..count as u32).map(of).sum::<DVec3>();
            let weighted = all(&|cell| cells.position(cell) * cells.weight(cell) * cells.size, cells.count());
            assert!(weighted.distance(all(&|fan| fans.position(fan), fans.count())) < 1e-9 * fans.count() as f64);
        });
    }

    /// Where vertices have different numbers of neighbours, as in all scans, noise leaves nearly all cells as they are.
    #[test]
    fn noise_hardly_changes_cells() {
        let mut soup = torus();
        // One edge in three or four is flipped, nowhere two of one face.
        let mut is_taken = vec![false; soup.triangles.len()];
        for f in (0..soup.triangles.len() - 1).filter(|&f| mixed(f as u64).is_multiple_of(2)) {
            let (a, b) = (soup.triangles[f], soup.triangles[f + 1]);
            let shared: Vec<u32> = a.into_iter().filter(|v| b.contains(v)).collect();
            let [p, q] = shared[..] else { continue };
            if is_taken[f] {
                continue;
            }
            is_taken[f + 1] = true;
            let own = a.into_iter().find(|v| !shared.contains(v)).expect("a third corner");
            let other = b.into_iter().find(|v| !shared.contains(v)).expect("a third corner");
            let (p, q) =
                if a.iter().position(|&v| v == p).map(|i| a[(i + 1) % 3]) == Some(q) { (p, q) } else { (q, p) };
            soup.triangles[f] = [own, p, other];
            soup.triangles[f + 1] = [other, q, own];
        }
        let points: Vec<[f64; 3]> = (0..soup.positions.len()).map(|v| soup.positions.get(v).to_array()).collect();
        let cells_of = |noise: f64| {
            let moved = points.iter().enumerate().map(|(v, &p)| {
                let of = |i: usize| (mixed((3 * v + i) as u64) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                [0, 1, 2].map(|i| p[i] + noise * of(i))
            });
            let soup = Soup::new(Positions::F64(moved.collect()), soup.triangles.clone());
            with_fans(&soup, |fans| {
                let cells = Cells::new(fans, 5.0).expect("cells");
                (0..fans.count() as u32).map(|fan| cells.of_fan(fan)).collect::<Vec<u32>>()
            })
        };
        // Pairs of neighbouring vertices in one cell.
        let together = |cells: &[u32]| -> std::collections::BTreeSet<[u32; 2]> {
            let pairs = soup.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let pairs = pairs.map(|[a, b]| [a.min(b), a.max(b)]);
            pairs.filter(|&[a, b]| cells[a as usize] == cells[b as usize]).collect()
        };
        let (clean, noisy) = (together(&cells_of(0.0)), together(&cells_of(0.003)));
        let alike = clean.intersection(&noisy).count() as f64 / clean.union(&noisy).count() as f64;
        assert!(alike > 0.9, "{alike}");
    }
}
