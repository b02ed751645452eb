#!/usr/bin/env python3
"""Draws step.svg and folders.svg beside this file, the two pictures of ARCHITECTURE.md."""
import pathlib
from html import escape

INK, SOFT, LINE = "#1f2933", "#52606d", "#7b8794"
FILL = {"host": "#e3eefb", "dynamics": "#fbe4e4", "collision": "#e2f4e6", "solvers": "#fdeeda", "kernels": "#f0e8f8", "data": "#f5f7fa"}


class Picture:
    def __init__(self, width, height):
        self.size = (width, height)
        self.parts = []

    def text(self, x, y, words, size=13, color=INK, weight="normal", anchor="start", family="sans-serif"):
        self.parts.append(f'<text x="{x}" y="{y}" font-size="{size}" fill="{color}" font-weight="{weight}" '
                          f'text-anchor="{anchor}" font-family="{family}">{escape(words)}</text>')

    def box(self, x, y, w, h, kind, title, lines=(), dashed=False):
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<rect x="{x}" y="{y}" width="{w}" height="{h}" rx="6" fill="{FILL[kind]}" '
                          f'stroke="{LINE}" stroke-width="1.2"{dash}/>')
        self.text(x + 12, y + 21, title, 14, weight="bold")
        for k, line in enumerate(lines):
            self.text(x + 12, y + 40 + 17 * k, line, 12, SOFT)

    def arrow(self, *points, dashed=False):
        path = " ".join(f"{x},{y}" for x, y in points)
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<polyline points="{path}" fill="none" stroke="{INK}" stroke-width="1.4"{dash}/>')
        (x0, y0), (x, y) = points[-2:]
        length = max(abs(x - x0), abs(y - y0))
        ux, uy = (x - x0) / length, (y - y0) / length
        left = (x - 9 * ux - 4.5 * uy, y - 9 * uy + 4.5 * ux)
        right = (x - 9 * ux + 4.5 * uy, y - 9 * uy - 4.5 * ux)
        self.parts.append(f'<polygon points="{x},{y} {left[0]},{left[1]} {right[0]},{right[1]}" fill="{INK}"/>')

    def write(self, name, title):
        width, height = self.size
        body = "\n".join(self.parts)
        pathlib.Path(__file__).with_name(name).write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}">\n<title>{escape(title)}</title>\n'
            f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n{body}\n</svg>\n')


def draw_step():
    p = Picture(950, 640)
    p.box(20, 20, 270, 74, "data", "scene file", ["host/scene_reader makes a Scene,", "validate() checks it"])
    p.box(335, 20, 270, 74, "host", "World", ["host/world.h: backend and precision", "are chosen at run time"])
    p.box(650, 20, 270, 74, "dynamics", "Dynamics", ["dynamics/rigid: compiled for each", "backend and precision; one step:"])
    p.arrow((290, 57), (335, 57))
    p.arrow((605, 57), (650, 57))
    rows = [
        ("dynamics", "insert and move", ["bodies that join, prescribed motion;", "sorted in Morton order every 64 steps"]),
        ("collision", "detect", ["near pairs, a list kept for some steps;", "then contacts, sorted by their keys"]),
        ("collision", "match", ["impulses of the last step by key:", "the guess of the solver"]),
        ("dynamics", "impacts", ["only with restitution by Poisson's law:", "rounds of compression and release"]),
        ("dynamics", "assemble", ["ContactProblem: v*, bias, cones, inertia,", "lists of contacts of each body"]),
        ("solvers", "solve", ["impulses gamma, velocities V, residual;", "stops at the tolerance"]),
        ("dynamics", "integrate", ["new velocities, positions, orientations;", "kinetic energy, bodies out of range"]),
        ("collision", "keep", ["keys and impulses, for the next step", "and for checkpoints"]),
    ]
    p.arrow((785, 94), (785, 112), (165, 112), (165, 130))
    place = [(20, 130), (335, 130), (650, 130), (650, 250), (335, 250), (20, 250), (20, 370), (335, 370)]
    for (x, y), (kind, title, lines) in zip(place, rows):
        p.box(x, y, 270, 80, kind, f"{place.index((x, y)) + 1}  {title}", lines, dashed=title == "impacts")
    for (x, y), (u, v) in zip(place, place[1:]):
        if y == v:
            p.arrow((x + 270, y + 40), (u, v + 40)) if u > x else p.arrow((x, y + 40), (u + 270, v + 40))
        else:
            p.arrow((x + 135, y + 80), (u + 135, v))
    p.box(650, 370, 270, 80, "data", "StepReport", ["contacts, iterations, residual, overlap,", "energy, time of each stage"])
    p.arrow((605, 410), (650, 410))
    p.arrow((470, 450), (470, 475), (8, 475), (8, 170), (20, 170), dashed=True)
    p.text(20, 494, "the next step", 12, SOFT)
    p.box(335, 510, 585, 60, "host", "host/io and host/render; files are written on a thread of their own",
          ["steps.csv, frames.vtkhdf, walls, pictures, checkpoint.h5, problem_N.hdf5, run.json"])
    p.arrow((785, 450), (785, 510))
    for k, (kind, words) in enumerate([("host", "host/"), ("dynamics", "dynamics/"), ("collision", "collision/"),
                                       ("solvers", "solvers/"), ("data", "data")]):
        p.parts.append(f'<rect x="{20 + 106 * k}" y="596" width="16" height="16" rx="3" fill="{FILL[kind]}" '
                       f'stroke="{LINE}"/>')
        p.text(42 + 106 * k, 609, words, 12, SOFT)
    p.text(550, 609, "Every stage runs element programs of kernels/ on the backend B.", 12, SOFT)
    p.write("step.svg", "The stages of one time step")


