"""Registers the entry points of a project without installing it."""

import tomllib
from pathlib import Path


def register(
    project: Path,  # its folder
    site: Path,  # a folder for its metadata, which must stand on the path of a process
) -> None:
    """Write the metadata that pip would write."""
    about = tomllib.loads((project / "pyproject.toml").read_text())["project"]
    info = site / f"{about['name'].replace('-', '_')}-{about['version']}.dist-info"
    info.mkdir(parents=True)
    names = {"Metadata-Version": "2.1", "Name": about["name"], "Version": about["version"]}
    (info / "METADATA").write_text("".join(f"{key}: {value}\n" for key, value in names.items()))
    lines: list[str] = []
    for group, entries in about["entry-points"].items():
        lines += [f"[{group}]", *(f"{name} = {value}" for name, value in entries.items())]
    (info / "entry_points.txt").write_text("\n".join(lines))
