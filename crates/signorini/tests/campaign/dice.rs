//! Reproducible numbers (SplitMix64): the same scene for the same seed and number on every machine.

/// A sequence of numbers.
pub(crate) struct Dice(u64);

impl Dice {
    /// The sequence of a scene: every scene stands alone, so that it can be made again by its number.
    pub(crate) fn new(seed: u64, number: u64) -> Self {
        let mut dice = Self(seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        dice.0 = dice.bits();
        dice
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Evenly spread over the decades between two positive numbers.
    pub(crate) fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    /// In [-1, 1).
    pub(crate) fn either(&mut self) -> f64 {
        self.between(-1.0, 1.0)
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A whole number from `low` to `high`, both included.
    pub(crate) fn whole(&mut self, low: usize, high: usize) -> usize {
        low + ((self.unit() * (high + 1 - low) as f64) as usize).min(high - low)
    }

    pub(crate) fn seed(&mut self) -> u64 {
        self.bits()
    }

    /// A vector in the cube of edge 2.
    pub(crate) fn vector(&mut self) -> [f64; 3] {
        [self.either(), self.either(), self.either()]
    }
}
