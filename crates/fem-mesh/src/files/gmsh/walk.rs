//! A walk through a Gmsh 4.1 file before mshio parses it.
//!
//! mshio 0.4 reserves memory for any count that the file claims, subtracts unsigned numbers and
//! panics on unknown sizes, and it drops the node numbers of files whose numbers have no gaps even
//! if they are not in order, and the names of physical groups. This walk checks every count against
//! the bytes that are there, and keeps the node numbers in the order of the coordinates and the names.

use super::GmshError;

/// Nodes and name of the element types that the walk can skip; others are refused.
const TYPES: [(i32, usize, &str, bool); 12] = [
    (1, 2, "2-node line", true),
    (2, 3, "3-node triangle", true),
    (3, 4, "4-node quadrangle", false),
    (4, 4, "4-node tetrahedron", true),
    (5, 8, "8-node hexahedron", false),
    (6, 6, "6-node prism", false),
    (7, 5, "5-node pyramid", false),
    (8, 3, "3-node line of second order", false),
    (9, 6, "6-node triangle of second order", false),
    (10, 9, "9-node quadrangle of second order", false),
    (11, 10, "10-node tetrahedron of second order", false),
    (15, 1, "point", true),
];

/// Dimension, number and name of a physical group.
pub(super) type Name = (i32, i32, String);

/// Node numbers of a file in the order in which it gives the coordinates, and the names of its groups.
pub(super) fn node_tags_and_names(bytes: &[u8]) -> Result<(Vec<u64>, Vec<Name>), GmshError> {
    let mut walk = Walk {
        bytes,
        at: 0,
        section: "$MeshFormat",
        order: None,
        is_binary: false,
    };
    if walk.line() != b"$MeshFormat" {
        return Err(GmshError::NotGmsh);
    }
    walk.format()?;
    let (mut tags, mut names, mut elements) = (None, Vec::new(), false);
    while walk.skip_blanks() {
        match walk.line() {
            b"$PhysicalNames" => {
                walk.section = "$PhysicalNames";
                names = walk.names()?;
                walk.end(b"$EndPhysicalNames")?;
            }
            b"$Entities" => {
                walk.section = "$Entities";
                walk.entities()?;
                walk.end(b"$EndEntities")?;
            }
            b"$Nodes" => {
                walk.section = "$Nodes";
                tags = Some(walk.nodes()?);
                walk.end(b"$EndNodes")?;
            }
            b"$Elements" => {
                walk.section = "$Elements";
                walk.elements()?;
                walk.end(b"$EndElements")?;
                elements = true;
            }
            b"$PartitionedEntities" => {
                return Err(GmshError::Partitioned {
                    section: "$PartitionedEntities",
                });
            }
            other => walk.skip_section(other)?,
        }
    }
    if !elements {
        return Err(GmshError::MissingSection {
            section: "$Elements",
        });
    }
    let tags = tags.ok_or(GmshError::MissingSection { section: "$Nodes" })?;
    Ok((tags, names))
}

#[derive(Clone, Copy, PartialEq)]
enum Order {
    Little,
    Big,
}

struct Walk<'a> {
    bytes: &'a [u8],
    at: usize,
    section: &'static str,
    order: Option<Order>,
    is_binary: bool,
}

impl<'a> Walk<'a> {
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
        let blanks = self
            .rest()
            .iter()
            .take_while(|b| b.is_ascii_whitespace())
            .count();
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

    /// An unsigned number, `size_t` of Gmsh.
    fn size(&mut self) -> Result<u64, GmshError> {
        if self.is_binary {
            let bytes = self.take::<8>()?;
            return Ok(match self.order {
                Some(Order::Big) => u64::from_be_bytes(bytes),
                _ => u64::from_le_bytes(bytes),
            });
        }
        let word = self.word()?;
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.map_or_else(|| self.damaged("a whole number from 0 is expected"), Ok)
    }

    fn int(&mut self) -> Result<i32, GmshError> {
        if self.is_binary {
            let bytes = self.take::<4>()?;
            return Ok(match self.order {
                Some(Order::Big) => i32::from_be_bytes(bytes),
                _ => i32::from_le_bytes(bytes),
            });
        }
        let word = self.word()?;
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.map_or_else(|| self.damaged("a whole number is expected"), Ok)
    }

    /// Skips floating point numbers; mshio reads them.
    fn floats(&mut self, count: usize) -> Result<(), GmshError> {
        for _ in 0..count {
            if self.is_binary {
                self.take::<8>()?;
            } else {
                self.word()?;
            }
        }
        Ok(())
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

    fn end(&mut self, name: &[u8]) -> Result<(), GmshError> {
        self.skip_blanks();
        if self.line() == name {
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
            self.order = match self.take::<4>()? {
                [1, 0, 0, 0] => Some(Order::Little),
                [0, 0, 0, 1] => Some(Order::Big),
                _ => return self.damaged("the number 1 is expected, which tells the byte order"),
            };
        }
        self.end(b"$EndMeshFormat")
    }

    /// Names of groups: text also in binary files.
    fn names(&mut self) -> Result<Vec<Name>, GmshError> {
        let is_binary = std::mem::replace(&mut self.is_binary, false);
        let mut names = Vec::new();
        for _ in 0..self.count(3)? {
            let (dimension, group) = (self.int()?, self.int()?);
            let quoted = self.line().trim_ascii();
            let inside = quoted
                .strip_prefix(b"\"")
                .and_then(|n| n.strip_suffix(b"\""));
            let Some(name) = inside else {
                return self.damaged("a name in quotes is expected");
            };
            names.push((dimension, group, String::from_utf8_lossy(name).into_owned()));
        }
        self.is_binary = is_binary;
        Ok(names)
    }

    fn entities(&mut self) -> Result<(), GmshError> {
        let counts = [
            self.count(5)?,
            self.count(9)?,
            self.count(9)?,
            self.count(9)?,
        ];
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                self.int()?;
                self.floats(if dimension == 0 { 3 } else { 6 })?;
                // Physical groups, then the bounding entities.
                for _ in 0..if dimension == 0 { 1 } else { 2 } {
                    for _ in 0..self.count(1)? {
                        self.int()?;
                    }
                }
            }
        }
        Ok(())
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

    fn nodes(&mut self) -> Result<Vec<u64>, GmshError> {
        let mut tags = Vec::new();
        for _ in 0..self.header()? {
            let (_dimension, _entity, parametric) = (self.int()?, self.int()?, self.int()?);
            if parametric != 0 {
                return self.damaged("parametric nodes are not read (Mesh.SaveParametric = 0)");
            }
            let count = self.count(4)?;
            for _ in 0..count {
                tags.push(self.size()?);
            }
            self.floats(3 * count)?;
        }
        Ok(tags)
    }

    fn elements(&mut self) -> Result<(), GmshError> {
        for _ in 0..self.header()? {
            let (_dimension, _entity, kind) = (self.int()?, self.int()?, self.int()?);
            let nodes = match TYPES.iter().find(|t| t.0 == kind) {
                Some(&(_, nodes, _, true)) => nodes,
                Some(&(_, _, name, false)) => return Err(GmshError::Unsupported { kind, name }),
                None => {
                    return Err(GmshError::Unsupported {
                        kind,
                        name: "unknown",
                    });
                }
            };
            for _ in 0..self.count(1 + nodes)? {
                for _ in 0..=nodes {
                    self.size()?;
                }
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
