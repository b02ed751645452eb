#!/usr/bin/env python3
"""Writes scenes of affine bodies: a house of cards, a set of gears, a net of chain links, ships with sails.

    python3 scenes/generators/affine.py house_of_cards --levels 10 house_of_cards.json
    python3 scenes/generators/affine.py gears --columns 7 --rows 4 gears.json
    python3 scenes/generators/affine.py chain_net --knots 97 --no-ball chain_net_97.json
    python3 scenes/generators/affine.py ships --helicopters 3 ships.json

Meshes go to the folder meshes/ beside the scene. The scenes in scenes/ are those of the options' defaults.
"""
import argparse
import itertools
import json
import math
from pathlib import Path


def number(x):
    """Without digits that say nothing."""
    return float(f"{x:.9g}") + 0.0


def vector(*v):
    return [number(x) for x in v]


def write_mesh(path, title, vertices, triangles):
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as out:
        out.write(f"# {title}\n")
        out.writelines(f"v {number(x):g} {number(y):g} {number(z):g}\n" for x, y, z in vertices)
        out.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles)


def write_tetrahedra(path, cells, place):
    """A Gmsh file of a box of cells, six tetrahedra in each, whose corners a function moves from the unit cube."""
    path.parent.mkdir(parents=True, exist_ok=True)
    nx, ny, nz = cells
    at = [(i, j, k) for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]
    tag = {corner: n + 1 for n, corner in enumerate(at)}
    tetrahedra = []
    for i, j, k in itertools.product(range(nx), range(ny), range(nz)):
        for order in itertools.permutations(range(3)):  # from the lower corner to the upper one
            corner, corners = [i, j, k], [tag[i, j, k]]
            for axis in order:
                corner[axis] += 1
                corners.append(tag[tuple(corner)])
            tetrahedra.append(corners)
    with open(path, "w") as out:
        out.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(at)}\n")
        for corner in at:
            x, y, z = place(*(c / n for c, n in zip(corner, cells)))
            out.write(f"{tag[corner]} {number(x):g} {number(y):g} {number(z):g}\n")
        out.write(f"$EndNodes\n$Elements\n{len(tetrahedra)}\n")
        out.writelines(f"{n + 1} 4 0 {a} {b} {c} {d}\n" for n, (a, b, c, d) in enumerate(tetrahedra))
        out.write("$EndElements\n")


def write_scene(path, comment, head, bodies, joints, output, attachments=()):
    """One body, joint or attachment a line."""
    lines = ["// " + line for line in comment] + ["{"]
    lines += [f'  "{key}": {json.dumps(value)},' for key, value in head.items()]
    for key, items in (("bodies", bodies), ("joints", joints), ("attachments", attachments)):
        if items:
            lines += [f'  "{key}": [', ",\n".join("    " + json.dumps(item) for item in items), "  ],"]
    lines += [f'  "output": {json.dumps(output)}', "}"]
    path.write_text("\n".join(lines) + "\n")


