//! Input decks of CalculiX and Abaqus as meshes and whole contact scenes.
//!
//! [`Deck::read`] reads a deck of tetrahedra and what it says about materials, supports, loads, contact
//! and steps. [`Deck::scene`] is the same scene as the one a program would build, bit for bit. **A keyword,
//! parameter or entry that is not understood or cannot be had is an error with file, line and word**; nothing
//! is skipped but requests for output and settings of other solvers, which [`Deck::ignored`] lists.
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
//! let error = std::fs::write(&path, text.replace("C3D4", "C3D8")).map(|()| Deck::read(&path));
//! let error = error?.unwrap_err();
//! assert_eq!(error.word(), Some("TYPE=C3D8"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is read
//!
//! | keyword | parameters | what it means here |
//! |---|---|---|
//! | `*HEADING` | | a comment |
//! | `*NODE` | `NSET` | any numbers; nodes that no element uses are dropped |
//! | `*ELEMENT` | `TYPE=C3D4`, `C3D10`, `ELSET` | linear or quadratic tetrahedra; `R3D3` and `R3D4` for rigid planes; other types are refused |
//! | `*NSET`, `*ELSET` | `NSET` or `ELSET`, `GENERATE`, `INTERNAL` | numbers and sets defined before; cards of one name add up |
//! | `*SURFACE` | `NAME`, `TYPE=ELEMENT`, `INTERNAL` | faces `S1` to `S4` of elements or sets, on the boundary; `SPOS`, `SNEG` of rigid facets |
//! | `*MATERIAL` | `NAME` | |
//! | `*ELASTIC` | `TYPE=ISO`, `ORTHO`, `ENGINEERING CONSTANTS` | numbers of one temperature; axes are x, y, z |
//! | `*DENSITY` | | for gravity |
//! | `*EXPANSION` | `TYPE=ISO`, `ORTHO`, `ZERO` | constant coefficients; `ZERO` says nothing then |
//! | `*INITIAL CONDITIONS` | `TYPE=TEMPERATURE` | temperatures without stress, else zero |
//! | `*SOLID SECTION` | `ELSET`, `MATERIAL` | a region of the mesh; each element has one |
//! | `*AMPLITUDE` | `NAME`, `TIME=STEP TIME` or `TOTAL TIME`, `VALUE=RELATIVE`, `DEFINITION=TABULAR` | straight lines, constant outside; times ascend |
//! | `*SURFACE INTERACTION` | `NAME` | |
//! | `*SURFACE BEHAVIOR` | `PRESSURE-OVERCLOSURE=HARD`, `LINEAR` | contact is hard and exact, or has a normal compliance, the inverse of the slope; other laws are refused |
//! | `*FRICTION` | `SLIP TOLERANCE`, `ELASTIC SLIP` | Coulomb's coefficient, and elastic slip where a stick slope stands beside it; both parameters are ignored: friction is exact |
//! | `*CONTACT PAIR` | `INTERACTION`, `TYPE`, `SMALL SLIDING` | the first (dependent) surface touches the second, whether their meshes match or not; sliding is small |
//! | `*TIE` | `NAME`, `ADJUST`, `POSITION TOLERANCE` | bonded surfaces, whether their meshes match or not; nodes are not moved, which is reported where they would be; nodes beyond the tolerance, which CalculiX leaves free, are refused |
//! | `*RIGID BODY` | `ELSET`, `REF NODE`, `ROT NODE` | an obstacle, see below |
//! | `*BOUNDARY` | `OP`, `AMPLITUDE`, `TYPE=DISPLACEMENT` | components 1 to 3, or `ENCASTRE`, `PINNED`, `XSYMM`, `YSYMM`, `ZSYMM`; rotations held at zero are ignored on solids |
//! | `*STEP` | `NAME`, `INC`, `NLGEOM=NO`, `AMPLITUDE=RAMP` or `STEP` | |
//! | `*STATIC` | `DIRECT`, `SOLVER` | first increment, period, least and largest increment |
//! | `*CLOAD` | `OP`, `AMPLITUDE` | forces at nodes |
//! | `*DLOAD` | `OP`, `AMPLITUDE` | `P1` to `P4` on faces; `GRAV`, `BX`, `BY`, `BZ` in elements |
//! | `*DSLOAD` | `OP`, `AMPLITUDE` | `P` on a surface |
//! | `*TEMPERATURE` | `OP`, `AMPLITUDE` | at nodes; linear between the corners of a tetrahedron |
//! | `*END STEP`, `*INCLUDE` | `INPUT` | paths are relative to the file that includes; loops are refused |
//!
//! Read and reported as ignored: `*NODE FILE, *EL FILE, *NODE PRINT, *EL PRINT, *CONTACT FILE, *CONTACT PRINT,
//! *OUTPUT` and their like, `*RESTART, WRITE`, `*CONTROLS`, `SOLVER=`. Upper and lower case are the same,
//! blanks do not count (but in quoted names), lines may end as on Windows, a keyword line that ends with a
//! comma goes on in the next one, `**` begins a comment.
//!
//! # What steps mean
//!
//! - Increments are equal, of the size of the first one (or the largest, if that is smaller), and not adapted;
//!   the scene has one result for each, with backward Euler between them. A deck with one increment is static.
//! - Loads and supports of a step stay in the next ones. Without an amplitude a value is reached along a
//!   straight line from that at the end of the step before; with `OP=NEW` what the step does not name goes back
//!   to zero so. With an amplitude it is their product; when its step is over, it stays as it was, or goes on
//!   if its amplitude is in total time.
//! - A value that jumps when a step begins takes the first increment to get there.
//! - `OP` counts on the first card of its kind in a step; `*DLOAD` and `*DSLOAD` are one kind. Forces at one
//!   node in one step are added, pressures on one face given twice are refused.
//! - What is held in the first step is held to the end: a step that releases a support, or adds one, is refused.
//!
//! # Rigid bodies
//!
//! A rigid surface, of facets or of solid elements in the `ELSET` of a `*RIGID BODY`, is the second one of a
//! pair. It becomes a half-space ([`Contact::half_space`](signorini_contact::Contact::half_space)) if that says
//! the same: if the surface is flat, if all nodes of the first surface lie over it, and if the body does not
//! turn. Its reference node has to be held in all six components (rotations are 4 to 6, `ENCASTRE` is all, or
//! those of the rotation node are held), and may be moved along a straight line. Anything else is refused with
//! its reason. Elements of rigid bodies are no part of the mesh and need no section.
//!
//! # What is a tag
//!
//! A facet of a mesh has one tag, a face of a deck may be in several surfaces and under pressure besides.
//! [`Deck::surface`] therefore gives a list of tags; it has one where nothing overlaps. With these and
//! [`Deck::node_set`] a program adds to a scene what decks do not say, a cut into subdomains or a floor without
//! elements for instance:
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

pub use deck::Deck;
pub use error::{DeckError, Fault, Location};
pub use model::Ignored;
