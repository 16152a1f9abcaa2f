//! What the studies share: the brick of the benchmark, runs with their records, tables, files and pictures.
//!
//! The studies themselves are the examples of this package, one file or folder each; `cargo run --release --example
//! NAME -- --help` lists their options. Each has a function `execute`, which the tests call as well.
//!
//! | study | shows |
//! |---|---|
//! | `brick` | the benchmark of the paper's section 6: table beside the paper's, pictures, files |
//! | `frictionless` | the same brick, static and without friction, product by product |
//! | `bodies` | two elastic bodies: a pad pressed on a rail and pulled along it |
//! | `calculix` | the static brick and a beam of all elements as decks, beside CalculiX where it is installed |
//! | `cases` | published problems with known answers, on meshes that do not match |
//! | `parts` | real parts on meshes of Gmsh, cut by the library |
//! | `accuracy` | error against products and time |
//! | `effects` | one brick, its effects switched on one by one beside the plan's prediction |
//! | `performance` | from the paper's method to the default; `--cuts`: subdomains of every shape |
//! | `stability` | hard cases, what the library does with them, and what has to hold |

use std::path::Path;
use std::process::ExitCode;

pub mod brick;
pub mod chart;
pub mod draw;
pub mod files;
pub mod options;
pub mod paper;
pub mod record;
pub mod run;
pub mod snapshot;
pub mod surface;
pub mod svg;

/// Any failure of a study, as a sentence.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Writes a file, with the folders above it.
pub fn save(path: &Path, text: &str) -> Result<(), Failure> {
    let folder = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    let written = folder.and_then(|()| std::fs::write(path, text));
    written.map_err(|e| format!("cannot write {}: {e}", path.display()).into())
}

/// Prints an error, if there is one, and gives the exit code: 0, or 1 after an error.
pub fn exit<T>(result: Result<T, Failure>) -> ExitCode {
    let Err(error) = result else {
        return ExitCode::SUCCESS;
    };
    // the reader of a pipe has what it wanted
    let io = error.downcast_ref::<std::io::Error>();
    if io.is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe) {
        return ExitCode::SUCCESS;
    }
    eprintln!("error: {error}");
    ExitCode::FAILURE
}

/// A table of text, columns right-aligned under heads of two lines; a head `["|", "|"]` is a bar between columns and
/// takes no cell.
pub fn aligned(heads: &[[&str; 2]], rows: &[Vec<String>]) -> String {
    let mut columns: Vec<Vec<&str>> = heads.iter().map(|h| h.to_vec()).collect();
    for row in rows {
        let mut cells = row.iter();
        for column in &mut columns {
            let bar = column[0] == "|";
            column.push(if bar { "|" } else { cells.next().map_or("", String::as_str) });
        }
    }
    let width = |c: &Vec<&str>| c.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = columns.iter().map(width).collect();
    let line = |k: usize| {
        let cells = columns.iter().zip(&widths).map(|(c, w)| format!("{:>w$}", c[k]));
        cells.collect::<Vec<_>>().join("  ") + "\n"
    };
    (0..rows.len() + 2).map(line).collect()
}
