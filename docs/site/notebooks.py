"""Notebooks: the tutorials, executed: each a page with what its cells gave, and a notebook to take away."""

import base64
import os
import re
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import jupytext
import nbformat
from nbclient import NotebookClient

TUTORIALS = Path(__file__).parents[1] / "tutorials"

ESCAPES = re.compile(r"\x1b\[[0-9;]*m")
"""What makes words bold in a terminal and in a notebook, and is noise on a page."""

DATA = re.compile(r'src="data:video/mp4;base64,([^"]+)"')


def pages() -> dict[str, str | bytes]:
    """Execute all tutorials: pages, notebooks, pictures and films by their places on the site."""
    made: dict[str, str | bytes] = {}
    for source in sorted(TUTORIALS.glob("*.py")):
        notebook = _executed(source.read_text(encoding="utf-8"))
        made[f"tutorials/{source.stem}.ipynb"] = nbformat.writes(notebook)
        made |= _page(notebook, source.stem)
    return made


@cache
def _executed(source: str) -> Any:
    """Run a notebook in a folder of its own. Errors: CellExecutionError, which shows the cell."""
    notebook = jupytext.reads(source, fmt="py:percent")
    with tempfile.TemporaryDirectory() as folder:
        before = Path.cwd()
        os.chdir(folder)  # a kernel begins where its parent is
        try:
            NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
        finally:
            os.chdir(before)
    return notebook


def _page(notebook: Any, name: str) -> dict[str, str | bytes]:
    files: dict[str, str | bytes] = {}
    parts = []
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        parts += [_shown(output, name, files) for output in cell.outputs]
    title, _, rest = "\n\n".join(parts).partition("\n")
    files[f"tutorials/{name}.md"] = f"{title}\n\n[Take it away as a notebook]({name}.ipynb){{ download }}\n{rest}\n"
    return files


def _shown(output: Any, name: str, files: dict[str, str | bytes]) -> str:
    """Show what a cell gave, pictures and films as files of their own."""
    if output.output_type == "stream":
        return _text(output.text) if output.name == "stdout" else ""
    data = output.data
    if "image/png" in data:
        return f"![What the cell drew]({_kept(base64.b64decode(data['image/png']), 'png', name, files)})"
    if "text/html" in data:
        film = DATA.search(data["text/html"])
        if film:
            return f'<video src="{_kept(base64.b64decode(film.group(1)), "mp4", name, files)}" controls loop muted></video>'
        return str(data["text/html"])
    return _text(data["text/plain"])


def _text(text: str) -> str:
    return f'```text title="Output"\n{ESCAPES.sub("", text).rstrip()}\n```'


def _kept(content: bytes, suffix: str, name: str, files: dict[str, str | bytes]) -> str:
    file = f"{name}-{len(files) + 1}.{suffix}"
    files[f"tutorials/{file}"] = content
    return file
