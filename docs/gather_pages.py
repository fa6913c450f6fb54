#!/usr/bin/env python3
"""gather_pages.py PAGES [WELKIN]: copies the pages of docs/ and those that stand elsewhere into the folder PAGES, for
mkdocs, and makes a page of each example's sources. Links out of docs/ lead to where the site has their target: a public
header to its page of the API reference, anything else of the repository to nothing but its name. WELKIN, the built command, adds its help to reference/command.md.
"""
import pathlib
import re
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
ELSEWHERE = {
    "README.md": "index.md",  # links only: docs/index.md is the first page
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "bindings/python/README.md": "reference/python.md",
    "bindings/wasm/README.md": "reference/npm.md",
}
EXAMPLES = ["start", "consumer", "frame_probes", "probes", "upload_chain", "own_executor", "sky_in_c", "window"]
LANGUAGES = {".cpp": "cpp", ".h": "cpp", ".c": "c", ".txt": "cmake", ".html": "html"}
COMMANDS = ["bake", "sh", "sky", "info", "convert", "importance", "batch", "report", "testmap", "sample", "completion"]


def site_path(target):
    """Where the site has a file of the repository, as a path below PAGES; None: it does not have it."""
    name = target.relative_to(SOURCE).as_posix()
    if name in ELSEWHERE:
        return ELSEWHERE[name]
    if name.startswith("docs/") and target.is_file():
        return name[len("docs/"):]
    example = re.fullmatch(r"examples/(\w+)(?:/(.*))?", name)
    if example and example.group(1) in EXAMPLES:
        heading = re.sub(r"[^\w-]", "", example.group(2) or "")  # the anchor that Python-Markdown makes
        return f"examples/{example.group(1)}.md" + ("#" + heading.lower() if heading else "")
    return None


def relative(target, page):
    return ("../" * page.count("/")) + target


def with_links(text, origin, page):
    """The text of a page that stands at `origin` in the repository, with the links that it needs at `page`."""

    def replace(match):
        shown, link = match.group(2), match.group(3)
        path, _, anchor = link.partition("#")
        if not path or re.match(r"[a-z]+:", link):
            return match.group(0)
        target = (origin.parent / path).resolve()
        found = site_path(target)
        if found:
            return f"{match.group(1)}[{shown}]({relative(found, page)}{'#' + anchor if anchor else ''})"
        header = re.fullmatch(r"include/welkin/(\w+)\.(h|hpp)", target.relative_to(SOURCE).as_posix())
        if header:
            name = header.group(1).replace("_", "__") + "_8" + header.group(2) + "_source"
            return f'<a href="{relative("api/" + name + ".html", page)}">{shown}</a>'
        return f"`{shown}`" if "`" not in shown else shown

    parts = re.split(r"(```.*?```)", text, flags=re.S)
    for index in range(0, len(parts), 2):
        parts[index] = re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", replace, parts[index])
    return "".join(parts)


def example_page(folder):
    """All files of an example, the program before the rest."""
    files = sorted(folder.iterdir(), key=lambda path: (not path.stem.startswith(("main", "three")), path.name))
    parts = [f"# examples/{folder.name}\n\nInstalled as share/doc/welkin/examples/{folder.name}.\n"]
    for path in files:
        parts.append(f"## {path.name}\n\n```{LANGUAGES[path.suffix]}\n{path.read_text(encoding='utf-8').rstrip()}\n```\n")
    return "\n".join(parts)


def command_help(welkin):
    """The help of all commands, as the built command prints it."""
    parts = ["\n# Complete help\n"]
    for command in COMMANDS:
        said = subprocess.run([welkin, command, "--help-all"], check=True, capture_output=True, text=True).stdout
        parts.append(f"## welkin {command}\n\n```text\n{said.rstrip()}\n```\n")
    return "\n".join(parts)


def main():
    pages = pathlib.Path(sys.argv[1])
    shutil.rmtree(pages, ignore_errors=True)
    shutil.copytree(SOURCE / "docs", pages, ignore=shutil.ignore_patterns("Doxyfile", "*.sed", "*.py", "*.md"))
    origins = {path: path.relative_to(SOURCE / "docs").as_posix() for path in (SOURCE / "docs").rglob("*.md")}
    origins |= {SOURCE / name: page for name, page in ELSEWHERE.items() if name != "README.md"}
    for origin, page in origins.items():
        text = with_links(origin.read_text(encoding="utf-8"), origin, page)
        if page == "reference/api.md":
            text = text.replace("\n\n", '\n\n<a href="../api/index.html">All headers, by Doxygen</a>.\n\n', 1)
        if page == "reference/command.md" and len(sys.argv) > 2:
            text += command_help(sys.argv[2])
        (pages / page).write_text(text, encoding="utf-8")
    (pages / "examples").mkdir()
    for name in EXAMPLES:
        (pages / "examples" / (name + ".md")).write_text(example_page(SOURCE / "examples" / name), encoding="utf-8")


if __name__ == "__main__":
    main()
