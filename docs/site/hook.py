"""Hook: what MkDocs builds beyond the pages in docs/: reference, gallery and tutorials, made from the code."""

import re
from pathlib import Path
from typing import Any

import catalogue
import commands
import gallery
import keys
import notebooks
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages and files that are made."""
    made: dict[str, str | bytes] = {
        "reference/keys.md": keys.page(),
        "reference/strategies.md": catalogue.page(),
        "reference/command-line.md": commands.page(),
        "gallery.md": gallery.page(),
        "contributing.md": _of_the_house("CONTRIBUTING.md"),
        "changelog.md": _of_the_house("CHANGELOG.md"),
        **notebooks.pages(),
    }
    for name, content in made.items():
        files.append(File.generated(config, name, content=content))
    return files


def _of_the_house(name: str) -> str:
    """Give a page that lies beside docs/, whose links into docs/ stay what they are on the site."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.sub(r"\]\(docs/", "](", text)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Let fences without a language be shells', which most of ours are."""
    return re.sub(r"^```\n(?=(tiswarm|pip|python|\$ ))", "```console\n", markdown, flags=re.MULTILINE)
