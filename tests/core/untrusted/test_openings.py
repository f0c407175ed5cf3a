"""Source code opens files that others may have written in one way only."""

import ast
from functools import cache
from pathlib import Path

import latentarm
import latentarm_research

SOURCES = (Path(latentarm.__file__).parent, Path(latentarm_research.__file__).parent)

OPENS = {"open", "read_text", "read_bytes"}
"""Methods and functions that open a file."""

PARSES = {
    "json.load",
    "json.loads",
    "np.load",
    "np.loadtxt",
    "np.genfromtxt",
    "np.fromfile",
    "pickle.load",
    "pickle.loads",
    "yaml.load",
    "Xml.parse",
    "Xml.fromstring",
}
"""Parsers without bounds of their own."""

CHECKED = {
    "h5py.File",
    "rosbag1.Reader",
    "rosbag2.Reader",
    "safe_open",
    "sqlite3.connect",
    "create_engine",
    "mujoco.MjSpec.from_file",
    "pq.ParquetFile",
    "zipfile.ZipFile",
}
"""Libraries that open a path themselves: only in modules that import `untrusted.opening`."""

NAMES = OPENS | {name.rsplit(".", 1)[-1] for name in PARSES | CHECKED}

ALLOWED = {
    "core/untrusted/opening.py": {"os.open"},
    "core/untrusted/documents.py": {"json.loads"},
    "core/untrusted/memory.py": {"_STATUS.read_text"},
    "core/files.py": {"os.open", "part.open"},  # what it writes itself
    "core/call_log.py": {"path.open"},  # the same
    "recordings/mcap_export.py": {"part.open"},  # the same
    "core/machine.py": {"file.read_text"},  # the kernel's
    "surroundings/process.py": {"json.loads"},  # short messages of our own process
    "web/arm_process/replay.py": {"packed.open", "path.open"},  # a member of a report within bounds; its copy
    "web/arm_process/incident.py": {"path.open"},  # copies, in a folder of its own
    "cli.py": {"os.open"},  # the null device
    "demonstrations/importers/npz_file.py": {"archive.open"},  # a member of an archive opened within bounds
    "web/records/person_zip.py": {"archive.open"},  # the same
    "research/studies/results_folder.py": {
        "json.loads",  # what it has just written
        "path.read_bytes",  # part of the packages
    },
    "research/measurements/tags.py": {"av.open"},  # what it writes itself
    "web/server/assets.py": {"path.read_bytes"},  # part of the package
    "web/words/catalogue.py": {"file.read_text", "json.loads"},  # part of the package
    "research/people/calibration.py": {
        "(files('latentarm_research.people') / 'calibration.json').read_text",
        "json.loads",
    },  # part of the package
    "research/user_studies/definition.py": {"json.loads"},  # what it has just written
    "research/studies/page.py": {"(env['folder'] / str(image.attrs['src'])).read_bytes"},  # its own figures
    "research/measurements/ring_movements.py": {"json.loads", "np.loadtxt"},  # text read within bounds
    "research/measurements/bare_chromium.py": {"file.read_text", "json.loads"},  # what our own browser says
    "research/measurements/page_latency.py": {"chromium.open"},  # the same
    "research/measurements/page_stops.py": {
        "(out / 'said').open",
        "(out / 'said').read_text",
        "chromium.open",
    },  # what our own server says
    "research/measurements/study_load.py": {
        "(out / 'links.csv').read_text",
        "json.loads",
        "said.open",
        "said.read_text",
    },  # the same
    "arms/franka/link.py": {"_REALTIME_FILE.read_text"},  # the kernel's
    "arms/helper_process.py": {"json.loads"},  # what our own process says
    "arms/lerobot/keeper.py": {"self._bus.open"},  # a serial port
    "cameras/decoding.py": {"av.open"},  # named on the command line; in a process of its own
    "web/cameras/process.py": {"json.loads"},  # what our own process says
    "models/checkpoint.py": {"json.loads"},  # after the bound on the whole file; it holds infinities
}
"""What is left, and why; whatever else is found below belongs here with a reason, or goes another way."""


IN_MEMORY = {"web/records/person_zip.py"}
"""Modules that give such a library bytes within bounds, and paths only to write."""


MODULES = [module for source in SOURCES for module in source.rglob("*.py")]


def _place(module: Path) -> str:
    core, research = SOURCES
    if module.is_relative_to(core):
        return module.relative_to(core).as_posix()
    return f"research/{module.relative_to(research).as_posix()}"


@cache
def calls(module: Path) -> set[str]:
    tree = ast.parse(module.read_text(encoding="utf-8"))
    functions = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return {ast.unparse(function) for function in functions if _name(function) in NAMES}


def _name(function: ast.expr) -> str | None:
    """The last part of what is called: all that is needed to pass most calls over."""
    return getattr(function, "attr", getattr(function, "id", None))


def opens_unbounded(call: str) -> bool:
    return call in PARSES or call == "open" or ("." in call and call.rsplit(".", 1)[1] in OPENS)


def test_no_module_opens_untrusted_files_another_way() -> None:
    found = {(_place(module), call) for module in MODULES for call in calls(module) if opens_unbounded(call)}
    allowed = {(module, call) for module, some in ALLOWED.items() for call in some}
    assert found - allowed == set(), "use opening and documents of latentarm.core.untrusted"
    assert allowed - found == set(), "no longer needed"


def test_libraries_that_open_paths_are_given_checked_ones() -> None:
    unchecked = {
        _place(module)
        for module in MODULES
        if calls(module) & CHECKED and "latentarm.core.untrusted." not in module.read_text(encoding="utf-8")
    }
    assert unchecked == IN_MEMORY