def draw_folders():
    p = Picture(940, 810)
    p.box(20, 20, 900, 62, "data", "tests/   bench/   host/cli/", ["may include anything, and nobody includes them; "
                                                                 "tests/reference/ nothing of kernels/"])
    p.box(20, 112, 900, 218, "host", "host/", [])
    p.text(85, 133, "public headers (world.h, scene.h, scene_reader.h, ...) beside the folders; no CUDA in them", 12, SOFT)
    small = [
        (40, 150, "engine", "World, devices"), (188, 150, "solve", "solvers compared"),
        (336, 150, "io", "HDF5, VTKHDF, CSV"), (484, 150, "scene", "checks, motion"),
        (632, 150, "layouts", "places of particles"), (780, 150, "ranks", "MPI, threads"),
        (40, 238, "render", "pictures"), (188, 238, "problems", "stored problems"),
        (336, 238, "plot", "charts of solve"), (484, 238, "scene_reader", "JSON to Scene"),
        (632, 238, "variational", "impacts as unknowns"),
    ]
    for x, y, name, words in small:
        p.parts.append(f'<rect x="{x}" y="{y}" width="138" height="62" rx="5" fill="#ffffff" stroke="{LINE}"/>')
        p.text(x + 10, y + 24, name, 13, weight="bold")
        p.text(x + 10, y + 45, words, 12, SOFT)
    p.text(40, 320, "engine includes scene, problems; solve includes problems, io, plot; ranks io; plot, render, problems, "
           "layouts and variational include none.", 12, SOFT)
    p.arrow((470, 82), (470, 112))
    p.box(20, 370, 900, 84, "dynamics", "dynamics/", [])
    p.text(115, 391, "the interface of models, and a folder a model with what each includes; affine, in the making, includes nothing of host/", 12, SOFT)
    for x, name, words, indent in ((40, "dynamics.h", "public headers of host/", 90),
                                   (330, "rigid, ranks", "host/: render, scene, problems", 92),
                                   (630, "variational", "scene of host/, and rigid", 88)):
        p.parts.append(f'<rect x="{x}" y="400" width="270" height="44" rx="5" fill="#ffffff" stroke="{LINE}"/>')
        p.text(x + 10, 427, name, 13, weight="bold")
        p.text(x + 10 + indent, 427, words, 12, SOFT)
    p.arrow((330, 422), (310, 422))
    p.arrow((630, 422), (600, 422))
    p.arrow((420, 330), (420, 400))
    p.text(40, 354, "engine, io, scene, scene_reader include the interface", 12, SOFT)
    p.box(20, 494, 420, 78, "collision", "collision/", ["near pairs, contacts, margins of impacts, contacts kept",
                                                        "between steps; models of dynamics/ alone include it"])
    p.box(500, 494, 420, 78, "solvers", "solvers/", ["one header a step solver, and the residual; assembled/:",
                                                     "solvers of stored problems, which include no step solver"])
    p.arrow((230, 454), (230, 494))
    p.arrow((710, 454), (710, 494))
    p.arrow((930, 221), (930, 533), (920, 533))
    p.parts.append(f'<polyline points="920,221 930,221" fill="none" stroke="{INK}" stroke-width="1.4"/>')
    p.box(20, 608, 900, 182, "kernels", "kernels/", [])
    p.text(100, 629, "element programs, and the only code written twice: kernels/backend", 12, SOFT)
    p.arrow((230, 572), (230, 608))
    p.arrow((710, 572), (710, 608))
    chain = ["math", "backend", "bodies", "contact", "broad_phase", "narrow_phase", "step"]
    for k, name in enumerate(chain):
        x = 40 + 124 * k
        p.parts.append(f'<rect x="{x}" y="646" width="104" height="36" rx="5" fill="#ffffff" stroke="{LINE}"/>')
        p.text(x + 52, 669, name, 12, weight="bold", anchor="middle")
        if k:
            p.arrow((x, 664), (x - 20, 664))
    for name, x, onto in (("affine", 40, 40), ("render", 288, 288), ("solve", 412, 412)):
        p.parts.append(f'<rect x="{x}" y="710" width="104" height="36" rx="5" fill="#ffffff" stroke="{LINE}"/>')
        p.text(x + 52, 733, name, 12, weight="bold", anchor="middle")
        p.arrow((onto + 52, 710), (onto + 52, 682))
    p.box(560, 702, 340, 50, "data", "shapes/", ["one file a shape; includes math; host/, render, affine include it"])
    p.arrow((712, 682), (712, 702))
    p.text(40, 774, "An arrow means: may include that folder and all that it may include. Tuned CUDA twins (.cuh) lie beside "
           "their programs.", 12, SOFT)
    p.write("folders.svg", "Folders and what they may include")


draw_step()
draw_folders()
