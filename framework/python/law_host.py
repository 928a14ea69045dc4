"""Runs the laws of one Python file for Kerf, which speaks over the socket with the number 3.

A request is two 64-bit numbers, the length of a JSON text and a count of doubles, then both; an answer is a status (0
for success) and a length, then so many bytes: JSON, a number, doubles, or what went wrong.
"""

import ctypes
import json
import os
import re
import signal
import socket
import struct
import sys
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
INPUTS = {"length": (1, 1), "initial_length": (2, 1), "reference_position": (4, 3), "rotation": (8, 9)}
LANES = 8  # points of a block, as the first request tells


class Trouble(Exception):
    """What is wrong, in a sentence."""


class Bag:
    """The named numbers of a point. Once it is `closed`, other names cannot be set: a slip must not be lost."""

    def __init__(self, **values):
        self.__dict__.update(values)

    def close(self, what):
        self.__dict__["_what"] = what

    def __setattr__(self, name, value):
        if "_what" in self.__dict__ and name not in self.__dict__:
            raise AttributeError(f"{self._what} has no {name}; it has "
                                 + ", ".join(key for key in self.__dict__ if key != "_what"))
        self.__dict__[name] = value


def snake_case(name):
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def declared(law):
    """What a class declares, by role, in the order of writing."""
    from kerf_laws import _Declared

    found = {}
    for base in reversed(law.__mro__):
        found |= {name: d for name, d in vars(base).items() if isinstance(d, _Declared)}
    ordered = sorted(found.items(), key=lambda item: item[1].order)
    return {role: [(name, d.what) for name, d in ordered if d.what["role"] == role]
            for role in ("parameter", "state", "reads")}


def function_of(law):
    name = {"material": "update", "solid": "update", "eos": "evaluate", "erosion": "judge"}[law.kind]
    if not callable(getattr(law, name, None)):
        raise Trouble(f"the class {law.__name__} has no function {name}(self, p); expected one")
    return name


def describe(law):
    parts = declared(law)
    function_of(law)
    summary = next((line.strip() for line in (law.__doc__ or "").splitlines() if line.strip()), "")
    if not summary:
        raise Trouble(f"the class {law.__name__} says nothing of itself; expected a sentence under its first line")
    for name in law.inputs:
        if name not in INPUTS:
            raise Trouble(f"the class {law.__name__} asks for \"{name}\"; expected some of {', '.join(INPUTS)}")
    variables = []
    for name, what in parts["state"]:
        if what["tensor"]:
            if law.kind == "eos":
                raise Trouble(f"the class {law.__name__} keeps the tensor {name}, which nobody turns for an equation "
                              "of state; expected numbers")
            variables += [{"name": f"{name}_{c}", "unit": what["unit"], "doc": what["doc"], "initial": 0.0,
                           "begins_tensor": c == "xx"} for c in ("xx", "yy", "zz", "xy", "yz", "zx")]
        else:
            variables.append({"name": name, "unit": what["unit"], "doc": what["doc"], "initial": what["initial"],
                              "begins_tensor": False})
    return {"kind": law.kind, "name": law.name or snake_case(law.__name__), "class": law.__name__, "summary": summary,
            "parameters": [{"name": name} | what for name, what in parts["parameter"]], "state": variables,
            "reads": [{"name": name} | what for name, what in parts["reads"]],
            "inputs": sum(INPUTS[name][0] for name in law.inputs),
            "uses_energy": getattr(law, "uses_energy", True), "softens": getattr(law, "softens", False)}


def laws_of(path):
    """The classes of a file that are laws, in the order of writing."""
    from kerf_laws import Law

    names = {"__name__": "kerf_prototype", "__file__": str(path)}
    sys.path.insert(1, str(Path(path).resolve().parent))
    exec(compile(Path(path).read_text(), str(path), "exec"), names)
    found = [value for value in names.values()
             if isinstance(value, type) and issubclass(value, Law) and value.__module__ == "kerf_prototype"]
    if not found:
        raise Trouble("the file has no law; expected a class that derives from Material, Solid, Eos or Erosion of "
                      "kerf_laws")
    return found


