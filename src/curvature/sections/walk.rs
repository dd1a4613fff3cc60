//! The walk of all legs of a face, eight side by side and three times eight in turns.
//!
//! Lengths are in radii of the disk. Each leg keeps the edge it crosses by its ends: their distances to the
//! leg's plane, one negative and one not, their way along the leg's direction and their height above the
//! face. Three products with the corner across the edge give those of the next end, its sign says which end
//! it takes the place of, and the divisor of the crossing is never zero. A leg that has ended stays at an
//! edge that leads to itself, so nothing branches until all have ended.
//!
//! The rules are those of [`Leg::walk`](crate::disk::Leg::walk), in 32 bits. Heights are sums of short ways
//! along the faces, and so is what a leg lacks from its end's distance: both keep their digits however little
//! the surface bends.

use super::steps::{Slot, Steps};
use crate::curvature::vectors::eight::{Edges, Eight, F, Kernel, LANES, M};
use std::ops::Add;

/// Segments up to this many radii are passed over: rounding has a share in where they point.
const SHORT: f32 = 4e-6;
/// An edge may be this many radii wide across a leg; rounding of its ends is then a millionth of a radius.
const WIDEST: f32 = 16.0;
/// Crossings of one leg after which the mesh itself is to be walked.
const MOST_CROSSINGS: usize = 1 << 16;
/// Vectors that take turns, so that the processor has something to do while memory answers.
const TURNS: usize = 3;

/// Cosines and sines of the directions of all legs, by angle over the full turn; filled up with the first.
#[derive(Debug)]
pub(super) struct Directions(Vec<[[f32; LANES]; 2]>);

impl Directions {
    pub(super) fn new(diameters: usize) -> Self {
        let count = 2 * diameters;
        let of = |leg: usize| {
            let leg = if leg < count { leg } else { 0 };
            // Opposite legs are opposite in every bit.
            let (sin, cos) = (std::f64::consts::PI * (leg % diameters) as f64 / diameters as f64).sin_cos();
            let sign = if leg < diameters { 1.0 } else { -1.0 };
            [(sign * cos) as f32, (sign * sin) as f32]
        };
        let vectors = (0..count.div_ceil(TURNS * LANES) * TURNS).map(|vector| {
            let of = |part: usize| std::array::from_fn(|lane| of(vector * LANES + lane)[part]);
            [of(0), of(1)]
        });
        Directions(vectors.collect())
    }
}

/// A face as the walk sees it: in radii, from the centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// Corners along the frame's two tangents, wound as the component's majority.
    pub(super) corners: [[f32; 2]; 3],
    /// The frame's tangents and normal, divided by the radius in the units of [`Steps`].
    pub(super) axes: [[f32; 3]; 3],
    /// The face's first edge.
    pub(super) edge: u32,
}

/// What the formulas need of the legs of a face, each value by leg.
#[derive(Clone, Debug, Default)]
pub(super) struct Legs {
    /// Length along the mesh; exactly 1 where nothing stopped the leg.
    pub(super) length: Vec<f32>,
    /// Length less the end's distance along the leg's direction.
    pub(super) excess: Vec<f32>,
    /// The end's height above the face.
    pub(super) height: Vec<f32>,
    /// Length of the first segment, also where the leg ends before it.
    pub(super) first: Vec<f32>,
    /// Sums of p m and p m^2 over the segments after the first, see [`Leg::moments`](crate::disk::Leg::moments).
    pub(super) moments: [Vec<f32>; 2],
}

impl Legs {
    /// Room for the legs of some directions.
    pub(super) fn new(directions: &Directions) -> Self {
        // Behind the last leg the first is repeated.
        let zeros = || vec![0.0; (directions.0.len() + 1) * LANES];
        Legs { length: zeros(), excess: zeros(), height: zeros(), first: zeros(), moments: [zeros(), zeros()] }
    }

    /// Repeats the first leg's end behind the last leg.
    pub(super) fn close(&mut self, count: usize) {
        self.excess[count] = self.excess[0];
        self.height[count] = self.height[0];
    }
}

/// Walks all legs of a face. The output says whether 32 bits and the rules here were enough; where not, the
/// mesh itself is to be walked.
pub(super) struct Walk<'a> {
    pub(super) steps: &'a Steps,
    pub(super) start: &'a Start,
    pub(super) directions: &'a Directions,
    pub(super) legs: &'a mut Legs,
}

