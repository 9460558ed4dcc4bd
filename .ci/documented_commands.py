"""Run what the README's quick start tells its reader to type, and fail where that fails.

That is every ```bash block under the heading "Quick start", all in one shell, as a reader would.
PRESET=smoke is in the environment, so that a plain `make figures` takes the smallest run there is.
A block that cannot run here follows a line `<!-- ci: skip, REASON -->`.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

README = Path(__file__).parent.parent / "README.md"
SECTION = re.compile(r"^## Quick start\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(r"(<!-- ci: skip, .*? -->\n+)?^```bash\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def quick_start(text: str) -> str:
    """Return the commands of the quick start in a README's text, those to be skipped aside."""
    section = SECTION.search(text)
    blocks = BLOCK.findall(section[1]) if section else []
    commands = [block for skip, block in blocks if not skip]
    if not commands:
        sys.exit("README.md must have a ```bash block under '## Quick start', but it has none")
    return "\n".join(commands)


if __name__ == "__main__":
    script = quick_start(README.read_text())
    shell = ["bash", "-euxo", "pipefail", "-c", script]
    code = subprocess.run(
        shell, cwd=README.parent, env=os.environ | {"PRESET": "smoke"}, check=False
    ).returncode
    if code:
        sys.exit(f"The README's quick start failed with exit code {code} at its last command above")
