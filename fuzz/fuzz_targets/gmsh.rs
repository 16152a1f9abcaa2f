//! Any bytes as a Gmsh mesh.
#![no_main]

use libfuzzer_sys::fuzz_target;
use signorini::fem_mesh::gmsh::parse_gmsh;

fuzz_target!(|bytes: &[u8]| {
    let _ = parse_gmsh(bytes);
});
