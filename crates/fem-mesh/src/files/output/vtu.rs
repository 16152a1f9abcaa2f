//! One VTU file.

use std::path::Path;

use crate::files::replace::replace;
use crate::mesh::TetMesh;

use super::grid::Grid;
use super::xml::{File, escape};
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
    let file = (path.as_ref(), &mut Vec::new());
    write_cells(file, mesh, |_| true, point_fields, cell_fields)
}

/// Writes those tetrahedra that are `kept`, if any, as a piece with the nodes that they use. The fields are those of
/// the mesh, the grids those of the file before.
pub(super) fn write_cells(
    (path, grids): (&Path, &mut Vec<Grid>),
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
    let fields = (point_fields, cell_fields);
    match mesh.order() {
        1 => file.part(grids, mesh, mesh.tets(), &own, fields),
        _ => file.part(grids, mesh, &mesh.quadratic_tets(), &own, fields),
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
    let head = HEAD.replace("UnstructuredGrid", "PUnstructuredGrid");
    let head = head.replace("<PUnstructuredGrid>", "<PUnstructuredGrid GhostLevel=\"0\">");
    let mut file = File(head.into());
    let mut arrays = |tag: &str, list: &mut dyn Iterator<Item = (&str, usize)>| {
        file.open(tag, "");
        for (name, components) in list {
            file.line(format_args!(
                "<PDataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{components}\"/>",
                escape(name)
            ));
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
        file.line(format_args!("<Piece Source=\"{}\"/>", escape(piece)));
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
    write_pieces((path.as_ref(), &mut Vec::new()), mesh, surfaces)
}

/// The same; the grids are those of the file before.
pub(super) fn write_pieces(
    (path, grids): (&Path, &mut Vec<Grid>),
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
        if surface.mesh_nodes() != mesh.points().len() {
            return Err(OutputError::Foreign { what: "surface" });
        }
        let points = nodes.iter().map(|&n| mesh.points()[n as usize]).collect();
        file.piece(
            Grid::of(grids, number, points, triangles.to_vec()),
            point_fields,
            cell_fields,
        );
    }
    file.write(path)
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
        grids: &mut Vec<Grid>,
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
        let grid = Grid::of(grids, 0, points, cells);
        if nodes.len() == mesh.points().len() && own.len() == mesh.tets().len() {
            self.piece(grid, point_fields, cell_fields);
        } else {
            self.piece(grid, &chosen(point_fields, &nodes), &chosen(cell_fields, own));
        }
    }

    /// A grid with fields.
    fn piece(&mut self, grid: &Grid, point_fields: &[Field], cell_fields: &[Field]) {
        let [points, cells] = grid.counts();
        self.open(
            "Piece",
            &format!("NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\""),
        );
        self.open("PointData", "");
        point_fields.iter().for_each(|field| self.field(field));
        self.close("PointData");
        self.open("CellData", "");
        cell_fields.iter().for_each(|field| self.field(field));
        self.close("CellData");
        self.0.extend_from_slice(grid.text());
        self.close("Piece");
    }

    fn field(&mut self, field: &Field) {
        let name = escape(&field.name);
        self.array("Float64", &name, field.components, &field.values, f64::to_le_bytes);
    }

    fn write(mut self, path: &Path) -> Result<(), OutputError> {
        self.close("UnstructuredGrid");
        self.save(path)
    }

    fn save(mut self, path: &Path) -> Result<(), OutputError> {
        self.close("VTKFile");
        replace(path, &self.0).map_err(|(path, source)| OutputError::Io { path, source })
    }
}
