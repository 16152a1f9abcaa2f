//! One VTU file.

use std::path::Path;

use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArrayBase, DataSet, ElementType,
    IOBuffer, Piece, UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::Compressor;

use super::{Field, OutputError};
use crate::decomposition::{Decomposition, Subdomain};
use crate::files::replace::replace;
use crate::mesh::Surface;
use crate::mesh::TetMesh;

/// Writes the mesh as one piece with fields at its nodes and in its tetrahedra.
///
/// # Errors
/// [`OutputError`] if a field does not fit the mesh or the file cannot be written.
pub fn write_vtu(
    path: impl AsRef<Path>,
    mesh: &TetMesh,
    point_fields: &[Field],
    cell_fields: &[Field],
) -> Result<(), OutputError> {
    check(point_fields, mesh.points().len(), "nodes")?;
    check(cell_fields, mesh.tets().len(), "cells")?;
    let piece = UnstructuredGridPiece {
        points: coordinates(mesh.points().iter()),
        cells: cells(mesh.tets(), CellType::Tetra),
        data: Attributes {
            point: point_fields
                .iter()
                .map(|f| attribute(f, 0..mesh.points().len()))
                .collect(),
            cell: cell_fields
                .iter()
                .map(|f| attribute(f, 0..mesh.tets().len()))
                .collect(),
        },
    };
    write(path.as_ref(), vec![piece])
}

/// Writes each subdomain as a piece. The fields are those of the mesh, as for [`write_vtu`]; a
/// cell field `part` with the number of the subdomain is added.
///
/// # Errors
/// [`OutputError`] if a field or the decomposition does not fit the mesh, a cell field is already
/// named `part`, or the file cannot be written.
pub fn write_vtu_pieces(
    path: impl AsRef<Path>,
    mesh: &TetMesh,
    decomposition: &Decomposition,
    point_fields: &[Field],
    cell_fields: &[Field],
) -> Result<(), OutputError> {
    if decomposition.nodes() != mesh.points().len()
        || decomposition.parts().len() != mesh.tets().len()
    {
        return Err(OutputError::Foreign {
            what: "decomposition",
        });
    }
    let part = Field::scalar(
        "part",
        decomposition.parts().iter().map(|&p| p.into()).collect(),
    );
    let cell_fields = [cell_fields, &[part]].concat();
    check(point_fields, mesh.points().len(), "nodes")?;
    check(&cell_fields, mesh.tets().len(), "cells")?;
    let piece = |subdomain: &Subdomain| {
        let nodes = || subdomain.nodes.iter().map(|&n| n as usize);
        let elements = || subdomain.elements.iter().map(|&e| e as usize);
        UnstructuredGridPiece {
            points: coordinates(nodes().map(|n| &mesh.points()[n])),
            cells: cells(&subdomain.tets, CellType::Tetra),
            data: Attributes {
                point: point_fields.iter().map(|f| attribute(f, nodes())).collect(),
                cell: cell_fields
                    .iter()
                    .map(|f| attribute(f, elements()))
                    .collect(),
            },
        }
    };
    write(
        path.as_ref(),
        decomposition.subdomains().iter().map(piece).collect(),
    )
}

/// Writes a surface as triangles. The fields have one value for each of [`Surface::nodes`] and
/// [`Surface::triangles`].
///
/// # Errors
/// [`OutputError`] if a field or the surface does not fit, or the file cannot be written.
pub fn write_surface_vtu(
    path: impl AsRef<Path>,
    mesh: &TetMesh,
    surface: &Surface,
    point_fields: &[Field],
    cell_fields: &[Field],
) -> Result<(), OutputError> {
    let (nodes, triangles) = (surface.nodes(), surface.triangles());
    check(point_fields, nodes.len(), "nodes")?;
    check(cell_fields, triangles.len(), "cells")?;
    let points: Option<Vec<_>> = nodes
        .iter()
        .map(|&n| mesh.points().get(n as usize))
        .collect();
    let points = points.ok_or(OutputError::Foreign { what: "surface" })?;
    let piece = UnstructuredGridPiece {
        points: coordinates(points.into_iter()),
        cells: cells(triangles, CellType::Triangle),
        data: Attributes {
            point: point_fields
                .iter()
                .map(|f| attribute(f, 0..nodes.len()))
                .collect(),
            cell: cell_fields
                .iter()
                .map(|f| attribute(f, 0..triangles.len()))
                .collect(),
        },
    };
    write(path.as_ref(), vec![piece])
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

fn coordinates<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> IOBuffer {
    IOBuffer::F64(points.flatten().copied().collect())
}

fn cells<const N: usize>(cells: &[[u32; N]], kind: CellType) -> Cells {
    Cells {
        cell_verts: VertexNumbers::XML {
            connectivity: cells.iter().flatten().map(|&n| n.into()).collect(),
            offsets: (1..=cells.len()).map(|n| (N * n) as u64).collect(),
        },
        types: vec![kind; cells.len()],
    }
}

/// The chosen values of a field.
fn attribute(field: &Field, chosen: impl Iterator<Item = usize>) -> Attribute {
    let n = field.components;
    let values = chosen
        .flat_map(|i| &field.values[n * i..n * (i + 1)])
        .copied()
        .collect();
    let elem = match n {
        3 => ElementType::Vectors,
        _ => ElementType::Scalars {
            num_comp: n as u32,
            lookup_table: None,
        },
    };
    let name = field.name.clone();
    Attribute::DataArray(DataArrayBase {
        name,
        elem,
        data: IOBuffer::F64(values),
    })
}

fn write(path: &Path, pieces: Vec<UnstructuredGridPiece>) -> Result<(), OutputError> {
    let format = |message| OutputError::Format {
        path: path.into(),
        message,
    };
    let (compressor, level) = if pieces.iter().all(compressible) {
        (Compressor::ZLib, 1)
    } else {
        (Compressor::None, 0)
    };
    let vtk = Vtk {
        // 64-bit headers came with version 1.0 of the format.
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data: DataSet::UnstructuredGrid {
            meta: None,
            pieces: pieces
                .into_iter()
                .map(|p| Piece::Inline(Box::new(p)))
                .collect(),
        },
    };
    let xml = vtk
        .try_into_xml_format(compressor, level)
        .map_err(|e| format(e.to_string()))?;
    let mut contents = Vec::new();
    xml.write(&mut contents)
        .map_err(|e| format(e.to_string()))?;
    replace(path, &contents).map_err(|(path, source)| OutputError::Io { path, source })
}

/// vtkio 0.7.0-rc2 compresses blocks of 32 KiB and puts an empty one behind the last full one,
/// which VTK takes for damage. So a file is compressed only if every array ends inside a block.
fn compressible(piece: &UnstructuredGridPiece) -> bool {
    const BLOCK: usize = 32768;
    let array_bytes = |attribute: &Attribute| match attribute {
        Attribute::DataArray(array) => array.data.num_bytes(),
        Attribute::Field { .. } => 0,
    };
    let cells = piece.cells.num_cells();
    let topology = [
        cells,
        8 * cells,
        8 * piece.cells.num_verts(),
        piece.points.num_bytes(),
    ];
    let fields = piece
        .data
        .point
        .iter()
        .chain(&piece.data.cell)
        .map(array_bytes);
    topology
        .into_iter()
        .chain(fields)
        .all(|bytes| bytes % BLOCK != 0)
}
