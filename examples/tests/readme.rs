//! The program in the README is the example `first`, to the letter.

#[test]
fn the_readme_shows_the_example() {
    let readme = include_str!("../../README.md");
    let example = include_str!("../examples/first.rs");
    let program = example
        .split_once("\n\n")
        .map_or(example, |(_, program)| program)
        .trim();
    assert!(
        readme.contains(program),
        "copy examples/examples/first.rs into the README"
    );
    assert!(program.lines().count() <= 40);
}
