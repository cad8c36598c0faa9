//! Small variations that repeat for a seed, on every machine.

/// SplitMix64; whole numbers only, so no machine rounds differently.
pub(super) struct Random {
    state: u64,
    plain: bool,
}

impl Random {
    pub fn new(seed: u64) -> Self {
        Self { state: seed, plain: seed == 0 }
    }

    /// In `-1.0 ..= 1.0`; always 0 for seed 0, which is the plain layout.
    pub fn around_zero(&mut self) -> f32 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.state;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^= x >> 31;
        if self.plain { 0.0 } else { (x >> 40) as f32 / 8_388_608.0 - 1.0 }
    }
}
