//! Colours of values, and the bar that explains them.

use super::svg::{Anchor, Svg};

/// Colours of a scale, dark to light; readable in grey and by the colour-blind (after matplotlib's viridis).
const ANCHORS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];

/// A linear scale from 0 to a maximum, in bands of one colour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Upper end; at least a tiny positive number.
    pub(super) max: f64,
    /// Number of bands.
    pub(super) bands: usize,
}

impl Scale {
    /// A scale that holds all values.
    pub(super) fn new<'a>(values: impl Iterator<Item = &'a f64>, bands: usize) -> Self {
        let max = values
            .copied()
            .filter(|v| v.is_finite())
            .fold(0.0, f64::max);
        let max = if max > 0.0 { max } else { 1.0 };
        Self { max, bands }
    }

    /// Lower end of a band; that of the band after the last is the maximum.
    pub(super) fn level(&self, band: usize) -> f64 {
        self.max * band as f64 / self.bands as f64
    }

    /// Colour of a band, darkened by `shade` in (0, 1].
    pub(super) fn colour(&self, band: usize, shade: f64) -> String {
        let t = band as f64 / (self.bands.max(2) - 1) as f64;
        let place = t.clamp(0.0, 1.0) * (ANCHORS.len() - 1) as f64;
        let k = (place as usize).min(ANCHORS.len() - 2);
        let part = place - k as f64;
        let mut text = String::from("#");
        for c in 0..3 {
            let v = ANCHORS[k][c] + part * (ANCHORS[k + 1][c] - ANCHORS[k][c]);
            text.push_str(&format!("{:02x}", (v * shade).round() as u8));
        }
        text
    }

    /// A vertical bar with round numbers: `factor` turns values into the unit named in `title`.
    pub(super) fn bar(
        &self,
        svg: &mut Svg,
        [x, y]: [f64; 2],
        height: f64,
        factor: f64,
        title: &str,
    ) {
        let width = 16.0;
        let step = height / self.bands as f64;
        for band in 0..self.bands {
            let top = y + height - step * (band + 1) as f64;
            let style = format!("fill=\"{}\"", self.colour(band, 1.0));
            // overlapping by a little hides the seams
            svg.rect(x, top, width, step + 0.3, &style);
        }
        svg.rect(
            x,
            y,
            width,
            height,
            "fill=\"none\" stroke=\"#222\" stroke-width=\"0.8\"",
        );
        svg.text(x, y - 10.0, 12.0, Anchor::Start, title);
        let max = self.max * factor;
        let tick = round_step(max / 5.0);
        let mut k = 0.0;
        while k * tick <= max * 1.0001 {
            let at = y + height * (1.0 - k * tick / max);
            svg.line(
                [x + width, at],
                [x + width + 4.0, at],
                "stroke=\"#222\" stroke-width=\"0.8\"",
            );
            svg.text(
                x + width + 7.0,
                at + 4.0,
                11.0,
                Anchor::Start,
                &number(k * tick, tick),
            );
            k += 1.0;
        }
    }
}

/// 1, 2 or 5 times a power of ten, at least `rough`.
pub(super) fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let lead = rough / power;
    power
        * [1.0, 2.0, 5.0]
            .into_iter()
            .find(|c| lead <= *c * 1.0001)
            .unwrap_or(10.0)
}

/// A tick with as many decimals as the step needs.
pub(super) fn number(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_colours_end_at_the_anchors() {
        assert_eq!(round_step(0.013), 0.02);
        assert_eq!(round_step(5.0), 5.0);
        assert!((round_step(70.0) - 100.0).abs() < 1e-9);
        assert_eq!(number(0.04, 0.02), "0.04");
        let scale = Scale::new([0.0, 2.0].iter(), 10);
        assert_eq!(scale.colour(0, 1.0), "#440154");
        assert_eq!(scale.colour(9, 1.0), "#fde725");
        assert_eq!(scale.level(10), 2.0);
        assert_eq!(Scale::new([].iter(), 10).max, 1.0);
    }
}
