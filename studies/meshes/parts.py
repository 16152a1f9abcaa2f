"""Meshes of real parts by Gmsh's Python package (pip install gmsh).

    python3 studies/meshes/parts.py FOLDER [PART[:SIZE[:SIZES.pos]] ...]

writes FOLDER/PART-SIZE.msh, by default each part at its default size; with edge lengths from SIZES.pos, which the study `parts` writes
(`--sizes`), where there is one. Lengths in mm; SIZE is the edge of a tetrahedron (of the finest ones
in graded meshes). The groups are named; the study `parts` reads them.
"""

import math
import sys
from pathlib import Path

import gmsh

occ = gmsh.model.occ
field = gmsh.model.mesh.field


def entities(dim, test):
    """Tags of the entities for which test(centre, bounding box) holds."""
    found = []
    for _, tag in gmsh.model.getEntities(dim):
        if test(occ.getCenterOfMass(dim, tag), gmsh.model.getBoundingBox(dim, tag)):
            found.append(tag)
    return found


def group(dim, label, test=lambda centre, box: True):
    tags = entities(dim, test)
    assert tags, f"no entity for {label}"
    gmsh.model.addPhysicalGroup(dim, tags, name=label)


def uniform(size):
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size / 3)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 14)


def graded(size, far, centre, radius, thickness):
    """Edges of `size` in a ball, growing to `far`."""
    ball = field.add("Ball")
    for name, value in zip(["XCenter", "YCenter", "ZCenter"], centre):
        field.setNumber(ball, name, value)
    for name, value in [("Radius", radius), ("Thickness", thickness), ("VIn", size), ("VOut", far)]:
        field.setNumber(ball, name, value)
    field.setAsBackgroundMesh(ball)
    for name in ["ExtendFromBoundary", "FromPoints", "FromCurvature"]:
        gmsh.option.setNumber("Mesh.MeshSize" + name, 0)


def background(path):
    """Edge lengths from a file that the library has written."""
    gmsh.merge(str(path))
    view = field.add("PostView")
    field.setNumber(view, "ViewIndex", 0)
    field.setAsBackgroundMesh(view)
    for name in ["ExtendFromBoundary", "FromPoints", "FromCurvature"]:
        gmsh.option.setNumber("Mesh.MeshSize" + name, 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 1e22)


def bracket(size):
    """A bridge with two feet, fillets and a bolt hole: 80 x 30 x 20."""
    body = occ.addBox(0, 0, 0, 80, 30, 20)
    slot = occ.addBox(14, -1, -1, 52, 32, 9)
    body = occ.cut([(3, body)], [(3, slot)])[0][0][1]
    occ.synchronize()

    def rounded(centre, box):
        along = box[4] - box[1] > 29
        x, z = (box[0] + box[3]) / 2, (box[2] + box[5]) / 2
        return along and min(abs(z - 8), abs(z - 20)) < 0.1 and min(abs(x - k) for k in [0, 14, 66, 80]) < 0.1

    edges = [tag for _, tag in gmsh.model.getEntities(1) if rounded(None, gmsh.model.getBoundingBox(1, tag))]
    body = occ.fillet([body], edges, [3.0])[0][1]
    hole = occ.addCylinder(40, 15, -1, 0, 0, 30, 5.5)
    body = occ.cut([(3, body)], [(3, hole)])[0][0][1]
    head = occ.addDisk(40, 15, 20, 9, 9)
    occ.fragment([(3, body)], [(2, head)])
    occ.synchronize()
    stray = [tag for _, tag in gmsh.model.getEntities(2) if len(gmsh.model.getAdjacencies(2, tag)[0]) == 0]
    occ.remove([(2, tag) for tag in stray], recursive=True)
    occ.synchronize()
    group(3, "body")
    group(2, "floor", lambda c, b: abs(c[2]) < 0.1)
    group(2, "bolt", lambda c, b: abs(c[2] - 20) < 0.1 and abs(b[3] - b[0] - 18) < 0.2)
    group(2, "end", lambda c, b: abs(c[0] - 80) < 0.1)
    uniform(size)


def sphere(size):
    """A quarter of the lower half of a ball of radius 10 that stands on (0, 0, 0)."""
    ball = occ.addSphere(0, 0, 10, 10)
    box = occ.addBox(0, 0, -1, 20, 20, 11)
    occ.intersect([(3, ball)], [(3, box)])
    occ.synchronize()
    group(3, "body")
    group(2, "top", lambda c, b: abs(c[2] - 10) < 0.01)
    group(2, "x", lambda c, b: abs(c[0]) < 0.01 and abs(c[1]) > 0.1)
    group(2, "y", lambda c, b: abs(c[1]) < 0.01 and abs(c[0]) > 0.1)
    group(2, "ball", lambda c, b: min(c[0], c[1]) > 1 and c[2] < 9.99)
    graded(size, 2.5, [0, 0, 0], 1.2, 6)


