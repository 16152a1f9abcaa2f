//! Arrows between the rooms of the crates, read from their sources: each goes downward, so that none closes a circle.
//!
//! A room is a folder of `src`, or a file that stands in `src` itself. A room may use those of the rows below its own
//! in [`CRATES`], and no other one; a crate those after it in the list, but `fem-mesh` and `qp` know nothing of one
//! another.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The crates from top to bottom, and the rows of rooms of each from top to bottom.
const CRATES: [(&str, &[&str]); 6] = [
    ("signorini", &["error"]),
    ("deck", &["deck", "scene", "model", "lexer", "error tolerances"]),
    (
        "contact",
        &[
            "output",
            "simulation",
            "estimate",
            "solve result",
            "step",
            "state",
            "model",
            "plan",
            "discrete report",
            "scene settings mortar",
            "names",
            "error",
            "status tolerances vec3 part hash",
        ],
    ),
    (
        "tfeti",
        &[
            "preconditioner",
            "system",
            "projector",
            "coarse",
            "dual",
            "rows",
            "subdomain",
            "error",
            "linalg",
            "processes tolerances",
        ],
    ),
    (
        "qp",
        &[
            "smalse interior_point",
            "kprgp active_set fixed_point check",
            "problem",
            "report",
            "settings vector",
            "error tolerances",
        ],
    ),
    (
        "fem-mesh",
        &[
            "files recovery",
            "fields",
            "assembly loads",
            "decomposition",
            "element",
            "material mesh",
            "tables tolerances vec3 quadrature errors",
        ],
    ),
];

/// Crates that do not know one another, though one stands below the other in the list.
const APART: (&str, &str) = ("qp", "fem-mesh");

#[test]
fn arrows_between_rooms_go_down() {
    let faults: String = CRATES.iter().map(|(name, rows)| rooms(name, rows)).collect();
    assert!(faults.is_empty(), "\n{faults}");
}

