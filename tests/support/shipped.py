"""The inputs that come with Kerf: those that run, those of `kerf drive`, and those of `kerf sweep`."""

from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
ALL = sorted((SOURCE / "inputs").glob("*/*.yaml"))
DRIVES = [path for path in ALL if "\npaths:" in path.read_text()]
INPUTS = [path for path in ALL if path not in DRIVES]
STUDIES = sorted((SOURCE / "inputs").glob("*/studies/*.yaml"))
