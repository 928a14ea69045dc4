"""Says which Python packages are here and whether pictures can be drawn; part of `./kerf doctor`. Exit code 0 or 1."""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))


def main() -> int:
    requirements = (Path(__file__).parent / "requirements.txt").read_text().splitlines()
    names = [line.split("==")[0].strip() for line in requirements if line and not line.startswith("#")]
    found, missing = [], []
    for name in names:
        try:
            found.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            missing.append(name)
    print(f"Python    {sys.version.split()[0]}; {', '.join(found)}")
    if missing:
        print(f"          MISSING: {', '.join(missing)}; ./kerf build installs them unless KERF_PYTHON is set")
        return 1
    import scene

    window = scene.choose_window()
    if window is None:
        print("pictures  CANNOT be drawn without a screen: install libegl1 libgl1-mesa-dri libosmesa6")
        return 1
    print(f"pictures  can be drawn off-screen ({window})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
