//! Input decks of CalculiX and Abaqus as meshes and whole contact scenes.
//!
//! [`Deck::read`] reads the solid elements, materials, supports, loads, contact and steps of a deck. [`Deck::scene`]
//! returns the same scene, bit for bit, as a program would build. **A keyword, parameter or entry that is not
//! understood or not supported is an error with file, line and word**; only requests for output and settings of
//! other solvers are skipped, and [`Deck::ignored`] lists them.
//!
//! ```
//! use signorini_contact::{Settings, Simulation};
//! use signorini_deck::Deck;
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("part.inp");
//! let text = "
//! *NODE
//! 1, 0., 0., 0.
//! 2, 2., 0., 0.
//! 3, 0., 2., 0.
//! 4, 0., 0., 3.
//! *ELEMENT, TYPE=C3D4, ELSET=BODY
//! 1, 1, 2, 3, 4
//! *NSET, NSET=FLOOR, GENERATE
//! 1, 3
//! *SURFACE, NAME=SIDE
//! BODY, S2
//! *MATERIAL, NAME=STEEL
//! *ELASTIC
//! 210000., 0.3
//! *SOLID SECTION, ELSET=BODY, MATERIAL=STEEL
//! *BOUNDARY
//! FLOOR, 1, 3
//! *STEP
//! *STATIC
//! 0.5, 1.
//! *DSLOAD
//! SIDE, P, 2.5
//! *NODE FILE
//! U
//! *END STEP
//! ";
//! std::fs::write(&path, text)?;
//! let deck = Deck::read(&path)?;
//! for ignored in deck.ignored() {
//!     println!("{ignored}"); // part.inp:26: *NODE FILE: ignored: ...
//! }
//! let mut simulation = Simulation::new(deck.scene()?, Settings::default())?;
//! while !simulation.is_finished() {
//!     println!("t = {}", simulation.step()?.time());
//! }
//!
//! let error = std::fs::write(&path, text.replace("C3D4", "S4R")).map(|()| Deck::read(&path));
//! let error = error?.unwrap_err();
//! assert_eq!(error.word(), Some("TYPE=S4R"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is read
//!
//! | keyword | parameters | what it means here |
//! |---|---|---|
//! | `*HEADING` | | a comment |
//! | `*PART`, `*END PART` | `NAME` | nodes, elements, sets, surfaces and sections of a part |
//! | `*ASSEMBLY`, `*INSTANCE` and their ends | `NAME`, `PART` | where parts are, see below |
//! | `*NODE` | `NSET` | any numbers; nodes that no element and no equation uses are dropped |
//! | `*ELEMENT` | `TYPE=C3D4`, `C3D10`, `C3D8`, `C3D20`, `C3D6`, `C3D15`, `C3D5`, `C3D13`, `ELSET` | tetrahedra, hexahedra, prisms and pyramids, see below, and as these their variants (`C3D10M`, `C3D8R`, `C3D8I`); `R3D3` and `R3D4` for rigid surfaces; `CPS3`, `CPS4`, `CPS6`, `CPS8` and variants, `T3D2`, `T3D3`, which Gmsh writes, have no stiffness, and the flat ones name the faces on which they lie; other types are refused |
//! | `*NSET`, `*ELSET` | `NSET` or `ELSET`, `GENERATE`, `INTERNAL`, `INSTANCE` | numbers and sets defined before, or by `*NODE` and `*ELEMENT` anywhere; cards of one name add up; of `GENERATE` both ends are members |
//! | `*SURFACE` | `NAME`, `TYPE=ELEMENT`, `INTERNAL` | faces `S1` to `S6` of elements or sets, on the boundary, or without a number all that are there, or those of triangles; `SPOS`, `SNEG` of rigid facets |
//! | | `TYPE=NODE` | the faces on the boundary whose corners are all among these nodes and sets; a node on none of them is refused |
//! | `*MATERIAL` | `NAME` | |
//! | `*ELASTIC` | `TYPE=ISO`, `ORTHO`, `ENGINEERING CONSTANTS`, `ANISO` | numbers of one temperature; above Poisson's ratio 0.4 quadratic tetrahedra take the mean of the volume strain, against locking |
//! | `*DENSITY` | | for gravity |
//! | `*EXPANSION` | `TYPE=ISO`, `ORTHO`, `ZERO` | constant coefficients; `ZERO` says nothing then |
//! | `*INITIAL CONDITIONS` | `TYPE=TEMPERATURE` | temperatures without stress, else zero |
//! | `*SOLID SECTION` | `ELSET`, `MATERIAL`, `ORIENTATION` | a region of the mesh; each element has one |
//! | `*ORIENTATION` | `NAME`, `SYSTEM`, `DEFINITION=COORDINATES` | axes of the material of a section, x, y, z without; `CYLINDRICAL` of isotropic ones only |
//! | `*AMPLITUDE` | `NAME`, `TIME=STEP TIME` or `TOTAL TIME`, `VALUE=RELATIVE`, `DEFINITION=TABULAR` | straight lines, constant outside; times ascend |
//! | `*SURFACE INTERACTION` | `NAME` | |
//! | `*SURFACE BEHAVIOR` | `PRESSURE-OVERCLOSURE=HARD`, `LINEAR`, `TIED` | contact is hard and exact, or has a normal compliance, the inverse of the slope, or the pairs are as those of `*TIE`; other laws are refused |
//! | `*FRICTION` | `SLIP TOLERANCE`, `ELASTIC SLIP` | Coulomb's coefficient, and elastic slip where a stick slope stands beside it; both parameters are ignored: friction is exact |
//! | `*CONTACT PAIR` | `INTERACTION`, `TYPE`, `SMALL SLIDING`, `ADJUST` | the first (dependent) surface touches the second, whether their meshes match or not; sliding is small; with `ADJUST` gaps up to that length and overlaps are none |
//! | `*CLEARANCE` | `SLAVE`, `MASTER`, `VALUE` | the gap of a contact pair, in place of the measured one; negative for a press fit; of rigid surfaces only to a half-space |
//! | `*TIE` | `NAME`, `ADJUST`, `POSITION TOLERANCE` | bonded surfaces, whether their meshes match or not; nodes are not moved, which is reported where they would be; nodes beyond the tolerance, which CalculiX leaves free, are refused |
//! | `*RIGID BODY` | `ELSET`, `NSET`, `PIN NSET` or `TIE NSET`, `REF NODE`, `ROT NODE` | an obstacle, or nodes of elastic elements that it carries, see below |
//! | `*COUPLING` | `CONSTRAINT NAME`, `REF NODE`, `SURFACE` | a node that stands for a surface, as the card behind it says |
//! | `*DISTRIBUTING` | `COUPLING=CONTINUUM`, `WEIGHTING METHOD=UNIFORM` | forces and moments of the node are spread over the surface by areas (of flat faces), growing linearly from its centroid; it stays elastic |
//! | `*KINEMATIC` | | the surface has the displacement and the small rotation of the node, whose components 1 to 6 are held, moved, loaded or free |
//! | `*PRE-TENSION SECTION` | `SURFACE`, `NODE` | a bolt is cut at faces between elements, all on one side, and its parts move towards each other along the mean normal, or one given, under the force or the displacement of component 1 of the node; CalculiX is wrong here for tetrahedra |
//! | `*EQUATION` | | a sum of components 1 to 3 of nodes, or of each node of sets, by ascending numbers, times coefficients is zero; nodes without elements are [points](signorini_contact::Coupling::point), held, moved, loaded or free; nodes of rigid bodies and couplings are refused |
//! | `*MPC` | | `PLANE` and `STRAIGHT`: nodes stay in one plane or on one line, by equations |
//! | `*TRANSFORM` | `NSET`, `TYPE=R`, `C` | axes of nodes, along which their supports and forces are |
//! | `*BOUNDARY` | `OP`, `AMPLITUDE`, `TYPE=DISPLACEMENT`, `FIXED` | components 1 to 3, or `ENCASTRE`, `PINNED`, `XSYMM`, `XASYMM` and so on; rotations held at zero are ignored on solids; what is `FIXED` stays where the steps before left it, not read of rigid bodies, couplings and nodes of equations; a displacement before the first step is reached in that |
//! | `*STEP` | `NAME`, `INC`, `NLGEOM=NO`, `AMPLITUDE=RAMP` or `STEP` | |
//! | `*STATIC` | `DIRECT`, `SOLVER` | first increment, period, least and largest increment; 0 is the default |
//! | `*MODEL CHANGE` | `TYPE=CONTACT PAIR`, `ADD`, `REMOVE` | a pair comes or goes with the step: it [starts](signorini_contact::Contact::with_start) and [ends](signorini_contact::Contact::with_end) |
//! | `*CLOAD` | `OP`, `AMPLITUDE` | forces at nodes; moments, 4 to 6, at the node of a `*DISTRIBUTING` |
//! | `*DLOAD` | `OP`, `AMPLITUDE` | `P1` to `P6` on faces; `GRAV`, `CENTRIF` (with the square of the angular velocity; integrated exactly, in linear elements CalculiX takes the value at the centroid: 0.9 % on a coarse disc), `BX`, `BY`, `BZ` in elements, without a set in all |
//! | `*DSLOAD` | `OP`, `AMPLITUDE` | `P` on a surface; `TRVEC`, a traction in a direction |
//! | `*TEMPERATURE` | `OP`, `AMPLITUDE` | at nodes; linear between the corners of a tetrahedron; an amplitude multiplies the temperature, and its rise above the initial one counts |
//! | `*END STEP`, `*INCLUDE` | `INPUT` | paths are relative to the file that includes, or else to the deck; loops are refused |
//!
//! Skipped and listed as ignored: `*NODE FILE, *EL FILE, *NODE PRINT, *EL PRINT, *CONTACT FILE, *CONTACT PRINT,
//! *OUTPUT` and the like, `*RESTART, WRITE`, `*CONTROLS`, `SOLVER=` and other settings of solvers, `*CONDUCTIVITY`,
//! `*SPECIFIC HEAT`, `*DAMPING`. Upper and lower case are equivalent,
//! blanks are ignored (except in quoted names), lines may end as on Windows, a keyword line that ends with a
//! comma continues in the next one where that has parameters (values, or flags such as `GENERATE`), `**` begins a
//! comment.
//!
//! # Hexahedra, prisms and pyramids
//!
//! Each is [divided](signorini_fem_mesh::mesh::Division) into tetrahedra with its number. Those of second order become
//! quadratic tetrahedra; those of first order, and tetrahedra beside them or beside others, too, which is noted as
//! ignored: linear ones are far too stiff. A slender beam then bends as with `C3D20`; docs/reports/calculix.md has
//! figures. A mesh of `C3D8` gets about eight times its nodes.
//!
//! Where all nodes around one that is added are in a set, held, moved, coupled or named by equations, it is, too, with
//! the displacement that the element of the deck has there. Where they are in no common set, their reaction is that
//! `between` their sets. Not so where some are held and the others belong to a coupling that is free or loaded, or some
//! are named by equations and the others held in some steps only. Added nodes have no number of their own;
//! [`Deck::node_numbers`] gives that of a neighbour.
//!
//! # What steps mean
//!
//! - All increments have the size of the first one (or the largest allowed, if that is smaller); each is a step of
//!   backward Euler with its own result. They do not grow as in CalculiX without `DIRECT`; those that fail are cut back
//!   to the least one with [`Deck::step_halving`], into halves, which join again. A deck with one increment is static,
//!   without cut-backs.
//! - Loads and supports of a step remain in later steps. Without an amplitude a value changes linearly from its
//!   value at the end of the previous step, or jumps with `AMPLITUDE=STEP`. With an amplitude it is multiplied by that;
//!   after its step it stays constant, or continues if the amplitude is in total time. With `OP=NEW` what the step does
//!   not name returns linearly to zero, or at once if it would continue so, as in CalculiX.
//! - A value that jumps at the beginning of a step reaches the new value in the first increment.
//! - `OP` is read from the first card of its kind in a step; `*DLOAD` and `*DSLOAD` are one kind. Forces at one
//!   node in one step are added; pressures given twice on one face are refused.
//! - A support that a step leaves out ([`OP=NEW`](signorini_contact::Support::with_end)), and a contact pair that it removes,
//!   are gone in its first increment, as in CalculiX; in Abaqus the reaction fades during the step. A support that a
//!   step [adds](signorini_contact::Support::with_start) leads its nodes from where they are along a straight line to
//!   their value at the end of the step; with an amplitude they jump. A pair that it adds presses overlaps apart in
//!   the first increment, not during the step. What is held of rigid bodies, couplings and nodes of equations stays
//!   the same in all steps.
//!
//! # Rigid bodies
//!
//! A rigid surface, of facets or of solid elements in the `ELSET` of a `*RIGID BODY`, must be the second surface of a
//! pair. It becomes a half-space ([`Contact::half_space`](signorini_contact::Contact::half_space)) if the two are
//! equivalent: if the surface is flat, if all nodes of the first surface lie above it, and if the body does not
//! turn. Any other one becomes a triangulated obstacle
//! ([`Contact::obstacle`](signorini_contact::Contact::obstacle)), with triangles between neighbouring nodes, on curved
//! faces of quadratic elements more of them, at most eight an edge; nodes that do not face it touch nothing. Elements
//! of rigid bodies are not part of the mesh and need no section.
//!
//! The reference node has six components: rotations and moments are 4 to 6, or the components 1 to 3 of the rotation
//! node (the same if both; CalculiX knows those of the rotation node only), `ENCASTRE` is all. Nodes of elastic
//! elements in a rigid body, by its `NSET` or by elements that share them, become supports with the displacement of the
//! body, for small rotations, if all are held or moved. If some are free or loaded, or nodes are held by themselves,
//! too, as on planes of symmetry, or it turns and its components have different histories, they become a [rigid
//! coupling](signorini_contact::Coupling), and solid elements of its `ELSET` are elastic ones with a section, coupled.
//! The rotation of an obstacle has one history. An obstacle of facets that is free or loaded is refused.
//!
//! # Parts and instances
//!
//! Names of a part are those of an instance behind its name and a dot: `ROD-1.TIP` is the set `TIP` of the instance
//! `ROD-1`. The first instance keeps the numbers of its nodes and elements; each later one adds to them once more the
//! power of ten above all numbers of parts, so that node 12 of the third instance is 2012 if parts have numbers up to
//! 999. Nodes and elements of the assembly have the numbers of one more instance, the last one, wherever they stand.
//!
//! Numbers inside a part, or with `INSTANCE`, are those of the part, and without it inside the assembly those of the
//! assembly. Reference nodes inside the assembly are named by sets; supports and steps stand behind it.
//!
//! # Surfaces and tags
//!
//! A facet of a mesh has one tag, but a face of a deck may belong to several surfaces and loads.
//! [`Deck::surface`] therefore returns a list of tags, with one entry if nothing overlaps. With these and
//! [`Deck::node_set`] a program can add what decks do not express, for instance subdomains or a floor without
//! elements:
//!
//! ```no_run
//! use signorini_contact::{Contact, Friction};
//! # let deck = signorini_deck::Deck::read("part.inp")?;
//!
//! let [bottom] = deck.surface("BOTTOM")? else { return Err("BOTTOM overlaps".into()) };
//! let floor = Contact::half_space(*bottom, [0.0; 3], [0.0, 0.0, 1.0]).with_friction(Friction::coulomb(0.2));
//! let scene = deck.scene()?.with_contact(floor).with_boxes([4, 2, 2]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod deck;
mod error;
mod lexer;
mod model;
mod scene;
mod tolerances;

pub use deck::Deck;
pub use error::{DeckError, Fault, Location};
pub use model::Ignored;
