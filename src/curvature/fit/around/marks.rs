//! A small set of numbers that is emptied without touching its memory.

/// Numbers and the order in which they came.
pub(super) struct Marks {
    /// Age and number, and the place in the order of insertion.
    slots: Vec<(u64, u32)>,
    age: u64,
    count: usize,
}

const AGE: u64 = 1 << 32;

impl Marks {
    pub(super) fn new() -> Self {
        Marks { slots: vec![(0, 0); 256], age: AGE, count: 0 }
    }

    #[inline]
    pub(super) fn clear(&mut self) {
        self.count = 0;
        // After four thousand million windows old marks come to life.
        self.age = self.age.checked_add(AGE).unwrap_or_else(|| {
            self.slots.fill((0, 0));
            AGE
        });
    }

    /// False when the number was there already.
    #[inline]
    pub(super) fn insert(&mut self, key: u32) -> bool {
        if 2 * self.count >= self.slots.len() {
            self.grow();
        }
        let wanted = self.age | u64::from(key);
        let at = self.find(wanted);
        let is_new = self.slots[at].0 != wanted;
        if is_new {
            self.slots[at] = (wanted, self.count as u32);
            self.count += 1;
        }
        is_new
    }

    /// The place of a number in the order of insertion.
    pub(super) fn place(&self, key: u32) -> Option<usize> {
        let wanted = self.age | u64::from(key);
        let (held, place) = self.slots[self.find(wanted)];
        (held == wanted).then_some(place as usize)
    }

    /// The slot that holds a number or would take it.
    #[inline]
    fn find(&self, wanted: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = (u64::from(wanted as u32).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize & mask;
        while self.slots[at].0 != wanted && self.slots[at].0 >= self.age {
            at = (at + 1) & mask;
        }
        at
    }

    fn grow(&mut self) {
        let larger = vec![(0, 0); 2 * self.slots.len()];
        for (held, place) in std::mem::replace(&mut self.slots, larger) {
            if held >= self.age {
                let at = self.find(held);
                self.slots[at] = (held, place);
            }
        }
    }
}