class Point:
    """One law object: how its numbers come and go."""

    def __init__(self, law, parameters):
        self.law, self.object, self.parts = law, law(), declared(law)
        for name, value in parameters.items():
            setattr(self.object, name, value)
        self.function = getattr(self.object, function_of(law))

    def compute(self, numbers):
        import numpy as np

        place = 2

        def rows(n):
            nonlocal place
            block = numbers[place:place + n * LANES].reshape(n, LANES).copy()
            place += n * LANES
            return block[0] if n == 1 else block

        p, kind = Bag(dt=numbers[0], time=numbers[1]), self.law.kind
        if kind != "erosion":
            p.reference_density = numbers[2]
            place = 3
        names = {"material": ("strain_increment", "density", "specific_energy", "pressure", "deviator"),
                 "solid": ("strain_increment", "density", "specific_energy", "stress"),
                 "eos": ("density", "specific_energy"),
                 "erosion": ("stress", "strain_increment", "rotation", "pressure", "density_ratio", "volume_ratio",
                             "time_step")}[kind]
        sizes = {"strain_increment": 6, "deviator": 6, "stress": 6, "rotation": 9}
        for name in names:
            setattr(p, name, rows(sizes.get(name, 1)))
        for name in INPUTS:
            if name in self.law.inputs:
                setattr(p, name, rows(INPUTS[name][1]))
        p.state = Bag(**{name: rows(6 if what["tensor"] else 1) for name, what in self.parts["state"]})
        p.reads = Bag(**{name: rows(1) for name, _ in self.parts["reads"]})
        p.state.close("p.state")
        p.close("p")
        with np.errstate(all="ignore"):
            returned = self.function(p)
        returned = returned if isinstance(returned, tuple) else (returned,)
        softens = getattr(self.law, "softens", False)
        expected = {"material": 1, "solid": 2, "eos": 2, "erosion": 5 if softens else 2}[kind]
        if len(returned) != expected or any(value is None for value in returned):
            raise Trouble(f"{self.law.__name__}.{function_of(self.law)} returns {len(returned)} values; expected "
                          f"{expected}")
        out = []

        def put(value, n):
            try:
                out.append(np.broadcast_to(np.asarray(value, dtype=float), (n, LANES) if n > 1 else (LANES,)).ravel())
            except ValueError as failure:
                raise Trouble(f"{self.law.__name__}: {failure}; expected arrays over {LANES} points") from failure

        if kind in ("material", "solid"):
            put(p.deviator if kind == "material" else p.stress, 6)
        for value in returned:
            put(value, 1)
        for name, what in self.parts["state"]:
            put(getattr(p.state, name), 6 if what["tensor"] else 1)
        return np.concatenate(out)


def last_place(path):
    """"file:line: Error: text" of the exception that is being handled, at its last line in the file of the laws."""
    kind, value, trace = sys.exc_info()
    line = next((f.lineno for f in reversed(traceback.extract_tb(trace)) if f.filename == str(path)), None)
    if isinstance(value, SyntaxError) and value.filename == str(path):
        line = value.lineno
    if isinstance(value, Trouble):
        return str(value)
    place = f"{path}:{line}: " if line else ""
    return f"{place}{kind.__name__}: {value}"


def serve(path, channel):
    def receive(n):
        data = bytearray()
        while len(data) < n:
            more = channel.recv(n - len(data))
            if not more:
                sys.exit(0)
            data += more
        return bytes(data)

    laws, objects = [], []
    global LANES
    while True:
        text_size, count = struct.unpack("=QQ", receive(16))
        head, raw = json.loads(receive(text_size)), receive(8 * count)
        try:
            if head["do"] == "describe":
                import numpy  # noqa: F401  its absence is told here

                LANES = head["lanes"]
                laws = laws_of(path)
                answer = json.dumps([describe(law) for law in laws]).encode()
            elif head["do"] == "make":
                objects.append(Point(laws[head["law"]], head["parameters"]))
                answer = str(len(objects) - 1).encode()
            else:
                import numpy as np

                answer = objects[head["object"]].compute(np.frombuffer(raw)).tobytes()
            status = 0
        except BaseException:  # a law that calls sys.exit() is wrong, too
            status, answer = 1, last_place(path).encode()
        channel.sendall(struct.pack("=QQ", status, len(answer)) + answer)


if __name__ == "__main__":
    # Signals are for the program: it ends this process by closing the socket, and takes it along when it dies.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    os.dup2(2, 1)  # what a law prints must not mix with the output of the program
    serve(sys.argv[1], socket.socket(fileno=3))