#[test]
fn arrows_between_crates_go_down() {
    let mut faults = String::new();
    for (k, (name, _)) in CRATES.iter().enumerate() {
        let below: Vec<&str> = CRATES[k + 1..].iter().map(|c| c.0).collect();
        for file in sources(name) {
            for (line, path) in Paths::of(&file.text, &file.module) {
                let Some(other) = path[0].strip_prefix("signorini_") else {
                    continue;
                };
                let other = other.replace('_', "-");
                if !below.contains(&&*other) || (*name, &*other) == APART {
                    let place = file.path.display();
                    let _ = writeln!(faults, "{place}:{line}: crate {name} must not use crate {other}");
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{faults}");
}

#[test]
fn files_are_in_no_circle() {
    let mut faults = String::new();
    for (name, _) in CRATES {
        let files = sources(name);
        let modules: Vec<&[String]> = files.iter().map(|file| &*file.module).collect();
        let arrows: Vec<Vec<usize>> = (files.iter().zip(0..))
            .map(|(file, own)| {
                let paths = Paths::of(&file.text, &file.module).into_iter();
                let mut to: Vec<usize> = paths.filter_map(|(_, path)| file_of(&modules, &path)).collect();
                to.retain(|other| *other != own);
                to
            })
            .collect();
        for circle in circle_of(&arrows) {
            let _ = writeln!(faults, "crate {name}: {} is in a circle", modules[circle].join("::"));
        }
    }
    assert!(faults.is_empty(), "\n{faults}");
}

/// The file below a folder that a path leads into; what a folder hands out under its own name is not followed.
fn file_of(modules: &[&[String]], path: &[String]) -> Option<usize> {
    let longest = (2..=path.len())
        .rev()
        .find_map(|n| modules.iter().position(|m| *m == &path[..n]));
    longest.filter(|&file| {
        !modules
            .iter()
            .any(|m| m.len() > modules[file].len() && m.starts_with(modules[file]))
    })
}

/// The places that arrows lead back to.
fn circle_of(arrows: &[Vec<usize>]) -> Vec<usize> {
    let leads_back = |start: usize| {
        let (mut seen, mut open) = (vec![false; arrows.len()], arrows[start].clone());
        while let Some(place) = open.pop() {
            if !std::mem::replace(&mut seen[place], true) {
                open.extend(&arrows[place]);
            }
        }
        seen[start]
    };
    (0..arrows.len()).filter(|&start| leads_back(start)).collect()
}

#[test]
fn every_folder_says_what_it_is() {
    let mut faults = String::new();
    for file in CRATES.iter().flat_map(|(name, _)| sources(name)) {
        if file.path.ends_with("mod.rs") {
            let about = file.source.lines().take_while(|l| l.starts_with("//!")).count();
            if !(3..=14).contains(&about) {
                let place = file.path.display();
                let _ = writeln!(faults, "{place}: {about} lines of `//!`, not about ten");
            }
        }
    }
    assert!(faults.is_empty(), "\n{faults}");
}

/// Arrows are found, and those that go up, sideways or nowhere are faults.
#[test]
fn this_test_sees_wrong_arrows() {
    let source = "
        //! use crate::a::Comment;
        #[cfg(test)] mod tests;
        use crate::{a::{X, y::Z}, b};
        pub(crate) use super::super::c::W; /* crate::a */
        fn f() -> crate::b::Y { let s = \"crate::a::Text\"; super::own() }
        #[cfg(test)]
        mod tests { use crate::a::Test; }
    ";
    let module = ["d".to_owned(), "file".to_owned()];
    let found: Vec<(usize, String)> = Paths::of(&code(source), &module)
        .into_iter()
        .map(|(line, path)| (line, path.join("::")))
        .collect();
    let expected = [
        (4, "a::X"),
        (4, "a::y::Z"),
        (4, "b"),
        (5, "c::W"),
        (6, "b::Y"),
        (6, "d::own"),
    ];
    assert_eq!(found, expected.map(|(line, path)| (line, path.to_owned())));

    let rows = ["a b", "c"];
    let of = |from: &str, to: &str| arrow(&rows, from, to).is_some();
    assert!(!of("a", "c") && !of("a", "a"));
    assert!(of("c", "a") && of("a", "b") && of("a", "unknown"));

    assert_eq!(circle_of(&[vec![1], vec![2], vec![1], vec![0]]), [1, 2]);
}

struct Source {
    path: PathBuf,
    /// Its path in the crate: `["problem", "set"]`.
    module: Vec<String>,
    source: String,
    /// The source without comments, texts and its tests.
    text: String,
}

/// The faults of one crate.
fn rooms(name: &str, rows: &[&str]) -> String {
    let files = sources(name);
    let exports = exports(&files);
    let mut faults = String::new();
    let room = |file: &Source| file.module.first().cloned();
    for known in rows.iter().flat_map(|row| row.split(' ')) {
        if !files.iter().any(|file| room(file).as_deref() == Some(known)) {
            let _ = writeln!(
                faults,
                "crate {name} has no room {known:?}; mend the table of this test"
            );
        }
    }
    for file in &files {
        let Some(from) = room(file) else {
            // the root of the crate may use all of it
            continue;
        };
        for (line, path) in Paths::of(&file.text, &file.module) {
            if path[0].starts_with("signorini_") {
                continue;
            }
            let to = exports.get(&path[0]).unwrap_or(&path[0]);
            if let Some(fault) = arrow(rows, &from, to) {
                let place = file.path.display();
                let _ = writeln!(faults, "{place}:{line}: {from} -> {}: {fault}", path.join("::"));
            }
        }
    }
    faults
}

/// What is wrong with an arrow from one room to another.
fn arrow(rows: &[&str], from: &str, to: &str) -> Option<&'static str> {
    let row = |room: &str| rows.iter().position(|row| row.split(' ').any(|r| r == room));
    match (row(from), row(to)) {
        _ if from == to => None,
        (None, _) => Some("the first room is not in the table of this test"),
        (_, None) => Some("the second room is not in the table of this test"),
        (Some(a), Some(b)) if a < b => None,
        (Some(a), Some(b)) if a == b => Some("an arrow to a room beside it"),
        _ => Some("an upward arrow"),
    }
}

/// The sources of a crate.
fn sources(name: &str) -> Vec<Source> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("crates");
    let src = crates.join(name).join("src");
    let mut files = Vec::new();
    let mut folders = vec![src.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let is_tests = path.file_stem().is_some_and(|name| name == "tests");
            if is_tests || path.extension().is_none_or(|e| e != "rs") {
                continue;
            }
            let inside = path.strip_prefix(&src).expect("below src").with_extension("");
            let mut module: Vec<String> = (inside.iter())
                .map(|part| part.to_string_lossy().into_owned())
                .collect();
            module.retain(|part| part != "mod" && part != "lib");
            let source = std::fs::read_to_string(&path).expect("a source");
            let text = code(&source);
            files.push(Source {
                path,
                module,
                source,
                text,
            });
        }
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    files
}

/// Names that the root of a crate exports, and the rooms that they come from.
fn exports(files: &[Source]) -> BTreeMap<String, String> {
    let root = files.iter().find(|file| file.module.is_empty());
    let text = root.map_or("", |file| &*file.text);
    let mut exports = BTreeMap::new();
    for part in text.split("pub use ").skip(1) {
        let part = part.split(';').next().unwrap_or_default();
        // as if it were a path from the root
        for (_, path) in Paths::of(&format!("crate::{}", part.trim_start_matches("crate::")), &[]) {
            if let [room, .., name] = &*path {
                exports.insert(name.clone(), room.clone());
            }
        }
    }
    exports
}

/// A source without comments, texts and what stands from its tests on; lines stay lines.
fn code(source: &str) -> String {
    let tests = |(at, mark): (usize, &str)| {
        let next = source[at + mark.len()..].trim_start();
        let inside = next.find('{') < next.find(';').or(Some(usize::MAX));
        (next.starts_with("mod ") && inside).then_some(at)
    };
    let end = source.match_indices("#[cfg(test)]").find_map(tests);
    let source = &source[..end.unwrap_or(source.len())];
    let mut out = String::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if first == '"' {
            let end = |(k, c): (usize, char)| c == '"' && !rest[..k].ends_with('\\');
            let close = rest.char_indices().skip(1).position(|c| end((c.0, c.1)));
            close.map_or(rest.len(), |n| {
                rest.char_indices().nth(n + 2).map_or(rest.len(), |c| c.0)
            })
        } else if rest.starts_with("'\"'") {
            3
        } else {
            out.push(first);
            rest = &rest[first.len_utf8()..];
            continue;
        };
        out.extend(rest[..skipped].chars().filter(|c| *c == '\n'));
        rest = &rest[skipped..];
    }
    out
}

/// Reads the paths of a source that begin with `crate`, `super` or a crate of this workspace.
struct Paths<'a> {
    /// Words and signs with their lines.
    tokens: Vec<(usize, &'a str)>,
    at: usize,
    found: Vec<(usize, Vec<String>)>,
}

impl<'a> Paths<'a> {
    /// Line and path from the root of the crate, of every path in the source of `module`.
    fn of(text: &'a str, module: &[String]) -> Vec<(usize, Vec<String>)> {
        let mut tokens = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let mut rest = line.trim_start();
            while let Some(first) = rest.chars().next() {
                let word = |c: char| c.is_alphanumeric() || c == '_';
                let length = if rest.starts_with("::") {
                    2
                } else if word(first) {
                    rest.find(|c| !word(c)).unwrap_or(rest.len())
                } else {
                    first.len_utf8()
                };
                tokens.push((number + 1, &rest[..length]));
                rest = rest[length..].trim_start();
            }
        }
        let mut paths = Self {
            tokens,
            at: 0,
            found: Vec::new(),
        };
        while paths.at < paths.tokens.len() {
            let begins = matches!(paths.word(), "crate" | "super") || paths.word().starts_with("signorini_");
            if begins && paths.next_is("::") {
                paths.path(module.to_vec());
            } else {
                paths.at += 1;
            }
        }
        // what a room says of itself through `super` and ends at the root is `lib.rs`
        paths.found.retain(|(_, path)| !path.is_empty());
        paths.found
    }

    fn word(&self) -> &'a str {
        self.tokens.get(self.at).map_or("", |t| t.1)
    }

    fn next_is(&self, word: &str) -> bool {
        self.tokens.get(self.at + 1).is_some_and(|t| t.1 == word)
    }

    /// Follows one path, or all of a group in braces, from `base`.
    fn path(&mut self, mut base: Vec<String>) {
        let line = self.tokens.get(self.at).map_or(0, |t| t.0);
        loop {
            match self.word() {
                "{" => {
                    self.at += 1;
                    while !matches!(self.word(), "}" | "") {
                        if self.word() == "," {
                            self.at += 1;
                        } else {
                            self.path(base.clone());
                        }
                    }
                    self.at += 1;
                    return;
                }
                "crate" => base.clear(),
                "self" => {}
                "super" => {
                    base.pop();
                }
                name if name.starts_with("signorini_") => base = vec![name.to_owned()],
                name => base.push(name.to_owned()),
            }
            self.at += 1;
            if self.word() == "::" {
                self.at += 1;
            } else {
                break;
            }
        }
        // another name
        if self.word() == "as" {
            self.at += 2;
        }
        self.found.push((line, base));
    }
}