def house_of_cards(options):
    """Tents of two cards each, a flat card from ridge to ridge, and two balls that hit the house."""
    # With this gap the barriers just about carry the cards, so that the house is at rest from the start.
    length, width, thickness, gap = 0.088, 0.063, 1e-3, 1.25e-4
    lean = math.radians(options.lean)
    sine, cosine = math.sin(lean), math.cos(lean)
    spacing = 2 * (length * sine + thickness * cosine) + 2 * gap
    height = length * cosine + thickness * sine
    card = {"shape": "box", "density": 1000, "group": "cards"}
    bodies = [{"shape": "box", "kind": "fixed", "group": "table", "size": vector(1.4, 0.4, 0.02),
               "position": vector(0, 0, -0.01)}]
    floor = gap
    for level in range(options.levels):
        tents = options.levels - level
        for tent in range(tents):
            ridge = spacing * (tent - 0.5 * (tents - 1))
            for side in (-1, 1):
                bodies.append(card | {
                    "size": vector(thickness, width, length),
                    "position": vector(ridge + side * 0.5 * (length * sine + thickness * cosine + gap), 0,
                                       floor + 0.5 * height),
                    "rotation_deg": {"axis": [0, 1, 0], "angle": -side * options.lean}})
        floor += height + gap
        for flat in range(tents - 1):
            bodies.append(card | {"size": vector(spacing - gap, width, thickness),
                                  "position": vector(spacing * (flat - 0.5 * (tents - 2)), 0,
                                                     floor + 0.5 * thickness)})
        floor += thickness + gap
    for side, start in ((-1, 0.9), (1, 1.4)):
        bodies.append({"shape": "sphere", "radius": 0.03, "density": 1000, "group": "balls",
                       "position": vector(side * start, 0, 0.15), "velocity": vector(-side * 1.5, 0, 0.8)})
    head = {"$schema": "schema.json", "name": "house_of_cards", "precision": "double", "time_step": 0.01, "duration": 2.0,
            "materials": {"default": {"friction": 0.5}},
            "dynamics": {"type": "affine", "rule": "implicit_euler", "reach": 2e-4, "slip_speed": 1e-4, "friction_solves": 1,
                         "tolerance": 1e-3}}
    comment = [f"A house of cards of {options.levels} stories: {len(bodies) - 3} cards of 88 by 63 by 1 mm, and two balls that hit it.",
               "Written by scenes/generators/affine.py."]
    output = {"frame_interval": 0.02, "picture": {"interval": 0.1, "width": 960, "height": 720, "color_by": "id", "labels": False,
              "camera": {"position": [0.35, -1.9, 0.75], "target": [0, 0, 0.36], "vertical_angle_deg": 34}}}
    write_scene(options.file, comment, head, bodies, [], output)


def involute_tooth(module, teeth, pressure, addendum, dedendum, backlash, points):
    """Half a tooth about its axis: (radius, angle from the axis), from the root to the tip."""
    pitch = 0.5 * module * teeth
    base = pitch * math.cos(pressure)
    half = math.pi / (2 * teeth) - 0.5 * backlash / pitch

    def angle(radius):
        if radius <= base:
            return half + math.tan(pressure) - pressure
        t = math.sqrt((radius / base) ** 2 - 1)
        return half + (math.tan(pressure) - pressure) - (t - math.atan(t))

    tip, root = pitch + addendum * module, pitch - dedendum * module
    first = max(base, root)
    flank = [(root, angle(first))] if root < base else []
    return flank + [(r, angle(r)) for r in (first + (tip - first) * k / (points - 1) for k in range(points))]


def gear_mesh(half_tooth, teeth, phase, width):
    """A gear about the z axis: its outline in two planes, caps as fans about the axis."""
    outline = []
    for tooth in range(teeth):
        axis = 2 * math.pi * (tooth + phase) / teeth
        outline += [(r, axis - a) for r, a in half_tooth] + [(r, axis + a) for r, a in reversed(half_tooth)]
    n = len(outline)
    vertices = [(r * math.cos(a), r * math.sin(a), z) for z in (-0.5 * width, 0.5 * width) for r, a in outline]
    vertices += [(0, 0, -0.5 * width), (0, 0, 0.5 * width)]
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, n + j), (i, n + j, n + i), (2 * n, j, i), (2 * n + 1, n + i, n + j)]
    return vertices, triangles