def punch(size):
    """A stamp of radius 10 and height 15 with a rounded rim."""
    body = occ.addCylinder(0, 0, 0, 0, 0, 15, 10)
    occ.synchronize()
    rim = [tag for _, tag in gmsh.model.getEntities(1) if gmsh.model.getBoundingBox(1, tag)[5] < 0.1]
    occ.fillet([body], rim, [2.0])
    occ.synchronize()
    group(3, "body")
    group(2, "floor", lambda c, b: b[5] < 2.1)
    group(2, "top", lambda c, b: abs(c[2] - 15) < 0.1)
    uniform(size)


def plates(size):
    """A pad of 40 x 20 x 10 with two holes, to be held between two plates."""
    body = occ.addBox(0, 0, 0, 40, 20, 10)
    holes = [(3, occ.addCylinder(x, -1, 5, 0, 22, 0, 3)) for x in [12, 28]]
    occ.cut([(3, body)], holes)
    occ.synchronize()
    group(3, "body")
    group(2, "below", lambda c, b: abs(c[2]) < 0.1)
    group(2, "above", lambda c, b: abs(c[2] - 10) < 0.1)
    uniform(size)


def tooth(size):
    """A straight tooth of a gear with its rim, 20 wide: flanks of 20 degrees, fillets at the root."""
    low, tip, height, width = 8.0, 4.36, 10.0, 20.0
    profile = [(-14, -8), (14, -8), (14, 0), (low, 0), (tip, height), (-tip, height), (-low, 0), (-14, 0)]
    points = [occ.addPoint(x, 0, z) for x, z in profile]
    lines = [occ.addLine(points[k], points[(k + 1) % len(points)]) for k in range(len(points))]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    body = [tag for dim, tag in occ.extrude([(2, face)], 0, width, 0) if dim == 3][0]
    occ.synchronize()

    def root(box):
        x, z = (box[0] + box[3]) / 2, (box[2] + box[5]) / 2
        return box[4] - box[1] > width - 1 and abs(z) < 0.1 and abs(abs(x) - low) < 0.1

    edges = [tag for _, tag in gmsh.model.getEntities(1) if root(gmsh.model.getBoundingBox(1, tag))]
    occ.fillet([body], edges, [2.0])
    occ.synchronize()
    group(3, "body")
    group(2, "rim", lambda c, b: abs(c[2] + 8) < 0.1)
    group(2, "flank", lambda c, b: c[0] > 3 and 3 < c[2] < 9)
    uniform(size)


def flange(size):
    """A ring with four bolts, and the cover that they hold on a gasket of 2: 120 across, in three bodies."""

    def ring(inner, outer, low, high):
        whole = occ.addCylinder(0, 0, low, 0, 0, high - low, outer)
        if inner == 0:
            return [(3, whole)]
        return occ.cut([(3, whole)], [(3, occ.addCylinder(0, 0, low, 0, 0, high - low, inner))])[0]

    base, gasket, cover = ring(30, 60, 0, 12), ring(32, 40, 12, 14), ring(0, 60, 14, 26)
    bolts = []
    for x, y in [(35, 35), (-35, 35), (-35, -35), (35, -35)]:
        cover = occ.cut(cover, [(3, occ.addCylinder(x, y, 14, 0, 0, 12, 5.5))])[0]
        shank, head = occ.addCylinder(x, y, 12, 0, 0, 14, 5), occ.addCylinder(x, y, 26, 0, 0, 6, 8)
        bolts += occ.fuse([(3, shank)], [(3, head)])[0]
    base = occ.fuse(base, bolts)[0]
    occ.synchronize()
    for label, body in [("base", base), ("gasket", gasket), ("cover", cover)]:
        gmsh.model.addPhysicalGroup(3, [body[0][1]], name=label)

    def side(label, body, height):
        faces = [tag for _, tag in gmsh.model.getBoundary(body, oriented=False)]
        level = lambda tag: [gmsh.model.getBoundingBox(2, tag)[k] for k in (2, 5)]
        flat = [tag for tag in faces if all(abs(z - height) < 0.01 for z in level(tag))]
        gmsh.model.addPhysicalGroup(2, flat, name=label)

    side("foot", base, 0)
    side("seat", base, 12)
    side("heads", base, 26)
    side("below", gasket, 12)
    side("above", gasket, 14)
    side("inside", cover, 14)
    side("outside", cover, 26)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size / 3)


def faces(label, body, test):
    """Names the faces of a body for which test(centre, bounding box) holds."""
    found = []
    for _, tag in gmsh.model.getBoundary([(3, body)], oriented=False):
        if test(occ.getCenterOfMass(2, tag), gmsh.model.getBoundingBox(2, tag)):
            found.append(tag)
    assert found, f"no face for {label}"
    gmsh.model.addPhysicalGroup(2, found, name=label)


def bodies(**tags):
    occ.synchronize()
    for label, tag in tags.items():
        gmsh.model.addPhysicalGroup(3, [tag], name=label)


def ring(inner, outer, low, high):
    hole = (3, occ.addCylinder(0, 0, low - 1, 0, 0, high - low + 2, inner))
    return occ.cut([(3, occ.addCylinder(0, 0, low, 0, 0, high - low, outer))], [hole])[0][0][1]


