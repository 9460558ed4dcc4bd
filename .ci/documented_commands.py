"""Run each command and each piece of Python that the documentation shows; fail where one fails.

Of README.md and each page of docs, all ```bash blocks run in one shell and all ```python blocks in
one interpreter, in the order of the page, as a reader would type them. PRESET=smoke is in the
environment, so that a plain `make figures` takes the smallest run there is. A block that cannot run
here follows a line `<!-- ci: skip, REASON -->`.

Example: .venv/bin/python .ci/documented_commands.py docs/simulate.md
"""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
BLOCK = re.compile(
    r"(<!-- ci: skip, .*? -->\n+)?^```(bash|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL
)
RUN = {
    "bash": ["bash", "-euxo", "pipefail", "-c"],
    "python": [str(ROOT / ".venv" / "bin" / "python"), "-W", "error", "-c"],
}


def blocks(page: Path) -> dict[str, str]:
    """Return what a page has of each language, blocks to be skipped aside."""
    found = [
        (language, text)
        for skip, language, text in BLOCK.findall(page.read_text("utf-8"))
        if not skip
    ]
    return {
        language: "\n".join(text for of, text in found if of == language)
        for language in RUN
        if any(of == language for of, _ in found)
    }


def main(names: list[str]) -> None:
    """Run the blocks of the pages, or of all."""
    pages = [Path(name).resolve() for name in names]
    pages = pages or [
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        *sorted(ROOT.glob("docs/**/*.md")),
    ]
    path = f"{ROOT / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PRESET": "smoke", "PATH": path, "MPLBACKEND": "Agg"}
    count = 0
    for page in pages:
        for language, text in blocks(page).items():
            name = page.relative_to(ROOT)
            print(f"== {language} of {name}", flush=True)
            done = subprocess.run([*RUN[language], text], cwd=ROOT, env=environment, check=False)
            if done.returncode:
                sys.exit(f"{language} of {name} failed with exit code {done.returncode}")
            count += 1
    if not count:
        sys.exit("there is no block to run")


if __name__ == "__main__":
    main(sys.argv[1:])
