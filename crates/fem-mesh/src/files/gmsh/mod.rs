//! Mesh files of Gmsh, format 4.1, text or binary, and edge lengths for its next mesh (feature `gmsh`).
//!
//! Triangles become tagged facets, tetrahedra the mesh, of order 2 if they have ten nodes; hexahedra, prisms and
//! pyramids are [divided](crate::mesh::Division) into tetrahedra, quadrilaterals into triangles; those of order 1 need
//! [`TetMesh::raise_order`] afterwards to bend as they did. Points and lines are skipped, and nodes that no tetrahedron
//! uses are dropped. The tag of a facet is the physical group of its surface, the region of a tetrahedron that of its
//! volume; if the file has no physical groups of that dimension, the numbers of the geometric entities are used, and
//! surfaces between two volumes are skipped. Entities outside of the groups, if there are any groups, leave triangles
//! untagged and give region 0.
//!
//! `reader` takes the file apart, `names` has the names of the groups, `sizes` writes.

mod names;
mod reader;
mod sizes;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

pub use names::GroupNames;
pub use sizes::write_sizes;

use crate::mesh::{
    Cell, Division, Facet, FacetTag, MeshError, TetMesh, divide_face, drop_unused_nodes, orient_tets, quadratic_tets,
};
use crate::tables::ascending;
use reader::Kind;

