//! Which pixels have an edge point, and its number: a bit a pixel, with the count of points before each word of 64.

/// Bits of the pixels, and ranks.
#[derive(Debug, Clone, Default)]
pub(crate) struct PointMap {
    words: Vec<u64>,
    /// Points before each word.
    ranks: Vec<u32>,
    words_per_row: usize,
    width: usize,
    height: usize,
}

impl PointMap {
    /// An empty map of this size.
    pub(crate) fn reset(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.words_per_row = width.div_ceil(64);
        self.words.clear();
        self.words.resize(self.words_per_row * height, 0);
        self.ranks.clear();
    }

    /// Counts the points once all rows are marked.
    pub(crate) fn seal(&mut self) {
        let mut before = 0;
        self.ranks.extend(self.words.iter().map(|word| {
            let rank = before;
            before += word.count_ones();
            rank
        }));
    }

    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn height(&self) -> usize {
        self.height
    }

    pub(crate) fn row(&self, y: usize) -> &[u64] {
        &self.words[y * self.words_per_row..(y + 1) * self.words_per_row]
    }

    pub(crate) fn row_mut(&mut self, y: usize) -> &mut [u64] {
        &mut self.words[y * self.words_per_row..(y + 1) * self.words_per_row]
    }

    /// The number of the point at a pixel, if it has one; none outside the picture.
    #[inline(always)]
    pub(crate) fn number_at(&self, x: i32, y: i32) -> Option<u32> {
        if x < 0 || y < 0 || x >= self.width as i32 || y >= self.height as i32 {
            return None;
        }
        let at = y as usize * self.words_per_row + x as usize / 64;
        let (word, bit) = (self.words[at], 1_u64 << (x % 64));
        (word & bit != 0).then(|| self.ranks[at] + (word & (bit - 1)).count_ones())
    }

    /// Calls `visit` with the number of every point whose pixel lies in columns `x - reach..=x + reach` of row `y`.
    /// Columns and rows outside the picture have none. `reach` is at most 31.
    #[inline(always)]
    pub(crate) fn visit_run(&self, x: i32, y: i32, reach: i32, mut visit: impl FnMut(u32)) {
        if y < 0 || y >= self.height as i32 {
            return;
        }
        let (first, last) = ((x - reach).max(0), (x + reach).min(self.width as i32 - 1));
        if first > last {
            return;
        }
        let base = y as usize * self.words_per_row;
        let (first, last) = (first as usize, last as usize);
        let (word, last_word) = (first / 64, last / 64);
        let from = first % 64;
        let wanted = (2_u64 << (last - first)) - 1;
        self.visit_bits(base + word, wanted << from, &mut visit);
        if last_word != word {
            self.visit_bits(base + last_word, wanted >> (64 - from), &mut visit);
        }
    }

    #[inline(always)]
    fn visit_bits(&self, at: usize, wanted: u64, visit: &mut impl FnMut(u32)) {
        let word = self.words[at];
        let mut bits = word & wanted;
        if bits == 0 {
            return;
        }
        let mut number = self.ranks[at] + (word & ((bits & bits.wrapping_neg()) - 1)).count_ones();
        while bits != 0 {
            visit(number);
            let here = bits.trailing_zeros();
            bits &= bits - 1;
            if bits != 0 {
                let between = word >> here >> 1;
                let gap = bits.trailing_zeros() - here - 1;
                number += 1 + (between & ((1_u64 << gap) - 1)).count_ones();
            }
        }
    }
}
