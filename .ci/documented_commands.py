"""Run each command and each piece of Python that the documentation shows; fail where one fails.

The blocks of README.md and of each page of docs are run in the order of the page, as a reader would
type them: all ```bash blocks in one shell and all ```python blocks in one interpreter. PRESET=smoke
is in the environment, so that a plain `make figures` takes the smallest run there is. A block that
cannot run here follows a line `<!-- ci: skip, REASON -->`.

Example: .venv/bin/python .ci/documented_commands.py docs/simulate.md
"""

import os
import re
import subprocess
import sys
from contextlib import closing
from pathlib import Path

ROOT = Path(__file__).parent.parent
BLOCK = re.compile(
    r"(<!-- ci: skip, .*? -->\n+)?^```(bash|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL
)
ONE_PAGE = "--one-page"


class Shell:
    """A shell that runs one block after another, and ends at the first command that fails."""

    def __init__(self) -> None:
        told, tells = os.pipe()
        self.tells = tells
        self.process = subprocess.Popen(
            ["bash", "-euxo", "pipefail"],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            pass_fds=[tells],
            text=True,
        )
        os.close(tells)
        self.told = os.fdopen(told)

    def run(self, block: str) -> None:
        """Run a block, with nothing on its standard input."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{{\n{block}\n}} < /dev/null\necho done >&{self.tells}\n")
        self.process.stdin.flush()
        if not self.told.readline():
            sys.exit(f"bash ended with exit code {self.process.wait()}")

    def close(self) -> None:
        """End the shell."""
        self.process.communicate()
        self.told.close()


def blocks(page: Path) -> list[tuple[str, str]]:
    """Return language and text of the blocks of a page, without those that are skipped."""
    found = BLOCK.findall(page.read_text("utf-8"))
    return [(language, text) for skip, language, text in found if not skip]


def run_page(page: Path) -> None:
    """Run the blocks of a page, in this process."""
    os.chdir(ROOT)
    names = {"__name__": "page"}
    with closing(Shell()) as shell:
        for language, text in blocks(page):
            if language == "bash":
                shell.run(text)
            else:
                exec(compile(text, str(page), "exec"), names)


def main(names: list[str]) -> None:
    """Run the blocks of the pages, or of all, each page in a process of its own."""
    pages = [Path(name).resolve() for name in names] or [
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        *sorted(ROOT.glob("docs/**/*.md")),
    ]
    pages = [page for page in pages if blocks(page)]
    if not pages:
        sys.exit("there is no block to run")
    path = f"{ROOT / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PRESET": "smoke", "PATH": path, "MPLBACKEND": "Agg"}
    python = [str(ROOT / ".venv" / "bin" / "python"), "-W", "error"]
    for page in pages:
        print(f"== {page.relative_to(ROOT)}", flush=True)
        command = [*python, __file__, ONE_PAGE, str(page)]
        if subprocess.run(command, env=environment, check=False).returncode:
            sys.exit(f"a block of {page.relative_to(ROOT)} failed")
    print(f"the documented commands of {len(pages)} pages ran")


if __name__ == "__main__":
    if sys.argv[1:2] == [ONE_PAGE]:
        run_page(Path(sys.argv[2]))
    else:
        main(sys.argv[1:])
