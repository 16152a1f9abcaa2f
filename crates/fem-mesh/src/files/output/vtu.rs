//! One VTU file.

use std::io::Read;
use std::path::Path;

use flate2::Compression;
use flate2::read::ZlibEncoder;

use crate::files::replace::replace;
use crate::mesh::TetMesh;

use super::{Field, OutputError, SurfaceFields};

/// Writes the mesh as one piece with fields at its nodes and in its tetrahedra, which are quadratic cells if it has
/// order 2.
///
/// # Errors
/// [`OutputError`] if a field does not fit the mesh or the file cannot be written.
pub fn write_vtu(
    path: impl AsRef<Path>,
    mesh: &TetMesh,
    point_fields: &[Field],
    cell_fields: &[Field],
) -> Result<(), OutputError> {
    write_cells(path.as_ref(), mesh, |_| true, point_fields, cell_fields)
}

/// Writes those tetrahedra that are `kept`, if any, as a piece with the nodes that they use. The fields are those of
/// the mesh.
pub(super) fn write_cells(
    path: &Path,
    mesh: &TetMesh,
    kept: impl Fn(usize) -> bool,
    point_fields: &[Field],
    cell_fields: &[Field],
) -> Result<(), OutputError> {
    check(point_fields, mesh.points().len(), "nodes")?;
    check(cell_fields, mesh.tets().len(), "cells")?;
    let own: Vec<usize> = (0..mesh.tets().len()).filter(|&t| kept(t)).collect();
    if own.is_empty() {
        return Ok(());
    }
    let mut file = File::new();
    match mesh.order() {
        1 => file.part(mesh, mesh.tets(), &own, (point_fields, cell_fields)),
        _ => file.part(mesh, &mesh.quadratic_tets(), &own, (point_fields, cell_fields)),
    }
    file.write(path)
}

/// Writes the list of the pieces of several processes, which stand beside it.
pub(super) fn write_pvtu(
    path: &Path,
    pieces: &[String],
    point_fields: &[Field],
    cell_fields: &[Field],
) -> Result<(), OutputError> {
    let mut file = File(HEAD.replace("UnstructuredGrid", "PUnstructuredGrid"));
    file.0 = file
        .0
        .replace("<PUnstructuredGrid>", "<PUnstructuredGrid GhostLevel=\"0\">");
    let mut arrays = |tag: &str, list: &mut dyn Iterator<Item = (&str, usize)>| {
        file.open(tag, "");
        for (name, components) in list {
            file.0 += &format!(
                "<PDataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{components}\"/>\n",
                escape(name)
            );
        }
        file.close(tag);
    };
    arrays(
        "PPointData",
        &mut point_fields.iter().map(|f| (&f.name[..], f.components)),
    );
    arrays(
        "PCellData",
        &mut cell_fields.iter().map(|f| (&f.name[..], f.components)),
    );
    arrays("PPoints", &mut std::iter::once(("Points", 3)));
    for piece in pieces {
        file.0 += &format!("<Piece Source=\"{}\"/>\n", escape(piece));
    }
    file.close("PUnstructuredGrid");
    file.save(path)
}

