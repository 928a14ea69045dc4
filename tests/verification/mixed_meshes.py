"""Meshes of bricks, wedges, pyramids and tetrahedra that fit together, written as files of Gmsh.

A block of cubes is cut, cube by cube, into what `kind(i, j, k)` says: "brick", "wedges" (two, with the diagonal in the
plane of x and y), "pyramids" (six, with a node in the middle) or "tetrahedra" (the pyramids, each cut in two where the
neighbour is also cut or where there is none). The faces of neighbours match, except of wedges under other cubes than
wedges: whole columns along z have to be wedges.
"""

import numpy as np

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
# Faces of a cube seen from its middle: a pyramid's base, counter-clockwise as seen from the tip.
FACES = {(0, 0, -1): (0, 1, 2, 3), (0, 0, 1): (4, 7, 6, 5), (0, -1, 0): (0, 4, 5, 1), (1, 0, 0): (1, 5, 6, 2),
         (0, 1, 0): (2, 6, 7, 3), (-1, 0, 0): (3, 7, 4, 0)}
GMSH_TYPE = {8: 5, 6: 6, 5: 7, 4: 4}


class MixedBlock:
    """Nodes [in units of the file] and cells, each the list of its nodes in the order of Gmsh."""

    def __init__(self, cells, kind, edge=1.0, origin=(0.0, 0.0, 0.0), distortion=0.0, seed=1):
        nx, ny, nz = cells
        self.cells = []
        random = np.random.default_rng(seed)
        number = {}
        points = []

        def node(place):
            if place not in number:
                number[place] = len(points)
                inside = all(0 < p < n for p, n in zip(place, cells, strict=True))
                shift = random.uniform(-distortion, distortion, 3) if inside else np.zeros(3)
                points.append((np.array(place) + shift) * edge + origin)
            return number[place]

        for i in range(nx):
            for j in range(ny):
                for k in range(nz):
                    at = [node(tuple(int(p) for p in (i, j, k) + c)) for c in CORNERS]
                    self.cut(at, kind, (i, j, k), cells, node)
        self.points = np.array(points)

    def cut(self, at, kind, place, n, node):
        what = kind(*place)
        if what == "brick":
            self.cells.append(at)
            return
        if what == "wedges":
            self.cells.append([at[m] for m in (0, 1, 3, 4, 5, 7)])
            self.cells.append([at[m] for m in (1, 2, 3, 5, 6, 7)])
            return
        middle = node(tuple(p + 0.5 for p in place))
        for way, face in FACES.items():
            base = [at[m] for m in face]
            beyond = tuple(p + w for p, w in zip(place, way, strict=True))
            outside = any(not 0 <= b < m for b, m in zip(beyond, n, strict=True))
            if what == "pyramids" or not (outside or kind(*beyond) == "tetrahedra"):
                self.cells.append([*base, middle])
                continue
            first = base.index(min(base))  # the diagonal from the lowest node, seen from either side
            a, b, c, d = base[first:] + base[:first]
            self.cells.append([a, b, c, middle])
            self.cells.append([a, c, d, middle])

    def volumes(self):
        """By the divergence theorem, with plane triangles; bricks and wedges have to have plane faces."""
        def tetrahedron(a, b, c, d):
            x = self.points
            return np.dot(np.cross(x[b] - x[a], x[c] - x[a]), x[d] - x[a]) / 6.0

        found = []
        for c in self.cells:
            if len(c) == 4:
                found.append(tetrahedron(*c))
            elif len(c) == 5:
                found.append(tetrahedron(c[0], c[1], c[2], c[4]) + tetrahedron(c[0], c[2], c[3], c[4]))
            elif len(c) == 6:
                found.append(wedge_volume(c, tetrahedron))
            else:
                found.append(wedge_volume([c[m] for m in (0, 1, 3, 4, 5, 7)], tetrahedron) +
                             wedge_volume([c[m] for m in (1, 2, 3, 5, 6, 7)], tetrahedron))
        return np.array(found)


def wedge_volume(c, tetrahedron):
    return sum(tetrahedron(*c[k : k + 4]) for k in range(3))


def write_msh(path, blocks, faces=None):
    """Writes blocks, by name, to a file of Gmsh 2.2; `faces` are lists of three or four nodes, by name, of the only or
    the first block."""
    names = [*blocks, *(faces or {})]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{3 if name in blocks else 2} {n + 1} "{name}"' for n, name in enumerate(names)]
    points = np.concatenate([b.points for b in blocks.values()])
    lines += ["$EndPhysicalNames", "$Nodes", str(len(points))]
    lines += [f"{n + 1} {x:.17g} {y:.17g} {z:.17g}" for n, (x, y, z) in enumerate(points)]
    elements, first = [], 1
    for n, block in enumerate(blocks.values()):
        elements += [(GMSH_TYPE[len(c)], n + 1, [first + m for m in c]) for c in block.cells]
        first += len(block.points)
    for n, name in enumerate(faces or {}):
        elements += [({3: 2, 4: 3}[len(f)], len(blocks) + n + 1, [1 + m for m in f]) for f in faces[name]]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{n + 1} {kind} 2 {group} {group} {' '.join(map(str, nodes))}"
              for n, (kind, group, nodes) in enumerate(elements)]
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def all_kinds(i, j, k):
    """A column of wedges; bricks, pyramids and tetrahedra next to it and to each other."""
    if (i, j) == (1, 1):
        return "wedges"
    return ("brick", "pyramids", "tetrahedra")[(i + j + k) % 3]