impl Kernel for Walk<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<E: Eight>(self, e: E) -> bool {
        let Walk { steps, start, directions, legs } = self;
        let (slots, stop) = (steps.slots(), steps.stop());
        let normal = splat(e, start.axes[2]);
        for (chunk, [a, b, c]) in directions.0.as_chunks::<TURNS>().0.iter().enumerate() {
            // Values, not places in memory: a choice between two that goes where one of them was is compiled to a
            // store of some lanes, which takes longer than all the rest.
            let [mut a, mut b, mut c] =
                [Lanes::start(e, stop, start, a), Lanes::start(e, stop, start, b), Lanes::start(e, stop, start, c)];
            a = a.with::<true>(e, a.segment());
            b = b.with::<true>(e, b.segment());
            c = c.with::<true>(e, c.segment());
            let mut crossings = 0;
            while !(a.goes_on(stop) | b.goes_on(stop) | c.goes_on(stop)).is_false_for_all() {
                // Fetching and crossing of all three before what waits for their roots: several are then under way at
                // once.
                a = a.advanced(e, stop, slots, normal);
                let segment_a = a.segment();
                b = b.advanced(e, stop, slots, normal);
                let segment_b = b.segment();
                c = c.advanced(e, stop, slots, normal);
                let segment_c = c.segment();
                a = a.with::<false>(e, segment_a);
                b = b.with::<false>(e, segment_b);
                c = c.with::<false>(e, segment_c);
                crossings += 1;
                if crossings == MOST_CROSSINGS {
                    return false;
                }
            }
            let first = chunk * TURNS * LANES;
            a.store(first, legs);
            b.store(first + LANES, legs);
            c.store(first + 2 * LANES, legs);
            if !(a.is_sound(e, steps) & b.is_sound(e, steps) & c.is_sound(e, steps)).is_true_for_all() {
                return false;
            }
        }
        true
    }
}

/// A vector or point in eight frames.
#[derive(Clone, Copy)]
struct Three<E>([F<E>; 3]);

/// From the leg's end to the edge it crosses next.
#[derive(Clone, Copy)]
struct Segment<E> {
    forward: F<E>,
    rise: F<E>,
    rise_squared: F<E>,
    /// Its length.
    whole: F<E>,
    /// Of the edge, across the leg.
    width: F<E>,
}

/// Eight legs.
#[derive(Clone, Copy)]
struct Lanes<E> {
    /// The plane's normal and the leg's direction.
    across: Three<E>,
    along: Three<E>,
    /// The crossed edge and its ends: distance to the plane, way along the leg, height.
    edge: Edges<E>,
    below: Three<E>,
    above: Three<E>,
    /// The leg so far: way along its direction, height.
    end: [F<E>; 2],
    length: F<E>,
    excess: F<E>,
    first: F<E>,
    moments: [F<E>; 2],
    widest: F<E>,
    /// Arrived or turned. The edge follows one crossing later, so that fetching what lies across the next edge does
    /// not wait for roots and quotients.
    has_ended: M<E>,
}

impl<E: Eight> Lanes<E> {
    #[inline(always)]
    fn start(e: E, stop: u32, start: &Start, [cos, sin]: &[[f32; LANES]; 2]) -> Self {
        let zero = F::splat(e, 0.0);
        let (cos, sin) = (F::new(e, *cos), F::new(e, *sin));
        let (x, y) = (splat(e, start.axes[0]), splat(e, start.axes[1]));
        let [a, b, c] = start.corners;
        let ends = [corner(e, a, cos, sin), corner(e, b, cos, sin), corner(e, c, cos, sin)];
        let is_below = [ends[0].0[0].is_negative(), ends[1].0[0].is_negative(), ends[2].0[0].is_negative()];
        // The one edge that rises through the plane is the one to leave by.
        let (mut edge, mut below, mut above) = (Edges::splat(e, stop), ends[0], ends[1]);
        let mut widest = F::splat(e, f32::INFINITY);
        for i in 0..3 {
            let next = (i + 1) % 3;
            let rises = is_below[i] & !is_below[next];
            edge = rises.select_edges(Edges::splat(e, start.edge + i as u32), edge);
            below = Three::select(rises, ends[i], below);
            above = Three::select(rises, ends[next], above);
            widest = rises.select(zero, widest);
        }
        Lanes {
            across: y.scaled(cos) + x.scaled(-sin),
            along: x.scaled(cos) + y.scaled(sin),
            edge,
            below,
            above,
            end: [zero; 2],
            length: zero,
            excess: zero,
            first: zero,
            moments: [zero; 2],
            widest,
            has_ended: zero.less(zero),
        }
    }

    /// The segment from the leg's end to the crossed edge.
    #[inline(always)]
    fn segment(&self) -> Segment<E> {
        let (Three(below), Three(above)) = (self.below, self.above);
        let width = above[0] - below[0];
        let share = -below[0] / width;
        let forward = below[1] + share * (above[1] - below[1]) - self.end[0];
        let rise = below[2] + share * (above[2] - below[2]) - self.end[1];
        let rise_squared = rise * rise;
        Segment { forward, rise, rise_squared, whole: (forward * forward + rise_squared).sqrt(), width }
    }