def hub(size):
    """A hub of 90 x 40 that is pressed onto a shaft of 40 x 80."""
    shaft, own = occ.addCylinder(0, 0, 0, 0, 0, 80, 20), ring(20, 45, 20, 60)
    bodies(shaft=shaft, hub=own)
    faces("end", shaft, lambda c, b: b[5] < 0.1)
    faces("seat", shaft, lambda c, b: b[5] - b[2] > 79)
    faces("bore", own, lambda c, b: b[3] < 20.1 and b[5] - b[2] > 39)
    faces("rim", own, lambda c, b: b[3] > 44 and b[5] - b[2] > 39)
    uniform(size)


def lug(size):
    """A lug of 20 around a pin of 20 across, with a clearance of 0.05 all round."""
    pin, end = occ.addCylinder(0, 0, -30, 0, 0, 60, 10), occ.addCylinder(0, 0, -10, 0, 0, 20, 25)
    own = occ.fuse([(3, end)], [(3, occ.addBox(0, -25, -10, 80, 50, 20))])[0]
    own = occ.cut(own, [(3, occ.addCylinder(0, 0, -11, 0, 0, 22, 10.05))])[0][0][1]
    bodies(pin=pin, lug=own)
    faces("ends", pin, lambda c, b: abs(c[2]) > 29.9)
    faces("skin", pin, lambda c, b: b[5] - b[2] > 59)
    faces("bore", own, lambda c, b: b[3] < 10.2 and b[5] - b[2] > 19)
    faces("pull", own, lambda c, b: b[0] > 79)
    uniform(size)


def dovetail(size):
    """The root of a blade in the slot of a disc, 20 wide."""

    def prism(profile):
        points = [occ.addPoint(x, 0, z) for x, z in profile]
        lines = [occ.addLine(points[k], points[(k + 1) % len(points)]) for k in range(len(points))]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        return [tag for dim, tag in occ.extrude([(2, face)], 0, 20, 0) if dim == 3][0]

    half = [(15, -9), (15, -7), (8, 0), (8, 25)]
    blade = prism(half + [(-x, z) for x, z in reversed(half)])
    half = [(40, -35), (40, 1), (7, 1), (15, -7), (15, -12)]
    disc = prism(half + [(-x, z) for x, z in reversed(half)])
    bodies(blade=blade, disc=disc)
    oblique = lambda b: b[5] - b[2] > 3 and b[3] - b[0] > 3 and b[4] - b[1] > 19
    faces("root", blade, lambda c, b: oblique(b))
    faces("slot", disc, lambda c, b: oblique(b) and c[2] > -9)
    faces("tip", blade, lambda c, b: b[2] > 24)
    faces("foot", disc, lambda c, b: b[5] < -34)
    uniform(size)


def bearing(size):
    """Eight balls of 10 between two rings, in grooves of radius 5.15, without play."""
    angle = lambda k: 0.25 * math.pi * k + 0.2
    balls = [occ.addSphere(25 * math.cos(angle(k)), 25 * math.sin(angle(k)), 0, 5) for k in range(8)]
    inner, outer = ring(14, 22.5, -7, 7), ring(27.5, 36, -7, 7)
    inner = occ.cut([(3, inner)], [(3, occ.addTorus(0, 0, 0, 25.15, 5.15))])[0][0][1]
    outer = occ.cut([(3, outer)], [(3, occ.addTorus(0, 0, 0, 24.85, 5.15))])[0][0][1]
    bodies(inner=inner, outer=outer, **{f"ball {k}": ball for k, ball in enumerate(balls)})
    for k, ball in enumerate(balls):
        faces(f"skin {k}", ball, lambda c, b: True)
    groove = lambda c, b: abs(c[2]) < 5.5 and b[5] < 6.99
    faces("bore", inner, lambda c, b: b[3] < 14.1)
    faces("inside", inner, groove)
    faces("outside", outer, groove)
    faces("seat", outer, lambda c, b: b[3] > 35 and b[5] - b[2] > 13)
    uniform(size)


PARTS = {bracket: 1.9, sphere: 0.0625, punch: 1.5, plates: 1.5, tooth: 1.2, flange: 3, hub: 2, lug: 1.7, dovetail: 1.3, bearing: 2.5}


def write(path, part, size, sizes=None):
    """Meshes a part; the number of its tetrahedra."""
    gmsh.initialize()
    for option, value in [("General.Verbosity", 2), ("General.NumThreads", 1), ("Mesh.Algorithm3D", 1)]:
        gmsh.option.setNumber(option, value)
    gmsh.model.add(part.__name__)
    part(size)
    if sizes:
        background(sizes)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.optimize("")
    gmsh.write(str(path))
    tets = len(gmsh.model.mesh.getElementsByType(4)[0])
    print(f"{path}: {tets} tetrahedra", flush=True)
    gmsh.finalize()
    return tets


def main(folder, wanted):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    names = {part.__name__: part for part in PARTS}
    for word in wanted or names:
        name, size, sizes, *_ = word.split(":") + ["", ""]
        if name not in names:
            sys.exit(f"no part {name}; there are {', '.join(names)}")
        part = names[name]
        size = float(size or PARTS[part])
        write(folder / f"{name}-{size:g}.msh", part, size, sizes)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
