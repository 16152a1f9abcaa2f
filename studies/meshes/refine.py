"""Goes round twice: mesh, solve, edge lengths from the estimated error, mesh again; uniform meshes beside it.

    cargo build --release --example parts
    python3 studies/meshes/refine.py FOLDER PART:TARGET[:ORDER] SIZE [SIZE ...]

The first SIZE is that of the mesh that the loop starts from; TARGET is the relative error that is asked for, ORDER that of the elements (1). All
sizes are solved on uniform meshes, too. Needs Gmsh's Python package.
"""

import subprocess
import sys
from pathlib import Path

import parts

STUDY = Path(__file__).parents[2] / "target" / "release" / "examples" / "parts"


def solve(mesh, target, order):
    """Tetrahedra and estimated error of a mesh; its wanted edge lengths lie beside it."""
    command = [STUDY, mesh, "--sizes", mesh.parent, "--target", target, "--order", order]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    print(lines[2])
    print(lines[3], flush=True)


def main(folder, word, sizes):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    name, target, order = (word + ":1").split(":")[:3]
    part = {part.__name__: part for part in parts.PARTS}[name]
    for size in sizes:
        mesh = folder / f"{name}-{size:g}.msh"
        parts.write(mesh, part, size)
        solve(mesh, target, order)
    wanted = folder / f"{name}-{sizes[0]:g}.pos"
    for loop in (1, 2):
        mesh = folder / f"{name}-round{loop}.msh"
        parts.write(mesh, part, sizes[0], wanted)
        solve(mesh, target, order)
        wanted = mesh.with_suffix(".pos")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], [float(size) for size in sys.argv[3:]])
