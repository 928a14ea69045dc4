"""Writes doc/plugin-authors/kinds/KIND.md: for every kind of plugin the smallest real example of the tests, whole, with
its lines counted.

    python3 doc/plugin-authors/write_kinds.py

tests/python/test_kind_pages.py holds the pages to the sources.
"""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = Path(__file__).with_name("kinds")
# kind: example, base class, what the kind decides, how an input names it, section of writing_a_plugin.md
KINDS = {
    "material": ("out_of_tree/swift_material.cpp", "PointwiseMaterial<Law>",
                 "The deviator of the stress, beside an equation of state: strength of metals, viscosity of fluids.",
                 "strength: {type: swift, shear_modulus: 80 GPa, strength_coefficient: 900 MPa, initial_strain: 0.01,\n"
                 "           hardening_exponent: 0.2}", "a-material"),
    "eos": ("kinds/tait.cpp", "PointwiseEos<Law>",
            "The pressure and the adiabatic bulk modulus, from density and energy.",
            "eos: {type: tait, B: 300 MPa, n: 7.15}", "an-equation-of-state"),
    "solid": ("kinds/granular.cpp", "PointwiseSolid<Law>",
              "The whole stress, in place of a material and an equation of state: soils, concrete, ceramics.",
              "solid: {type: granular, shear_modulus: 1 GPa, bulk_modulus: 2 GPa, friction: 1}", "a-solid"),
    "erosion": ("kinds/distortion_energy.cpp", "PointwiseErosion<Law>",
                "When an element has failed, and what is left of its stress before.",
                "erosion: {criteria: [{type: distortion_energy, shear_modulus: 80 GPa, limit: 1 MJ/m3}]}",
                "an-erosion-criterion"),
    "contact": ("kinds/closest_point.cpp", "Contact",
                "Which nodes and facets touch, and how they slide; the engine makes impacts of it.",
                "contacts:\n  - {type: closest_point, slave: [rod], master: [plate], friction: 0.1}", "a-contact-law"),
    "boundary": ("kinds/turning_plane.cpp", "Boundary, or NamedNodesBoundary",
                 "What the velocity of a node becomes: planes, walls, motions.",
                 "boundaries:\n  - {type: turning_plane, nodes: [drop], point: 4 0 0 mm, normal: [0, 0, 1],\n"
                 "     axis: [0, 1, 0], rate: -2e4 rad/s}", "a-boundary-condition"),
    "load": ("kinds/drag.cpp", "FacetLoad, NodalLoad or BodyLoad",
             "Forces on facets, on nodes, or on masses.",
             "loads:\n  - {type: drag, facets: [rod], density: 1.2 kg/m3}", "a-load"),
    "mesh": ("kinds/tapered_rod.cpp", "MeshGenerator",
             "Nodes, elements and faces of a body, each computed from its number.",
             "mesh: {type: tapered_rod, radius: 1 mm, end_radius: 2 mm, length: 10 mm, cell_size: 0.5 mm, ratio: 1.5}",
             "a-mesh-generator"),
    "measure": ("kinds/tilt.cpp", "Measure", "A number about the final state, in `summary.json`.",
                "measures:\n  tilt: {type: tilt, part: rod, direction: [0, 0, 1]}", "a-measure"),
    "observer": ("out_of_tree/spring_to_point.cpp", "Observer",
                 "What watches the loop from inside, fills columns over time, and may add forces.",
                 "observers:\n  spring: {type: spring_to_point, part: bar, stiffness: 4e10 N/(kg m)}", "an-observer"),
    "partitioner": ("kinds/slices.cpp", "Partitioner", "Which rank owns which element.",
                    "balance: {partitioner: {type: slices, direction: [1, 0, 0]}}", "a-partitioner"),
    "balance_policy": ("kinds/patient.cpp", "BalancePolicy", "When the mesh is re-balanced.",
                       "balance: {policy: {type: patient, threshold: 1.1}}", "a-balance-policy"),
    "element": ("wedge/wedge.cpp", "Element, with SolidKernel<...>",
                "Strains, forces and the stable step of a shape of element. The file holds a mesh of it, too.",
                "element: {type: wedge}", None),
}


def lines_of(text):
    """All lines, and those that are neither blank nor only a comment."""
    lines = text.splitlines()
    code = [line for line in lines if line.strip() and not line.strip().startswith("//")]
    return len(lines), len(code)


def name_of(text, kind):
    found = re.search(rf'KERF_TYPE\(\w+, "{kind}", "(\w+)"|^KERF_{kind.upper()}\(\w+, "(\w+)"', text, re.M)
    return found.group(1) or found.group(2)


def page(kind):
    source, base, decides, example, section = KINDS[kind]
    text = (ROOT / "tests" / "plugin" / source).read_text(encoding="utf-8")
    whole, code = lines_of(text)
    more = f"[writing a plugin](../writing_a_plugin.md#{section})" if section else \
        "[writing an element](../writing_an_element.md)"
    return f"""# The smallest real plugin of the kind {kind}

{decides} It derives from `{base}`. More: {more}. A folder with tests to start from: `kerf new-plugin {kind} NAME`, \
see [starting a plugin](../starting_a_plugin.md).

An input says

```yaml
{example}
```

`tests/plugin/{source}` is the whole plugin `{name_of(text, kind)}`: {whole} lines, {code} of them code. The tests \
build it outside of the tree and run it on several ranks.

```cpp
{text.rstrip()}
```
"""


def overview():
    rows = []
    for kind, (source, base, decides, _, _) in KINDS.items():
        text = (ROOT / "tests" / "plugin" / source).read_text(encoding="utf-8")
        whole, code = lines_of(text)
        rows.append(f"| [{kind}]({kind}.md) | {decides} | `{name_of(text, kind)}` | {whole} | {code} |")
    return """# The smallest real plugin of every kind

Written by `doc/plugin-authors/write_kinds.py` from the plugins that the tests build and run.

| kind | what it decides | example | lines | of code |
|---|---|---|---|---|
""" + "\n".join(rows) + "\n"


def pages():
    return {"README.md": overview()} | {f"{kind}.md": page(kind) for kind in KINDS}


if __name__ == "__main__":
    PAGES.mkdir(exist_ok=True)
    for name, text in pages().items():
        (PAGES / name).write_text(text, encoding="utf-8")
