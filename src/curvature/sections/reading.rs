//! What the legs of a face show, four diameters side by side and then four faces.

use super::walk::Legs;
use crate::curvature::euler::{EulerFit, PlanarPrincipal, TERMS, terms};
use crate::curvature::perimeter::{End, gauss_of, rim};
use crate::curvature::vectors::four::{F4, Kernel, LANES, Real, run};
use crate::curvature::{Estimator, Part, Section, osculating};
use std::array::from_fn;
use std::f64::consts::PI;

/// What is the same for all faces.
#[derive(Debug)]
pub(super) struct Reader {
    diameters: usize,
    estimator: Estimator,
    /// The terms of the fit, by diameter.
    terms: Vec<[F4; TERMS]>,
    /// Cosine and sine of the turn from one leg to the next.
    turn: [f64; 2],
    /// The perimeter on the plane.
    flat: f64,
}

/// What the legs of one face show besides the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DiskReading {
    /// The perimeter of a whole disk, in radii.
    perimeter: f64,
    /// Legs that reached the radius.
    whole: usize,
}

impl Reader {
    pub(super) fn new(diameters: usize, estimator: Estimator) -> Self {
        let step = PI / diameters as f64;
        let legs = 2 * diameters;
        let of_diameter = |i: usize| if i < diameters { terms(i as f64 * step) } else { [0.0; TERMS] };
        let vector = |i: usize| from_fn(|term| F4(from_fn(|lane| of_diameter(LANES * i + lane)[term])));
        Reader {
            diameters,
            estimator,
            terms: (0..diameters.div_ceil(LANES)).map(vector).collect(),
            turn: [step.cos(), step.sin()],
            flat: legs as f64 * 2.0 * (0.5 * step).sin(),
        }
    }

    /// Reads the legs of a face and puts the fit, in radii, into a lane.
    pub(super) fn read(&self, legs: &Legs, fits: &mut EulerFit<F4>, lane: usize) -> DiskReading {
        run(Read { reader: self, legs, fits, lane })
    }

    /// The same without the processor's vectors.
    #[cfg(test)]
    pub(super) fn read_portable(&self, legs: &Legs, fits: &mut EulerFit<F4>, lane: usize) -> DiskReading {
        Read { reader: self, legs, fits, lane }.run()
    }

    /// Share of the legs that reached the radius, 0 to 1.
    pub(super) fn coverage(&self, reading: &DiskReading) -> f64 {
        reading.whole as f64 / (2 * self.diameters) as f64
    }

    /// Formula (3), times the square of the radius. `aside` tells how far beside its direction a leg ends; `ends` is
    /// memory for it.
    pub(super) fn gauss(
        &self,
        reading: &DiskReading,
        legs: &Legs,
        ends: &mut Vec<End>,
        aside: impl Fn(usize) -> f64,
    ) -> Option<f64> {
        let count = 2 * self.diameters;
        if reading.whole == count {
            return Some(6.0 * (1.0 - reading.perimeter / self.flat));
        }
        let is_whole = |i: usize| legs.length[i % count] == 1.0;
        ends.clear();
        ends.extend((0..count).map(|i| {
            let [length, excess, height] = [&legs.length, &legs.excess, &legs.height].map(|all| f64::from(all[i]));
            let is_beside_gap = is_whole(i + 1) != is_whole(i + count - 1);
            let aside = if is_whole(i) && is_beside_gap { aside(i) } else { 0.0 };
            End { place: [length - excess, height], is_whole: is_whole(i), aside, excess }
        }));
        gauss_of(count, |i| ends[i])
    }

    /// True when no section passes an edge.
    pub(super) fn is_blind(&self, legs: &Legs) -> bool {
        legs.length.iter().zip(&legs.first).take(2 * self.diameters).all(|(length, first)| length <= first)
    }
}

struct Read<'a> {
    reader: &'a Reader,
    legs: &'a Legs,
    fits: &'a mut EulerFit<F4>,
    lane: usize,
}

impl Kernel for Read<'_> {
    type Output = DiskReading;

    #[inline(always)]
    fn run(self) -> DiskReading {
        let Read { reader, legs, fits, lane } = self;
        let count = 2 * reader.diameters;
        let mut fit = EulerFit::<F4>::new();
        for (i, terms) in reader.terms.iter().enumerate() {
            let section =
                Section { forward: part(legs, LANES * i), backward: part(legs, reader.diameters + LANES * i) };
            let sample = match reader.estimator {
                Estimator::Osculating3 => osculating::third_order(&section),
                _ => osculating::exact_arc(&section),
            };
            fit.add(terms, sample);
        }
        let mut whole = 0;
        for length in &legs.length[..count] {
            whole += usize::from(*length == 1.0);
        }
        for i in 0..TERMS {
            for j in 0..=i {
                fits.gram[i][j].0[lane] = fit.gram[i][j].sum();
            }
            fits.right[i].0[lane] = fit.right[i].sum();
        }
        DiskReading { perimeter: if whole == count { perimeter(reader, legs) } else { 0.0 }, whole }
    }
}

#[inline(always)]
fn part(legs: &Legs, at: usize) -> Part<F4> {
    Part {
        length: load(&legs.length, at),
        excess: load(&legs.excess, at),
        height: load(&legs.height, at),
        first: load(&legs.first, at),
        moments: [load(&legs.moments[0], at), load(&legs.moments[1], at)],
    }
}

/// Length of the polygon of the ends of whole legs. That a leg's length is one is known in all digits, and
/// what it lacks of that towards its direction in seven of its own.
#[inline(always)]
fn perimeter(reader: &Reader, legs: &Legs) -> f64 {
    let count = 2 * reader.diameters;
    let turn = [F4::splat(reader.turn[0]), F4::splat(reader.turn[1])];
    let mut sum = F4::ZERO;
    for at in (0..count).step_by(LANES) {
        let mut length = rim(end(legs, at), end(legs, at + 1), turn);
        for lane in count.min(at + LANES) - at..LANES {
            length.0[lane] = 0.0;
        }
        sum += length;
    }
    sum.sum()
}

#[inline(always)]
fn end(legs: &Legs, at: usize) -> [F4; 2] {
    [F4::ONE - load(&legs.excess, at), load(&legs.height, at)]
}

#[inline(always)]
fn load(all: &[f32], at: usize) -> F4 {
    let four = &all[at..at + LANES];
    F4([f64::from(four[0]), f64::from(four[1]), f64::from(four[2]), f64::from(four[3])])
}

/// The principal curvatures of four faces.
pub(super) fn solve(fits: &EulerFit<F4>) -> [PlanarPrincipal; LANES] {
    struct Solve<'a>(&'a EulerFit<F4>);

    impl Kernel for Solve<'_> {
        type Output = PlanarPrincipal<F4>;

        #[inline(always)]
        fn run(self) -> PlanarPrincipal<F4> {
            self.0.solve()
        }
    }
    let all = run(Solve(fits));
    from_fn(|lane| PlanarPrincipal {
        k_max: all.k_max.0[lane],
        k_min: all.k_min.0[lane],
        direction: all.direction.map(|part| part.0[lane]),
    })
}