errors! {
    /// A Gmsh file that cannot be read or written.
    GmshError {
        Io { path: PathBuf, r#source: std::io::Error } = "cannot read {}: {source}", path.display();
        Write { path: PathBuf, r#source: std::io::Error } = "cannot write {}: {source}", path.display();
        Sizes { nodes: usize, found: usize, good: usize } =
            "the mesh has {nodes} nodes and there are {found} edge lengths, the first {good} of them positive; give one positive \
            length a node";
        NotGmsh = "this is no Gmsh mesh: it does not start with a $MeshFormat section";
        Version { found: String } =
            "the file has Gmsh format {found:?}; only 4.1 is read, so save it with Mesh.MshFileVersion = 4.1 (gmsh \
            -format msh41)";
        Damaged { section: &'static str, offset: usize, what: &'static str } =
            "section {section} of the Gmsh file is damaged at byte {offset}: {what}; export the mesh again";
        MissingSection { section: &'static str } =
            "the Gmsh file has no section {section}; export the mesh, not only the geometry";
        Partitioned { section: &'static str } =
            "the Gmsh file is partitioned (section {section}), and groups of its parts are not read; save the mesh \
            before it is partitioned (gmsh.model.mesh.unpartition), and cut it with Decomposition::boxes or \
            from_parts";
        NoTetrahedra =
            "the Gmsh file has no elements of volumes: mesh in three dimensions (gmsh -3); if that was done, add a physical \
            volume, or set Mesh.SaveAll = 1, since Gmsh saves only what is in physical groups as soon as there are \
            some";
        UnknownName { what: &'static str, name: String, known: Vec<String> } =
            "the Gmsh file has no physical {what} named {name:?}; {}", listed(what, known);
        Unsupported { kind: i32 } =
            "the Gmsh file has elements of type {kind}; only those of order 1 or 2 are read, so set Mesh.ElementOrder";
        MixedOrder { linear: usize, quadratic: usize } =
            "the Gmsh file has {linear} elements of volumes of order 1 and {quadratic} of order 2; save all volumes with \
            one order (Mesh.ElementOrder)";
        RepeatedNode { tag: u64 } = "the Gmsh file defines node {tag} twice; export the mesh again";
        UnknownNode { element: u64, node: u64 } =
            "element {element} of the Gmsh file uses node {node}, which the file does not define; export the mesh \
            again";
        SeveralGroups { what: &'static str, entity: i32, groups: Vec<i32> } =
            "{what} {entity} of the Gmsh file is in the physical groups {groups:?}; a part of the mesh has one tag, \
            so keep one group";
        RepeatedName { name: String, groups: [u32; 2] } =
            "the physical groups {} and {} of the Gmsh file are both named {name:?}; rename one", groups[0], groups[1];
        LooseSurface { surface: u32 } =
            "faces of the physical surface {surface} of the Gmsh file have nodes that no element of a volume uses; take the \
            surface out of the groups, or mesh the volume behind it";
        Mesh(MeshError) =
            "the mesh in the Gmsh file (numbers from 0, in the order of the file: nodes those that volumes use, facets the \
            triangles in groups; a divided element is several of them): {0}";
    }
}

impl From<MeshError> for GmshError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

/// The names that there are, in words.
fn listed(what: &str, known: &[String]) -> String {
    if known.is_empty() {
        return format!("no {what} in it has a name by a group, so name one (Physical Surface, Physical Volume)");
    }
    let names: Vec<String> = known.iter().map(|name| format!("{name:?}")).collect();
    format!("the {what}s in it are {}", names.join(", "))
}

/// Reads a mesh with its tags and regions from a file, and the names of its physical groups.
///
/// ```no_run
/// use signorini_fem_mesh::gmsh::read_gmsh;
///
/// let (mesh, names) = read_gmsh("block.msh")?;
/// let floor = names.surface("foundation")?;
/// println!("{} nodes can touch", mesh.nodes_on(floor).len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`GmshError`] if the file cannot be read or understood, or its mesh is not valid.
pub fn read_gmsh(path: impl AsRef<Path>) -> Result<(TetMesh, GroupNames), GmshError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| GmshError::Io {
        path: path.into(),
        source,
    })?;
    parse_gmsh(&bytes)
}

/// The same from the contents of a file.
///
/// # Errors
/// [`GmshError`] if the contents cannot be understood or the mesh is not valid.
pub fn parse_gmsh(bytes: &[u8]) -> Result<(TetMesh, GroupNames), GmshError> {
    let file = reader::read(bytes)?;
    let mut number = HashMap::with_capacity(file.tags.len());
    for (place, &tag) in file.tags.iter().enumerate() {
        if number.insert(tag, place as u32).is_some() {
            return Err(GmshError::RepeatedNode { tag });
        }
    }
    let surfaces = Tags::new("surface", &file.entities[0])?;
    let volumes = Tags::new("volume", &file.entities[1])?;
    let (mut cells, mut facets, mut regions) = (Vec::new(), Vec::new(), Vec::new());
    let nodes = numbered(&file, &number)?;
    for element in &file.elements {
        let nodes = &nodes[element.nodes.clone()];
        match element.kind {
            Kind::Cell(shape) => {
                cells.push(Cell { shape, nodes });
                regions.push(volumes.of(element.entity).unwrap_or(0));
            }
            Kind::Face { corners } => {
                if let Some(tag) = surfaces.of(element.entity).map(FacetTag) {
                    let triangles = divide_face(&nodes[..corners]);
                    facets.extend(triangles.map(|nodes| Facet { nodes, tag }));
                }
            }
        }
    }
    let quadratic = cells.iter().filter(|c| c.nodes.len() > c.shape.corners()).count();
    let linear = cells.len() - quadratic;
    if linear.min(quadratic) > 0 {
        return Err(GmshError::MixedOrder { linear, quadratic });
    }
    let mut points = file.points;
    let division = Division::new(&mut points, &cells)?;
    let facets = (facets, surfaces.are_groups());
    let mesh = match (linear, quadratic) {
        (0, 0) => return Err(GmshError::NoTetrahedra),
        (_, 0) => mesh(TetMesh::new, points, division.tets, facets)?,
        _ => mesh(
            TetMesh::quadratic,
            points,
            quadratic_tets(&division.tets, &division.mids),
            facets,
        )?,
    };
    let of_cells = regions.into_iter().zip(&division.of_cell);
    let regions = of_cells.flat_map(|(region, tets)| tets.clone().map(move |_| region));
    let are_groups = [surfaces.are_groups(), volumes.are_groups()];
    Ok((
        mesh.with_regions(regions.collect())?,
        GroupNames::new(&file.names, are_groups),
    ))
}

/// The nodes of all elements by their places in the file.
fn numbered(file: &reader::Contents, number: &HashMap<u64, u32>) -> Result<Vec<u32>, GmshError> {
    let of = |element: &reader::Element| {
        let tag = element.tag;
        let nodes = file.nodes[element.nodes.clone()].iter();
        nodes.map(move |node| {
            number.get(node).copied().ok_or(GmshError::UnknownNode {
                element: tag,
                node: *node,
            })
        })
    };
    file.elements.iter().flat_map(of).collect()
}

/// The mesh of tetrahedra of either order; `grouped`: whether the facets are those of named groups.
fn mesh<const N: usize>(
    build: impl Fn(Vec<[f64; 3]>, Vec<[u32; N]>, Vec<Facet>) -> Result<TetMesh, MeshError>,
    mut points: Vec<[f64; 3]>,
    mut tets: Vec<[u32; N]>,
    (mut facets, grouped): (Vec<Facet>, bool),
) -> Result<TetMesh, GmshError> {
    orient_tets(&points, &mut tets);
    drop_unused_nodes(&mut points, &mut tets, &mut facets);
    let is_loose = |f: &&Facet| f.nodes.iter().any(|&node| node as usize >= points.len());
    if let Some(facet) = facets.iter().find(is_loose).filter(|_| grouped) {
        return Err(GmshError::LooseSurface { surface: facet.tag.0 });
    }
    if !grouped {
        // Nobody asked for these surfaces by name, and some may lie between two volumes.
        facets = on_boundary(&build(points.clone(), tets.clone(), Vec::new())?, facets);
    }
    Ok(build(points, tets, facets)?)
}

fn on_boundary(bare: &TetMesh, facets: Vec<Facet>) -> Vec<Facet> {
    let boundary: HashSet<_> = bare.boundary_facets().iter().map(|f| ascending(f.nodes)).collect();
    facets
        .into_iter()
        .filter(|f| boundary.contains(&ascending(f.nodes)))
        .collect()
}

/// From entities to physical groups, for one dimension; empty of a file without these.
struct Tags(HashMap<i32, u32>);

impl Tags {
    fn new(what: &'static str, entities: &[reader::Entity]) -> Result<Self, GmshError> {
        let mut group_of = HashMap::new();
        for &(entity, ref groups) in entities {
            // The sign of a group is an orientation.
            for group in groups.iter().map(|g| g.unsigned_abs()) {
                let before = *group_of.entry(entity).or_insert(group);
                if before != group {
                    let groups = vec![before as i32, group as i32];
                    return Err(GmshError::SeveralGroups { what, entity, groups });
                }
            }
        }
        Ok(Self(group_of))
    }

    fn are_groups(&self) -> bool {
        !self.0.is_empty()
    }

    fn of(&self, entity: i32) -> Option<u32> {
        if self.are_groups() { self.0.get(&entity).copied() } else { Some(entity.unsigned_abs()) }
    }
}
