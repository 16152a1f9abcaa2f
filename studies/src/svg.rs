//! A few shapes as SVG text. Lengths are pixels, y grows downward.

use std::fmt::Write as _;

/// An SVG file in the making.
#[derive(Debug)]
pub(crate) struct Svg {
    body: String,
}

// Writing to a string cannot fail, so the results of `write!` are dropped.
impl Svg {
    /// A white page with a sans-serif font.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        let mut body = String::new();
        let _ = write!(
            body,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"Helvetica, Arial, DejaVu Sans, sans-serif\" \
             fill=\"#222\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        );
        Self { body }
    }

    /// A line of text that begins at a point.
    pub(crate) fn text(&mut self, [x, y]: [f64; 2], size: f64, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let _ = writeln!(
            self.body,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\">{text}</text>"
        );
    }

    /// A circle.
    pub(crate) fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" {style}/>"
        );
    }

    /// Many polygons (or lines, if not closed) as one path. Coordinates are written in tenths of a pixel, relative
    /// to the point before, which makes short files.
    pub(crate) fn polygons<P: AsRef<[[f64; 2]]>>(&mut self, polygons: &[P], close: bool, style: &str) {
        if polygons.is_empty() {
            return;
        }
        self.body.push_str("<path transform=\"scale(.1)\" d=\"");
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

    /// The text of the file.
    pub(crate) fn finish(self) -> String {
        self.body + "</svg>\n"
    }
}
