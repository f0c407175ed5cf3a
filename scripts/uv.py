"""Run uv with the package indexes and options that pip is configured with.

uv does not read pip's configuration files or ``PIP_*`` variables, so a machine with a mirror or with wheels
on its disk would install from elsewhere. ``python scripts/uv.py pip install ...`` takes them over. A ``UV_*``
variable that is already set wins.
"""

import ast
import os
import subprocess
import sys

UV_OF_PIP = {
    "index-url": ("UV_DEFAULT_INDEX", " "),
    "extra-index-url": ("UV_INDEX", " "),
    "find-links": ("UV_FIND_LINKS", ","),
    "trusted-host": ("UV_INSECURE_HOST", " "),
    "constraint": ("UV_CONSTRAINT", " "),
    "cert": ("SSL_CERT_FILE", ""),
    "proxy": ("ALL_PROXY", ""),
    "default-timeout": ("UV_HTTP_TIMEOUT", ""),
    "timeout": ("UV_HTTP_TIMEOUT", ""),
}
"""The variable that uv reads for an option of pip, and what separates its values."""


def pip_options() -> dict[str, str]:
    """The options that pip would use for an install. The environment comes before pip's files."""
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "config", "list"]
    listed = subprocess.run(pip, check=True, capture_output=True, text=True).stdout
    options: dict[str, str] = {}
    for section in ("global", "install", ":env:"):
        for line in listed.splitlines():
            key, _, value = line.partition("=")
            if key.startswith(f"{section}."):
                options[key.removeprefix(f"{section}.")] = str(ast.literal_eval(value))
    return options


def main() -> int:
    """Run uv and return its exit code."""
    environment = dict(os.environ)
    for option, value in pip_options().items():
        variable, separator = UV_OF_PIP.get(option, ("", ""))
        if variable:
            environment.setdefault(variable, separator.join(value.split()))
    if "UV_CONSTRAINT" in environment:  # pip constrains the builds of packages too
        environment.setdefault("UV_BUILD_CONSTRAINT", environment["UV_CONSTRAINT"])
    # pip takes the best version of all indexes; uv by default asks only the first that has the package.
    environment.setdefault("UV_INDEX_STRATEGY", "unsafe-best-match")
    return subprocess.run(
        [sys.executable, "-m", "uv", *sys.argv[1:]], env=environment, check=False
    ).returncode


if __name__ == "__main__":
    sys.exit(main())
