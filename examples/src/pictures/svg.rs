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

    /// Many closed polygons in one style.
    pub(super) fn polygons(&mut self, polygons: &[Vec<[f64; 2]>], style: &str) {
        if polygons.is_empty() {
            return;
        }
        self.body.push_str("<path d=\"");
        for polygon in polygons {
            for (k, p) in polygon.iter().enumerate() {
                let letter = if k == 0 { "M" } else { "L" };
                let _ = write!(self.body, "{letter}{} {}", short(p[0]), short(p[1]));
            }
            self.body.push('z');
        }
        let _ = writeln!(self.body, "\" {style}/>");
    }

    /// The text of the file.
    pub(super) fn finish(mut self) -> String {
        self.body.push_str("</svg>\n");
        self.body
    }
}

/// A coordinate with one decimal, without a trailing zero.
fn short(v: f64) -> String {
    let text = format!("{v:.1}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}