    /// With the segment, or what is left of the radius.
    #[inline(always)]
    fn with<const FIRST: bool>(self, e: E, segment: Segment<E>) -> Self {
        /// No length: keeps divisors above zero.
        const NONE: f32 = 1e-12;
        let Segment { forward, rise, rise_squared, whole, width } = segment;
        let (zero, one) = (F::splat(e, 0.0), F::splat(e, 1.0));
        let room = one - self.length;
        let has_room = whole.less(room);
        let is_long = F::splat(e, SHORT).less(whole);
        let has_turned = is_long & !zero.less(forward);
        let is_passed_over = self.has_ended | has_turned | (has_room & !is_long);
        let used = is_passed_over.select(zero, has_room.select(whole, room));
        // The share of the segment that is used, and of that the excess: both by one division.
        let length = whole.max(F::splat(e, NONE));
        let divisor = length + forward.abs();
        let quotient = used / (length * divisor);
        let part = quotient * divisor;
        let middle = self.length + F::splat(e, 0.5) * whole;
        let moment = used * middle;
        let has_arrived = !(has_room | has_turned | self.has_ended);
        Lanes {
            end: [self.end[0] + part * forward, self.end[1] + part * rise],
            length: has_arrived.select(one, self.length + used),
            excess: self.excess + quotient * rise_squared,
            first: if FIRST { whole } else { self.first },
            moments: if FIRST { [zero; 2] } else { [self.moments[0] + moment, self.moments[1] + moment * middle] },
            widest: self.has_ended.select(self.widest, self.widest.max(width)),
            has_ended: self.has_ended | has_arrived | has_turned,
            ..self
        }
    }

    /// Through the face across the edge.
    #[inline(always)]
    fn advanced(self, e: E, stop: u32, slots: &[Slot], normal: Three<E>) -> Self {
        let (way, first) = self.edge.across(slots);
        let apex = self.below + Three([self.across.dot(way), self.along.dot(way), normal.dot(way)]);
        let is_below = apex.0[0].is_negative();
        Lanes {
            below: Three::select(is_below, apex, self.below),
            above: Three::select(is_below, self.above, apex),
            edge: self.has_ended.select_edges(Edges::splat(e, stop), first.one_further(is_below)),
            ..self
        }
    }

    #[inline(always)]
    fn goes_on(self, stop: u32) -> M<E> {
        self.edge.are_below(stop) & !self.has_ended
    }

    /// False where a leg is lost or crossed too wide an edge.
    #[inline(always)]
    fn is_sound(self, e: E, steps: &Steps) -> M<E> {
        (self.has_ended | self.edge.are_below(steps.lost())) & self.widest.less(F::splat(e, WIDEST))
    }

    #[inline(always)]
    fn store(&self, at: usize, legs: &mut Legs) {
        self.length.store(&mut legs.length[at..]);
        self.excess.store(&mut legs.excess[at..]);
        self.end[1].store(&mut legs.height[at..]);
        self.first.store(&mut legs.first[at..]);
        self.moments[0].store(&mut legs.moments[0][at..]);
        self.moments[1].store(&mut legs.moments[1][at..]);
    }
}

/// A corner of the face that the legs start from.
#[inline(always)]
fn corner<E: Eight>(e: E, [x, y]: [f32; 2], cos: F<E>, sin: F<E>) -> Three<E> {
    let (x, y) = (F::splat(e, x), F::splat(e, y));
    Three([cos * y - sin * x, cos * x + sin * y, F::splat(e, 0.0)])
}

#[inline(always)]
fn splat<E: Eight>(e: E, [x, y, z]: [f32; 3]) -> Three<E> {
    Three([F::splat(e, x), F::splat(e, y), F::splat(e, z)])
}

impl<E: Eight> Three<E> {
    #[inline(always)]
    fn dot(self, o: [F<E>; 3]) -> F<E> {
        self.0[0] * o[0] + self.0[1] * o[1] + self.0[2] * o[2]
    }

    #[inline(always)]
    fn scaled(self, by: F<E>) -> Self {
        Three([self.0[0] * by, self.0[1] * by, self.0[2] * by])
    }

    #[inline(always)]
    fn select(which: M<E>, Three(a): Self, Three(b): Self) -> Self {
        Three([which.select(a[0], b[0]), which.select(a[1], b[1]), which.select(a[2], b[2])])
    }
}

impl<E: Eight> Add for Three<E> {
    type Output = Self;

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Three([self.0[0] + o.0[0], self.0[1] + o.0[1], self.0[2] + o.0[2]])
    }
}
