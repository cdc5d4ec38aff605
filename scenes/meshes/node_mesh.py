"""Nodes and tetrahedra of the meshes that make_meshes.py and profiling/error_bars make."""


class NodeMesh:
    """Tetrahedra between nodes with keys, and groups of faces by name. Nodes with the same key are one."""

    def __init__(self):
        self.nodes, self.tetrahedra, self.groups, self.number = [], [], {}, {}

    def node(self, key, point):
        """Number of the node with a key. The first call adds the node."""
        if key not in self.number:
            self.number[key] = len(self.nodes)
            self.nodes.append(point)
        return self.number[key]

    def volume(self, t):
        """Six times the volume of a tetrahedron, negative if it is inverted."""
        a, b, c, d = (self.nodes[n] for n in t)
        u, v, w = ([q - r for q, r in zip(p, a)] for p in (b, c, d))
        return sum(u[i] * (v[(i + 1) % 3] * w[(i + 2) % 3] - v[(i + 2) % 3] * w[(i + 1) % 3]) for i in range(3))