/// Writes surfaces as triangles, each as a piece, with one value of its fields for each of [`Surface::nodes`] and
/// [`Surface::triangles`]. All have the same fields.
///
/// [`Surface::nodes`]: crate::Surface::nodes
/// [`Surface::triangles`]: crate::Surface::triangles
///
/// # Errors
/// [`OutputError`] if a field or a surface does not fit, the fields of two surfaces differ, or the file cannot be
/// written.
pub fn write_surfaces_vtu(
    path: impl AsRef<Path>,
    mesh: &TetMesh,
    surfaces: &[SurfaceFields<'_>],
) -> Result<(), OutputError> {
    let mut file = File::new();
    for (number, &(surface, point_fields, cell_fields)) in surfaces.iter().enumerate() {
        let (nodes, triangles) = (surface.nodes(), surface.triangles());
        check(point_fields, nodes.len(), "nodes")?;
        check(cell_fields, triangles.len(), "cells")?;
        let kinds = |fields: &[Field]| {
            fields
                .iter()
                .map(|f| (f.name.clone(), f.components))
                .collect::<Vec<_>>()
        };
        if kinds(point_fields) != kinds(surfaces[0].1) || kinds(cell_fields) != kinds(surfaces[0].2) {
            return Err(OutputError::PieceFields { number });
        }
        let point = |&n: &u32| mesh.points().get(n as usize).copied();
        let points: Option<Vec<_>> = nodes.iter().map(point).collect();
        let points = points.ok_or(OutputError::Foreign { what: "surface" })?;
        file.piece(&points, triangles, point_fields, cell_fields);
    }
    file.write(path.as_ref())
}

fn check(fields: &[Field], count: usize, what: &'static str) -> Result<(), OutputError> {
    for (number, field) in fields.iter().enumerate() {
        let (name, components) = (field.name.clone(), field.components);
        if name.is_empty() {
            return Err(OutputError::Unnamed { what });
        }
        if fields[..number].iter().any(|f| f.name == name) {
            return Err(OutputError::RepeatedName { name, what });
        }
        let (given, expected) = (field.values.len(), components * count);
        if given != expected {
            return Err(OutputError::FieldLength {
                name,
                what,
                given,
                expected,
                components,
            });
        }
        if let Some(place) = field.values.iter().position(|v| !v.is_finite()) {
            let (index, value) = (place / components, field.values[place]);
            return Err(OutputError::NotFinite {
                name,
                what,
                index,
                value,
            });
        }
    }
    Ok(())
}

/// A file of unstructured grids: XML with binary arrays.
struct File(String);

const HEAD: &str = "<?xml version=\"1.0\"?>\n\
    <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" \
    compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n";

impl File {
    fn new() -> Self {
        Self(HEAD.into())
    }

    /// Some of the cells of a mesh, with the nodes that they use.
    fn part<const N: usize>(
        &mut self,
        mesh: &TetMesh,
        cells: &[[u32; N]],
        own: &[usize],
        (point_fields, cell_fields): (&[Field], &[Field]),
    ) {
        let mut place = vec![u32::MAX; mesh.points().len()];
        own.iter().flat_map(|&t| cells[t]).for_each(|n| place[n as usize] = 0);
        let nodes: Vec<usize> = (0..place.len()).filter(|&n| place[n] == 0).collect();
        nodes.iter().zip(0..).for_each(|(&n, k)| place[n] = k);
        let points: Vec<_> = nodes.iter().map(|&n| mesh.points()[n]).collect();
        let cells: Vec<_> = own.iter().map(|&t| cells[t].map(|n| place[n as usize])).collect();
        let chosen = |fields: &[Field], places: &[usize]| -> Vec<Field> {
            let of = |field: &Field| {
                let n = field.components;
                let values = places.iter().flat_map(|&i| &field.values[n * i..n * (i + 1)]);
                Field {
                    values: values.copied().collect(),
                    name: field.name.clone(),
                    ..*field
                }
            };
            fields.iter().map(of).collect()
        };
        self.piece(
            &points,
            &cells,
            &chosen(point_fields, &nodes),
            &chosen(cell_fields, own),
        );
    }

    /// Cells of `N` nodes, with fields.
    fn piece<const N: usize>(
        &mut self,
        points: &[[f64; 3]],
        cells: &[[u32; N]],
        point_fields: &[Field],
        cell_fields: &[Field],
    ) {
        let numbers = |n: u64| n.to_le_bytes();
        let counts = [points.len(), cells.len()];
        self.open(
            "Piece",
            &format!("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", counts[0], counts[1]),
        );
        self.open("PointData", "");
        point_fields.iter().for_each(|field| self.field(field));
        self.close("PointData");
        self.open("CellData", "");
        cell_fields.iter().for_each(|field| self.field(field));
        self.close("CellData");
        self.open("Points", "");
        let coordinates = points.iter().flatten().flat_map(|x| x.to_le_bytes());
        self.array("Float64", "Points", 3, coordinates.collect());
        self.close("Points");
        self.open("Cells", "");
        let connectivity = cells.iter().flatten().flat_map(|&n| numbers(n.into()));
        self.array("UInt64", "connectivity", 1, connectivity.collect());
        let offsets = (1..=cells.len()).flat_map(|n| numbers((N * n) as u64));
        self.array("UInt64", "offsets", 1, offsets.collect());
        // triangle, tetrahedron or quadratic tetrahedron, whose nodes VTK has in the same order
        let kind = match N {
            3 => 5,
            4 => 10,
            _ => 24,
        };
        self.array("UInt8", "types", 1, vec![kind; cells.len()]);
        self.close("Cells");
        self.close("Piece");
    }

    fn field(&mut self, field: &Field) {
        let bytes = field.values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.array("Float64", &escape(&field.name), field.components, bytes);
    }

    fn open(&mut self, tag: &str, attributes: &str) {
        let blank = if attributes.is_empty() { "" } else { " " };
        self.0 += &format!("<{tag}{blank}{attributes}>\n");
    }

    fn close(&mut self, tag: &str) {
        self.0 += &format!("</{tag}>\n");
    }

    /// Blocks of zlib behind a header: numbers of blocks and of bytes in the first and the last, compressed sizes.
    fn array(&mut self, kind: &str, name: &str, components: usize, bytes: Vec<u8>) {
        let attributes =
            format!("type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\"");
        self.open("DataArray", &attributes);
        let last = bytes.chunks(BLOCK).last().map_or(0, <[u8]>::len);
        let mut header = vec![bytes.len().div_ceil(BLOCK), BLOCK, last];
        let mut data = Vec::new();
        for block in bytes.chunks(BLOCK) {
            let before = data.len();
            data.extend(compressed(block));
            header.push(data.len() - before);
        }
        let header: Vec<u8> = header.iter().flat_map(|&n| (n as u64).to_le_bytes()).collect();
        base64(&header, &mut self.0);
        base64(&data, &mut self.0);
        self.0.push('\n');
        self.close("DataArray");
    }

    fn write(mut self, path: &Path) -> Result<(), OutputError> {
        self.close("UnstructuredGrid");
        self.save(path)
    }

    fn save(mut self, path: &Path) -> Result<(), OutputError> {
        self.close("VTKFile");
        replace(path, self.0.as_bytes()).map_err(|(path, source)| OutputError::Io { path, source })
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

fn base64(bytes: &[u8], out: &mut String) {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for three in bytes.chunks(3) {
        let mut bits = 0;
        (0..3).for_each(|k| bits = bits << 8 | usize::from(three.get(k).copied().unwrap_or(0)));
        for k in 0..4 {
            let digit = DIGITS[bits >> (18 - 6 * k) & 63];
            out.push(if k <= three.len() { char::from(digit) } else { '=' });
        }
    }
}

/// The characters that XML reserves inside an attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