def gears(options):
    """Gears of one size on a grid, each on an axle; the first is driven. Neighbors differ by half a tooth."""
    teeth, module, width = 16, 0.005, 0.01
    half_tooth = involute_tooth(module, teeth, math.radians(20), 0.9, 1.25, 4e-4, options.points)
    meshes = options.file.parent / "meshes"
    for name, phase in (("gear_a", 0), ("gear_b", 0.5)):
        write_mesh(meshes / f"{name}.obj", f"Involute gear: {teeth} teeth, module {module} m, pressure angle 20 degrees",
                   *gear_mesh(half_tooth, teeth, phase, width))
    distance = module * teeth
    bodies, joints = [], []
    for row in range(options.rows):
        for column in range(options.columns):
            center = vector(distance * (column - 0.5 * (options.columns - 1)), 0, distance * (row - 0.5 * (options.rows - 1)))
            name, mesh = f"g{row}_{column}", ("gear_a", "gear_b")[(row + column) % 2]
            body = {"name": name, "shape": "mesh", "file": f"meshes/{mesh}.obj", "position": center,
                    "rotation_deg": {"axis": [1, 0, 0], "angle": 90}}
            if row == column == 0:
                body |= {"kind": "kinematic", "group": "driver",
                         "motion": {"type": "rotating", "axis": [0, 1, 0], "center": center, "rate": 3.0}}
            else:
                body |= {"kind": "free", "density": 7800, "group": "gears"}
                joints.append({"type": "hinge", "bodies": ["world", name], "anchor": center, "axis": [0, 1, 0]})
            bodies.append(body)
    head = {"$schema": "schema.json", "name": "gears", "precision": "double", "time_step": 0.01, "duration": 3.0,
            "materials": {"default": {"friction": 0.1}},
            "dynamics": {"type": "affine", "stiffness": 1e9, "reach": 1e-4, "friction_solves": 1, "tolerance": 1e-3}}
    comment = [f"{len(bodies)} gears on axles that mesh with all their neighbors; the one at the lower left drives them.",
               "Written by scenes/generators/affine.py."]
    output = {"frame_interval": 0.02, "picture": {"interval": 0.1, "width": 960, "height": 640, "color_by": "id", "labels": False,
              "camera": {"position": [0.1, -0.9, 0.12], "target": [0, 0, 0], "vertical_angle_deg": 30}}}
    write_scene(options.file, comment, head, bodies, joints, output)


def torus(major, minor, around, across):
    vertices, triangles = [], []
    for i in range(around):
        u = 2 * math.pi * i / around
        for k in range(across):
            v = 2 * math.pi * k / across
            r = major + minor * math.cos(v)
            vertices.append((r * math.cos(u), r * math.sin(u), minor * math.sin(v)))
            a, b = i * across + k, i * across + (k + 1) % across
            c, d = (a + across) % (around * across), (b + across) % (around * across)
            triangles += [(a, c, d), (a, d, b)]
    return vertices, triangles


def chain_net(options):
    """Flat rings at the knots of a square grid without its corners, held at the rim; upright rings join those that have a
    neighbor, but along the rim: 3 n (n - 2) rings for n knots a side."""
    n, major, minor = options.knots, 0.01, 0.0018
    distance = 0.0308
    write_mesh(options.file.parent / "meshes/link.obj", "Ring of a chain net: radii 10 and 1.8 mm, 440 triangles",
               *torus(major, minor, 20, 11))
    ring = {"shape": "mesh", "file": "meshes/link.obj"}
    bodies = []
    place = lambda i: distance * (i - 0.5 * (n - 1))
    rim = (0, n - 1)
    for i in range(n):
        for j in range(n):
            if i in rim and j in rim:
                continue
            knot = ring | {"position": vector(place(i), place(j), 0)}
            if i in rim or j in rim:
                knot |= {"kind": "fixed", "group": "rim"}
            else:
                knot |= {"kind": "free", "density": 7800, "group": "net"}
            bodies.append(knot)
    upright = ring | {"kind": "free", "density": 7800, "group": "net"}
    for j in range(1, n - 1):
        for i in range(n - 1):
            bodies.append(upright | {"position": vector(place(i + 0.5), place(j), 0),
                                     "rotation_deg": {"axis": [1, 0, 0], "angle": 90}})
            bodies.append(upright | {"position": vector(place(j), place(i + 0.5), 0),
                                     "rotation_deg": {"axis": [0, 1, 0], "angle": 90}})
    rings = len(bodies)
    size = distance * n
    if options.ball:
        radius = 0.15 * size
        bodies.append({"shape": "sphere", "radius": number(radius), "density": 2000, "group": "ball",
                       "position": vector(0, 0, radius + 0.1 * size), "velocity": [0, 0, -1]})
    head = {"$schema": "schema.json", "name": options.file.stem, "precision": "double", "time_step": 0.01, "duration": 1.0,
            "materials": {"default": {"friction": 0.2}},
            "dynamics": {"type": "affine", "rule": "implicit_euler", "reach": 1e-4, "friction_solves": 1, "tolerance": 2e-3}}
    comment = [f"A net of {rings} rings, held at its rim" + (", catches a ball." if options.ball else "."),
               "Written by scenes/generators/affine.py."]
    output = {"frame_interval": 0.02, "picture": {"interval": 0.1, "width": 960, "height": 720, "color_by": "id", "labels": False,
              "camera": {"position": vector(0.5 * size, -1.7 * size, 0.9 * size), "target": vector(0, 0, -0.1 * size),
                         "vertical_angle_deg": 36}}}
    write_scene(options.file, comment, head, bodies, [], output)


