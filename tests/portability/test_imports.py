"""Nothing that only POSIX systems have is needed to import the package."""

import subprocess
import sys

CODE = """
import importlib, pkgutil, sys
import latentarm

def import_all():
    for found in pkgutil.walk_packages(latentarm.__path__, "latentarm."):
        if not found.name.endswith("__main__"):
            importlib.import_module(found.name)

import_all()  # what others wrote is loaded as this system needs it
for name in [name for name in sys.modules if name.split(".")[0] == "latentarm"]:
    del sys.modules[name]
for name in ("fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty"):
    sys.modules[name] = None
import os, signal, socket, time
for module, names in (
    (os, ["fork", "getuid", "getpgid", "killpg", "nice", "sched_setscheduler", "setpriority", "O_DIRECTORY"]),
    (signal, ["SIGKILL", "SIGUSR1", "SIGALRM", "SIGHUP", "setitimer"]),
    (socket, ["AF_UNIX", "SO_REUSEPORT"]),
    (time, ["CLOCK_BOOTTIME", "CLOCK_MONOTONIC", "clock_gettime", "clock_gettime_ns"]),
):
    for name in names:
        if hasattr(module, name):
            delattr(module, name)
sys.platform = "win32"
import latentarm
import_all()
print(len([name for name in sys.modules if name.split(".")[0] == "latentarm"]))
"""


def test_every_module_is_imported_without_what_windows_lacks():
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 300
