//! XML with binary arrays. Each is compressed by all threads; the bytes do not depend on their number.

use std::io::Read;

use flate2::Compression;
use flate2::read::ZlibEncoder;
use rayon::prelude::*;

/// A file of unstructured grids: XML with binary arrays.
pub(super) struct File(pub(super) Vec<u8>);

impl File {
    pub(super) fn open(&mut self, tag: &str, attributes: &str) {
        let blank = if attributes.is_empty() { "" } else { " " };
        self.line(format_args!("<{tag}{blank}{attributes}>"));
    }

    pub(super) fn close(&mut self, tag: &str) {
        self.line(format_args!("</{tag}>"));
    }

    pub(super) fn line(&mut self, line: std::fmt::Arguments<'_>) {
        self.0.extend_from_slice(format!("{line}\n").as_bytes());
    }

    /// Blocks of zlib behind a header: numbers of blocks and of bytes in the first and the last, compressed sizes.
    pub(super) fn array<T: Copy + Sync, const B: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        values: &[T],
        bytes_of: fn(T) -> [u8; B],
    ) {
        let attributes =
            format!("type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\"");
        self.open("DataArray", &attributes);
        let block = |values: &[T]| compressed(values.iter().map(|&v| bytes_of(v)).collect::<Vec<_>>().as_flattened());
        let blocks: Vec<Vec<u8>> = values.par_chunks(BLOCK / B).map(block).collect();
        let last = values.chunks(BLOCK / B).last().map_or(0, |last| B * last.len());
        let sizes = blocks.iter().map(Vec::len);
        let header = [blocks.len(), BLOCK, last].into_iter().chain(sizes);
        let header: Vec<u8> = header.flat_map(|n| (n as u64).to_le_bytes()).collect();
        base64(&header, &mut self.0);
        base64(&blocks.concat(), &mut self.0);
        self.0.push(b'\n');
        self.close("DataArray");
    }
}

/// Bytes that are compressed together.
const BLOCK: usize = 32768;

fn compressed(block: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = ZlibEncoder::new(block, Compression::fast());
    // reading from memory into memory cannot fail
    let _ = encoder.read_to_end(&mut out);
    out
}

fn base64(bytes: &[u8], out: &mut Vec<u8>) {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let four = |[a, b, c]: [u8; 3]| {
        let bits = u32::from_be_bytes([0, a, b, c]);
        [18, 12, 6, 0].map(|shift| DIGITS[(bits >> shift) as usize & 63])
    };
    let (threes, rest) = bytes.as_chunks();
    out.extend(threes.iter().flat_map(|&three| four(three)));
    if !rest.is_empty() {
        let digits = four([0, 1, 2].map(|k| rest.get(k).copied().unwrap_or(0)));
        out.extend((0..4).map(|k| if k <= rest.len() { digits[k] } else { b'=' }));
    }
}

/// The characters that XML reserves inside an attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
