//! A few shapes as SVG text. Lengths are pixels, y grows downward.

use std::fmt::Write as _;

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    /// Begins there.
    Start,
    /// Is centred there.
    Middle,
}

/// An SVG file in the making.
#[derive(Debug)]
pub(super) struct Svg {
    body: String,
}

// Writing to a string cannot fail, so the results of `write!` are dropped.
impl Svg {
    /// A white page with a sans-serif font.
    pub(super) fn new(width: f64, height: f64) -> Self {
        let mut body = String::new();
        let _ = write!(
            body,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"Helvetica, Arial, DejaVu Sans, sans-serif\" \
             font-size=\"13\" fill=\"#222\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        );
        Self { body }
    }

    /// A line of text.
    pub(super) fn text(&mut self, x: f64, y: f64, size: f64, anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
        };
        let text = text
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;");
        let _ = writeln!(
            self.body,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    }

    /// A straight line.
    pub(super) fn line(&mut self, a: [f64; 2], b: [f64; 2], style: &str) {
        let _ = writeln!(
            self.body,
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" {style}/>",
            a[0], a[1], b[0], b[1]
        );
    }

    /// A rectangle.
    pub(super) fn rect(&mut self, x: f64, y: f64, width: f64, height: f64, style: &str) {
        let _ = writeln!(
            self.body,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" {style}/>"
        );
    }

    /// A circle.
    pub(super) fn circle(&mut self, centre: [f64; 2], radius: f64, style: &str) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius}\" {style}/>",
            centre[0], centre[1]
        );
    }

    /// Text that runs upward, centred at its point.
    pub(super) fn text_upward(&mut self, x: f64, y: f64, size: f64, text: &str) {
        let _ = writeln!(
            self.body,
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" font-size=\"{size}\" text-anchor=\"middle\">{text}</text>"
        );
    }

    /// Opens a group in which [`polygons`](Self::polygons) may be drawn; lengths inside are tenths of a pixel, which
    /// makes short files.
    pub(super) fn open_tenths(&mut self, style: &str) {
        let _ = writeln!(self.body, "<g transform=\"scale(.1)\" {style}>");
    }

    /// Closes the group.
    pub(super) fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Many polygons as one path, closed or not. The points are in pixels.
    pub(super) fn polygons<P: AsRef<[[f64; 2]]>>(
        &mut self,
        polygons: &[P],
        close: bool,
        style: &str,
    ) {
        if polygons.is_empty() {
            return;
        }
        self.body.push_str("<path d=\"");
        for polygon in polygons {
            let mut at = [0; 2];
            for (k, p) in polygon.as_ref().iter().enumerate() {
                let to = p.map(|v| (10.0 * v).round() as i64);
                // a relative step after the first; a minus sign separates as well as a blank does
                let letter = ["M", "l", ""][k.min(2)];
                let (x, y) = (to[0] - at[0], to[1] - at[1]);
                let blank = if k > 1 && x >= 0 { " " } else { "" };
                let between = if y >= 0 { " " } else { "" };
                let _ = write!(self.body, "{letter}{blank}{x}{between}{y}");
                at = to;
            }
            if close {
                self.body.push('z');
            }
        }
        let _ = writeln!(self.body, "\" {style}/>");
    }

    /// Classes for paths: fill and stroke in one colour, `k0`, `k1`, ...
    pub(super) fn classes(&mut self, colours: &[String]) {
        self.body.push_str("<style>");
        for (k, c) in colours.iter().enumerate() {
            let _ = write!(self.body, ".k{k}{{fill:{c};stroke:{c}}}");
        }
        self.body.push_str("</style>\n");
    }

    /// The text of the file.
    pub(super) fn finish(mut self) -> String {
        self.body.push_str("</svg>\n");
        self.body
    }
}
