//! A reader of Gmsh 4.1 files. Every count is checked against the bytes that are there before it is believed.

use super::GmshError;
use crate::mesh::CellShape;
use std::ops::Range;

/// What elements of a type are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Triangles and quadrilaterals.
    Face {
        corners: usize,
    },
    Cell(CellShape),
}

/// The element types: number, count of nodes, what they are if they are not skipped, and where the nodes of a
/// [`Cell`](crate::mesh::Cell) behind its corners stand if Gmsh has another order.
const TYPES: [(i32, usize, Option<Kind>, &[usize]); 19] = [
    (1, 2, None, &[]),
    (2, 3, Some(Kind::Face { corners: 3 }), &[]),
    (3, 4, Some(Kind::Face { corners: 4 }), &[]),
    (4, 4, Some(Kind::Cell(CellShape::Tetrahedron)), &[]),
    (5, 8, Some(Kind::Cell(CellShape::Hexahedron)), &[]),
    (6, 6, Some(Kind::Cell(CellShape::Prism)), &[]),
    (7, 5, Some(Kind::Cell(CellShape::Pyramid)), &[]),
    (8, 3, None, &[]),
    (9, 6, Some(Kind::Face { corners: 3 }), &[]),
    (10, 9, Some(Kind::Face { corners: 4 }), &[]),
    (11, 10, Some(Kind::Cell(CellShape::Tetrahedron)), &[4, 5, 6, 7, 9, 8]),
    (12, 27, Some(Kind::Cell(CellShape::Hexahedron)), &HEXAHEDRON),
    (13, 18, Some(Kind::Cell(CellShape::Prism)), &PRISM),
    (14, 14, Some(Kind::Cell(CellShape::Pyramid)), &PYRAMID),
    (15, 1, None, &[]),
    (16, 8, Some(Kind::Face { corners: 4 }), &[]),
    (17, 20, Some(Kind::Cell(CellShape::Hexahedron)), &HEXAHEDRON),
    (18, 15, Some(Kind::Cell(CellShape::Prism)), &PRISM),
    (19, 13, Some(Kind::Cell(CellShape::Pyramid)), &PYRAMID),
];

const HEXAHEDRON: [usize; 19] = [8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 20, 25, 21, 23, 24, 22, 26];
const PRISM: [usize; 12] = [6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16];
const PYRAMID: [usize; 9] = [5, 8, 10, 6, 7, 9, 11, 12, 13];

/// Dimension, number and name of a physical group.
pub(super) type Name = (i32, i32, String);

/// Number and physical groups of a surface or volume.
pub(super) type Entity = (i32, Vec<i32>);

#[derive(Default)]
pub(super) struct Contents {
    pub(super) names: Vec<Name>,
    /// Surfaces, and volumes.
    pub(super) entities: [Vec<Entity>; 2],
    /// Node numbers and coordinates.
    pub(super) tags: Vec<u64>,
    pub(super) points: Vec<[f64; 3]>,
    /// Faces and cells in the order of the file.
    pub(super) elements: Vec<Element>,
    /// Numbers of their nodes, those of a cell in its order.
    pub(super) nodes: Vec<u64>,
}

/// A face or a cell.
pub(super) struct Element {
    pub(super) tag: u64,
    /// The surface or volume that it belongs to.
    pub(super) entity: i32,
    pub(super) kind: Kind,
    /// Its nodes among those of all.
    pub(super) nodes: Range<usize>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Contents, GmshError> {
    let mut reader = Reader {
        bytes,
        at: 0,
        section: "$MeshFormat",
        is_big: false,
        is_binary: false,
    };
    if reader.line() != b"$MeshFormat" {
        return Err(GmshError::NotGmsh);
    }
    reader.format()?;
    let mut out = Contents::default();
    let (mut nodes, mut elements) = (false, false);
    while reader.skip_blanks() {
        match reader.line() {
            b"$PhysicalNames" => reader.section("$PhysicalNames", Reader::names, &mut out)?,
            b"$Entities" => reader.section("$Entities", Reader::entities, &mut out)?,
            b"$Nodes" => {
                reader.section("$Nodes", Reader::nodes, &mut out)?;
                nodes = true;
            }
            b"$Elements" => {
                reader.section("$Elements", Reader::elements, &mut out)?;
                elements = true;
            }
            b"$PartitionedEntities" => {
                let section = "$PartitionedEntities";
                return Err(GmshError::Partitioned { section });
            }
            other => reader.skip_section(other)?,
        }
    }
    for (found, section) in [(elements, "$Elements"), (nodes, "$Nodes")] {
        if !found {
            return Err(GmshError::MissingSection { section });
        }
    }
    Ok(out)
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    section: &'static str,
    /// Byte order of a binary file.
    is_big: bool,
    is_binary: bool,
}

impl<'a> Reader<'a> {
    fn damaged<T>(&self, what: &'static str) -> Result<T, GmshError> {
        Err(GmshError::Damaged {
            section: self.section,
            offset: self.at,
            what,
        })
    }

    fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or(&[])
    }

    /// Skips blanks and says whether something is left.
    fn skip_blanks(&mut self) -> bool {
        let blanks = self.rest().iter().take_while(|b| b.is_ascii_whitespace()).count();
        self.at += blanks;
        self.at < self.bytes.len()
    }

    /// The rest of the line, without its end.
    fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        rest[..length].trim_ascii_end()
    }

    fn word(&mut self) -> Result<&'a [u8], GmshError> {
        self.skip_blanks();
        let rest = self.rest();
        let length = rest.iter().take_while(|b| !b.is_ascii_whitespace()).count();
        if length == 0 || rest[0] == b'$' {
            return self.damaged("a number is missing");
        }
        self.at += length;
        Ok(&rest[..length])
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], GmshError> {
        match self.rest().first_chunk::<N>() {
            Some(chunk) => {
                self.at += N;
                Ok(*chunk)
            }
            None => self.damaged("the file ends inside of a number"),
        }
    }

    /// A number in text, or by its bytes, most significant first.
    fn number<T: std::str::FromStr, const N: usize>(
        &mut self,
        of: fn([u8; N]) -> T,
        wanted: &'static str,
    ) -> Result<T, GmshError> {
        if self.is_binary {
            let mut bytes = self.take::<N>()?;
            if !self.is_big {
                bytes.reverse();
            }
            return Ok(of(bytes));
        }
        let word = self.word()?;
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.map_or_else(|| self.damaged(wanted), Ok)
    }

    /// An unsigned number, `size_t` of Gmsh.
    fn size(&mut self) -> Result<u64, GmshError> {
        self.number(u64::from_be_bytes, "a whole number from 0 is expected")
    }

    fn int(&mut self) -> Result<i32, GmshError> {
        self.number(i32::from_be_bytes, "a whole number is expected")
    }

    fn float(&mut self) -> Result<f64, GmshError> {
        self.number(f64::from_be_bytes, "a number is expected")
    }

    /// A count of things that take at least so many numbers each, believed only if the rest of the
    /// file can hold them.
    fn count(&mut self, numbers: usize) -> Result<usize, GmshError> {
        let count = self.size()?;
        // A number takes two characters with its blank, or four bytes.
        let smallest = numbers * if self.is_binary { 4 } else { 2 };
        // The last number of a file may lack its blank.
        let room = (self.rest().len() + 1) / smallest.max(1);
        match usize::try_from(count) {
            Ok(count) if count <= room => Ok(count),
            _ => self.damaged("the count before exceeds what the file can hold"),
        }
    }

    /// A section up to and with its end; what it has comes behind that of others of its name.
    fn section(
        &mut self,
        name: &'static str,
        read: fn(&mut Self, &mut Contents) -> Result<(), GmshError>,
        out: &mut Contents,
    ) -> Result<(), GmshError> {
        self.section = name;
        read(self, out)?;
        self.end()
    }

    fn end(&mut self) -> Result<(), GmshError> {
        self.skip_blanks();
        if self.line().strip_prefix(b"$End") == self.section.as_bytes().get(1..) {
            Ok(())
        } else {
            self.damaged("the end of the section is expected")
        }
    }

    fn format(&mut self) -> Result<(), GmshError> {
        let version = self.word()?;
        if version != b"4.1" {
            let found = String::from_utf8_lossy(version).chars().take(20).collect();
            return Err(GmshError::Version { found });
        }
        self.is_binary = match self.word()? {
            b"0" => false,
            b"1" => true,
            _ => return self.damaged("the file type must be 0 (text) or 1 (binary)"),
        };
        if self.word()? != b"8" {
            return self.damaged("only a data size of 8 bytes is read");
        }
        if self.is_binary {
            self.line();
            self.is_big = match self.take::<4>()? {
                [1, 0, 0, 0] => false,
                [0, 0, 0, 1] => true,
                _ => return self.damaged("the number 1 is expected, which tells the byte order"),
            };
        }
        self.end()
    }

    /// Names of groups: text also in binary files.
    fn names(&mut self, out: &mut Contents) -> Result<(), GmshError> {
        let is_binary = std::mem::replace(&mut self.is_binary, false);
        for _ in 0..self.count(3)? {
            let (dimension, group) = (self.int()?, self.int()?);
            let quoted = self.line().trim_ascii();
            let inside = quoted.strip_prefix(b"\"").and_then(|n| n.strip_suffix(b"\""));
            let Some(name) = inside else {
                return self.damaged("a name in quotes is expected");
            };
            out.names
                .push((dimension, group, String::from_utf8_lossy(name).into_owned()));
        }
        self.is_binary = is_binary;
        Ok(())
    }

    /// Surfaces, and volumes.
    fn entities(&mut self, out: &mut Contents) -> Result<(), GmshError> {
        let counts = [self.count(5)?, self.count(9)?, self.count(9)?, self.count(9)?];
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let entity = self.int()?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    self.float()?;
                }
                let groups = self.ints()?;
                if dimension > 0 {
                    // the entities that bound it
                    self.ints()?;
                }
                if dimension > 1 {
                    out.entities[dimension - 2].push((entity, groups));
                }
            }
        }
        Ok(())
    }

    fn ints(&mut self) -> Result<Vec<i32>, GmshError> {
        (0..self.count(1)?).map(|_| self.int()).collect()
    }

    /// The header of the nodes or elements: the number of blocks, after checks.
    fn header(&mut self) -> Result<usize, GmshError> {
        let blocks = self.count(4)?;
        let (things, smallest, largest) = (self.count(1)?, self.size()?, self.size()?);
        if things == 0 || blocks == 0 {
            return self.damaged("the section is empty");
        }
        if smallest == 0 || largest < smallest {
            return self.damaged("the range of numbers in the header is wrong");
        }
        Ok(blocks)
    }

    fn nodes(&mut self, out: &mut Contents) -> Result<(), GmshError> {
        for _ in 0..self.header()? {
            let (_dimension, _entity, parametric) = (self.int()?, self.int()?, self.int()?);
            if parametric != 0 {
                return self.damaged("parametric nodes are not read (Mesh.SaveParametric = 0)");
            }
            let count = self.count(4)?;
            for _ in 0..count {
                out.tags.push(self.size()?);
            }
            for _ in 0..count {
                out.points.push([self.float()?, self.float()?, self.float()?]);
            }
        }
        Ok(())
    }

    fn elements(&mut self, out: &mut Contents) -> Result<(), GmshError> {
        let Contents { elements, nodes, .. } = out;
        for _ in 0..self.header()? {
            let (_dimension, entity, number) = (self.int()?, self.int()?, self.int()?);
            let Some(&(_, count, kind, order)) = TYPES.iter().find(|t| t.0 == number) else {
                return Err(GmshError::Unsupported { kind: number });
            };
            for _ in 0..self.count(1 + count)? {
                let (tag, start) = (self.size()?, nodes.len());
                for _ in 0..count {
                    nodes.push(self.size()?);
                }
                let Some(kind) = kind else {
                    nodes.truncate(start);
                    continue;
                };
                if let [first, ..] = order {
                    let given = nodes.split_off(start + first);
                    nodes.extend(order[..count - first].iter().map(|&k| given[k - first]));
                }
                elements.push(Element {
                    tag,
                    entity,
                    kind,
                    nodes: start..nodes.len(),
                });
            }
        }
        Ok(())
    }

    /// Skips a section of another kind, up to and with its end.
    fn skip_section(&mut self, name: &[u8]) -> Result<(), GmshError> {
        self.section = "(other)";
        let Some(name) = name.strip_prefix(b"$").filter(|n| !n.is_empty()) else {
            return self.damaged("a section is expected, starting with $");
        };
        let end = [b"$End", name].concat();
        match self.rest().windows(end.len()).position(|w| w == end) {
            Some(place) => {
                self.at += place + end.len();
                Ok(())
            }
            None => self.damaged("a section without an end"),
        }
    }
}
