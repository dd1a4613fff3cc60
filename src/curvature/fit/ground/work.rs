//! Tells how much of the work on all faces is done, whatever it is that is worked on.

use crate::progress::Progress;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Counts faces; stages that go over seeds or vertices stand for a share of them.
pub(in crate::curvature::fit) struct Work<'p> {
    progress: &'p dyn Progress,
    faces: u64,
    /// Faces that have not been told.
    left: AtomicU64,
}

impl<'p> Work<'p> {
    pub(in crate::curvature::fit) fn new(progress: &'p dyn Progress, faces: usize) -> Self {
        Work { progress, faces: faces as u64, left: AtomicU64::new(faces as u64) }
    }

    /// So many faces are done. With none, what is not counted goes on, so that it can be cancelled.
    pub(in crate::curvature::fit) fn advance(&self, faces: u64) {
        let told = self.left.fetch_update(Relaxed, Relaxed, |left| Some(left - faces.min(left)));
        self.progress.advance(faces.min(told.unwrap_or(0)));
    }

    /// Of a stage that takes about `share` of all work, `part` of `whole` is done.
    pub(in crate::curvature::fit) fn advance_by(&self, share: f64, part: usize, whole: usize) {
        self.advance((self.faces as f64 * share * part as f64 / whole.max(1) as f64) as u64);
    }

    /// Tells what is left.
    pub(in crate::curvature::fit) fn finish(&self) {
        self.advance(self.faces);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Stage;
    use std::sync::Mutex;

    struct Sum(Mutex<Vec<u64>>);

    impl Progress for Sum {
        fn begin(&self, _: Stage, _: u64) {}
        fn advance(&self, amount: u64) {
            self.0.lock().expect("no panic").push(amount);
        }
        fn end(&self) {}
    }

    #[test]
    fn shares_add_up_to_all_faces_and_never_more() {
        let sum = Sum(Mutex::default());
        let work = Work::new(&sum, 1000);
        (0..7).for_each(|_| work.advance_by(0.5, 1, 7));
        work.advance(300);
        work.advance(0);
        work.finish();
        work.advance_by(1.0, 1, 1);
        let told = sum.0.lock().expect("no panic");
        assert_eq!(told.iter().sum::<u64>(), 1000);
        assert_eq!(told[..7], [71; 7]);
        assert_eq!(told[7..], [300, 0, 203, 0]);
    }
}