def disc(radius, thickness):
    """Places of a box of cells on a disc about the axis y: squares become circles."""
    def place(u, v, w):
        x, z = 2 * u - 1, 2 * w - 1
        return (radius * x * math.sqrt(1 - z * z / 2), thickness * (v - 0.5), radius * z * math.sqrt(1 - x * x / 2))
    return place


def ships(options):
    """Two stiff ships with soft sails in a tank, and helicopters with soft rotors and wheels that fall on them."""
    folder = options.file.parent / "meshes"
    sail, rotor, wheel = (0.3, 0.012, 0.24), (0.56, 0.04, 0.01), (0.05, 0.04)
    box = lambda edges: lambda u, v, w: tuple(e * (c - 0.5) for e, c in zip(edges, (u, v, w)))
    write_tetrahedra(folder / "sail.msh", (10, 1, 8), box(sail))
    write_tetrahedra(folder / "rotor.msh", (16, 2, 1), box(rotor))
    write_tetrahedra(folder / "wheel.msh", (4, 2, 4), disc(*wheel))
    bodies = [{"shape": "container", "size": vector(1.8, 1.2, 2.4), "open": ["+z"], "group": "tank",
               "position": vector(0, 0, 1.2)}]
    attachments = []

    def attach(body, to, low, high):
        attachments.append({"body": body, "to": to, "box": [vector(*low), vector(*high)]})

    keel = [(-0.35, 0, 0.02), (0.35, 0, 0.02)]
    deck = [(-0.45, y, 0.16) for y in (-0.1, 0.1)] + [(0.3, y, 0.16) for y in (-0.13, 0.13)] + [(0.5, 0, 0.18)]
    for n, (x, y) in enumerate([(-0.05, -0.3), (0.05, 0.3)]):
        ship = f"ship_{n}"
        bodies.append({"name": ship, "shape": "compound", "density": 600, "group": "ships", "position": vector(x, y, 0),
                       "parts": [{"shape": "hull", "points": [vector(*p) for p in keel + deck]},
                                 {"shape": "box", "size": vector(0.03, 0.03, 0.44), "position": vector(0, 0, 0.36)},
                                 {"shape": "box", "size": vector(0.02, 0.34, 0.02), "position": vector(0, 0, 0.55)},
                                 {"shape": "box", "size": vector(0.02, 0.34, 0.02), "position": vector(0, 0, 0.27)}]})
        # The sail hangs before the mast, across the ship, from the upper yard to the lower one.
        name, ahead = f"sail_{n}", 0.03
        bodies.append({"name": name, "shape": "mesh", "file": "meshes/sail.msh", "kind": "free", "density": 300,
                       "group": "sails", "position": vector(x + ahead, y, 0.41),
                       "rotation_deg": {"axis": [0, 0, 1], "angle": 90},
                       "elastic": {"young_modulus": 2e5, "poisson_ratio": 0.3}})
        for edge in (0.41 - sail[2] / 2, 0.41 + sail[2] / 2):
            attach(name, ship, (x, y - 0.2, edge - 1e-3), (x + 0.1, y + 0.2, edge + 1e-3))
    for n in range(options.helicopters):
        craft, x, y, z = f"helicopter_{n}", 0.25 * (n % 3 - 1), 0.16 * (n % 2) - 0.08, 1.05 + 0.45 * n
        bodies.append({"name": craft, "shape": "compound", "density": 500, "group": "helicopters",
                       "position": vector(x, y, z),
                       "parts": [{"shape": "box", "size": vector(0.26, 0.14, 0.12)},
                                 {"shape": "box", "size": vector(0.26, 0.03, 0.04), "position": vector(0.24, 0, 0.03)},
                                 {"shape": "box", "size": vector(0.02, 0.02, 0.08), "position": vector(0, 0, 0.1)}]})
        name = f"rotor_{n}"
        top = z + 0.16
        bodies.append({"name": name, "shape": "mesh", "file": "meshes/rotor.msh", "kind": "free", "density": 1000,
                       "group": "rotors", "position": vector(x, y, top),
                       "elastic": {"young_modulus": 2e7, "poisson_ratio": 0.3}})
        attach(name, craft, (x - 0.04, y - 0.1, top - 0.01), (x + 0.04, y + 0.1, top + 0.01))
        for k, (dx, dy) in enumerate([(-0.09, -0.1), (-0.09, 0.1), (0.09, -0.1), (0.09, 0.1)]):
            name, low = f"wheel_{n}_{k}", z - 0.06
            bodies.append({"name": name, "shape": "mesh", "file": "meshes/wheel.msh", "kind": "free", "density": 1000,
                           "group": "wheels", "position": vector(x + dx, y + dy, low),
                           "elastic": {"young_modulus": 2e5, "poisson_ratio": 0.4}})
            attach(name, craft, (x + dx - 0.03, y + dy - 0.03, low - 0.03), (x + dx + 0.03, y + dy + 0.03, low + 0.03))
    head = {"$schema": "schema.json", "name": "ships", "precision": "double", "time_step": 0.01, "duration": 1.5,
            "materials": {"default": {"friction": 0.3}},
            "dynamics": {"type": "affine", "rule": "implicit_euler", "reach": 2e-3, "friction_solves": 1, "tolerance": 5e-3}}
    comment = [f"Two stiff ships with soft sails, and {options.helicopters} helicopters with soft rotors and wheels that fall on them.",
               "Written by scenes/generators/affine.py."]
    output = {"frame_interval": 0.02, "surface_frames": True,
              "picture": {"interval": 0.1, "width": 960, "height": 720, "color_by": "group", "labels": False,
                          "camera": {"position": vector(1.9, -2.6, 1.7), "target": vector(0, 0, 0.36), "up": vector(0, 0, 1),
                                     "vertical_angle_deg": 25}}}
    write_scene(options.file, comment, head, bodies, [], output, attachments)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    scenes = parser.add_subparsers(required=True, metavar="SCENE")
    for make in (house_of_cards, gears, chain_net, ships):
        command = scenes.add_parser(make.__name__, help=make.__doc__.splitlines()[0])
        command.set_defaults(make=make)
        command.add_argument("file", type=Path, help="scene file to write")
        if make is house_of_cards:
            command.add_argument("--levels", type=int, default=10)
            command.add_argument("--lean", type=float, default=20, help="of a card from upright [degrees]")
        elif make is gears:
            command.add_argument("--columns", type=int, default=7)
            command.add_argument("--rows", type=int, default=4)
            command.add_argument("--points", type=int, default=6, help="of half a tooth")
        elif make is ships:
            command.add_argument("--helicopters", type=int, default=3)
        else:
            command.add_argument("--knots", type=int, default=8, help="of a side")
            command.add_argument("--no-ball", dest="ball", action="store_false")
    options = parser.parse_args()
    options.make(options)


if __name__ == "__main__":
    main()
