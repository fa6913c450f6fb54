#!/usr/bin/env python3
"""pages_test.py SOURCE CHECK: what holds for all pages (README.md, CHANGELOG.md, docs/ and the other Markdown files).

CHECK is one of
  links   every link leads to a file that is there, and to a heading that it has; every page under docs/ is in
          mkdocs.yml and can be reached from docs/index.md; docs/... paths that sources name exist; HTML pages that
          are printed whole are those of examples/start
  words   no page, comment, text of the command or message of the library uses a word of FORBIDDEN, outside of code and of
          EXCEPTIONS; no comment in a source or script opens with a word of OPENINGS
  size    pages for users have at most 45 000 words, README.md 100 lines, CONTRIBUTING.md two screens
  version everything that states Welkin's version states that of CMakeLists.txt
"""
import pathlib
import re
import subprocess
import sys

# Words that readers of this field do not use for these things, and what to write instead (a regular expression each).
FORBIDDEN = {
    r"balls?": "sphere",
    r"truths?": "reference",
    r"anew": "again",
    r"whoever|somebody|nobody": "name the person or thing",
    r"gives? up|given up|giving up": "cancel",
    r"tak(?:e|es|en|ing) out": "extract",
    r"look(?:s|ed|ing)? through": "check, sanitize",
    r"even(?:ly)? light|even light": "uniform",
    r"turned by|turned to|are turned|is turned|turns? the(?!.* into)": "rotate",
    r"as a rule": "usually",
    r"the very bits|the very same": "the same bits",
    r"beside": "next to, in addition to",
    r"likewise|besides": "say what is meant",
    r"some \d": "about, or nothing",
    r"cards?": "GPU",
    r"(?:texels?|bytes?|bits|ns|us|ms|roughness|words?|one|two|nodes|numbers?|line|task|colours?|colors?|pixels?) "
    r"an? (?:mip|texel|edge|pixel|block|channel|job|node|probe|second|file|shard|frame|face|line)": "per",
    r"heed(?:s|ed)?": "respect",
    r"fewest": "minimum",
    r"at the least|at the most": "at least, at most",
    r"half a turn|quarter of a turn|by a quarter in": "180 degrees, 90 degrees",
    r"scratch room|rooms? for": "memory, scratch",
    r"share of the (?:work|light|time|sphere)": "fraction",
    r"processor (?:time|minutes|seconds)": "CPU time",
    r"told by|told of|is told|are told": "say what decides",
    r"the last but one": "the second to last",
    r"of one's own": "your own",
    r"(?:all|as|from|become|\d+|RGBA) halves": "half floats",
    r"(?:has|have|had|with|are) the (?:same )?bits of(?! results)": "bit-identical to",
    r"throws as": "throws the same errors as",
    r"(?:texel|direction|normal|probe)s?,? and thread": "per texel on one thread",
    r"raised to it": "clamped to",
    r"ask(?:s|ed)? for": "request, need",
    r"by the way that": "by the rule that",
    r"pictures?": "image",
    # Spelling is Oxford's, as that of the identifiers: British, with -ize.
    r"colors?|colored": "colour",
    r"grays?": "grey",
    r"neighbors?|neighboring": "neighbour",
    r"centers?|centered": "centre",
    r"behaviors?|favor(?:ed|s)?|honor(?:ed|s)?|labeled|modeled|traveled|canceled|artifacts?|analyz\w+": "British spelling",
    r"\w*(?:discreti|equali|generali|initiali|maximi|minimi|normali|optimi|organi|polari|quanti|rasteri|reali|recogni|"
    r"summari|vectori)s(?:e|ed|es|ing|ation)": "-ize",
}

# Where a word above means something else: path (or folder), word, why.
EXCEPTIONS = [
    ("docs/notes/stability_table.md", None, "a test of tests/stability writes it"),
    ("docs/notes/doc_comments.md", None, "quotes comments from before"),
    ("docs/notes/readers.md", None, "quotes pages from before"),
    ("README.md", "pictures", "the page"),
    ("docs/index.md", "pictures", "the page"),
    ("docs/pictures.md", "pictures", "the page"),
    ("tools/engines/blender.md", "picture", "a name in its code"),
    ("perf/report/report_files.cpp", "truth", "a key of the report's JSON and CSV"),
]

# A comment that opens with one of these hangs on the line before.
OPENINGS = r"^(?://[/!]?<?|#) ?(?:Of|What|The same|Those|As above|Whoever|Whatever|Likewise)\b"

USER_FOLDERS = ("tutorials", "guides", "reference", "explanation")
MOST_WORDS_FOR_USERS = 45_000
MOST_LINES_OF_README = 100
MOST_WORDS_OF_CONTRIBUTING = 800


def tracked(source, *patterns):
    """Files of the working tree that git knows or would take."""
    names = subprocess.run(
        ["git", "-C", str(source), "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", *patterns],
        check=True, capture_output=True, text=True).stdout.split("\0")
    return sorted({source / name for name in names if name and (source / name).is_file()})


def pages(source):
    return [path for path in tracked(source, "*.md") if "tools/engines" not in path.as_posix()]


def prose(text):
    """Text without code blocks, code in back quotes, and targets of links; the same number of lines."""
    kept, fenced = [], False
    for line in text.split("\n"):
        if line.startswith("```"):
            fenced = not fenced
            kept.append("")
        elif fenced or line.startswith("    "):
            kept.append("")
        else:
            kept.append(line)
    text = "\n".join(kept)
    text = re.sub(r"`[^`]*`", lambda match: "`" + "\n" * match.group(0).count("\n"), text)
    return re.sub(r"\]\([^)]*\)", "]", text)


def comments(text):
    """The comments of a header; the same number of lines."""
    kept, inside = [], False
    for line in text.split("\n"):
        if inside or "/*" in line:
            kept.append(line if inside else line[line.index("/*"):])
            inside = "*/" not in kept[-1]
        else:
            kept.append(line[line.index("//"):] if "//" in line else "")
    return re.sub(r"`[^`\n]*`", "`", "\n".join(kept))


def hash_comments(text):
    """The comments of a script; the same number of lines."""
    kept = ["".join(re.findall(r"(?:^|\s)(# .*)$", line)) for line in text.split("\n")]
    return re.sub(r"`[^`\n]*`", "`", "\n".join(kept))


def strings(text):
    """The string literals of a source; the same number of lines."""
    kept = []
    for line in text.split("\n"):
        code = "" if line.lstrip().startswith(("//", "#include", "*")) else line
        kept.append(" ".join(re.findall(r'"((?:[^"\\]|\\.)*)"', code)))
    return re.sub(r"`[^`\n]*`", "`", "\n".join(kept))


def anchors(text):
    """Anchors of headings, as GitHub and Python-Markdown make them."""
    found, fenced = set(), False
    for line in text.split("\n"):
        if line.startswith("```"):
            fenced = not fenced
        heading = re.match(r"#+ +(.*)", line)
        if heading and not fenced:
            plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).replace("`", "")
            found.add(re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", plain).strip().lower()))
    return found


def links_of(text):
    """Targets of links and images, outside of code."""
    shown = re.sub(r"```.*?```", "", text, flags=re.S)
    shown = re.sub(r"^    .*$", "", shown, flags=re.M)
    shown = re.sub(r"`[^`]*`", "", shown)
    return re.findall(r"\]\(([^)\s]+)\)", shown)


def check_links(source):
    faults = []
    texts = {path: path.read_text(encoding="utf-8") for path in pages(source)}
    reached = {source / "docs" / "index.md"}
    for path, text in texts.items():
        for link in links_of(text):
            if re.match(r"[a-z]+:", link):
                faults.append(f"{path.relative_to(source)}: {link} leaves the repository")
                continue
            name, _, anchor = link.partition("#")
            target = (path.parent / name).resolve() if name else path
            if not target.exists():
                faults.append(f"{path.relative_to(source)}: {link}: there is no such file")
            elif anchor and anchor not in anchors(texts.get(target) or target.read_text(encoding="utf-8")):
                faults.append(f"{path.relative_to(source)}: {link}: there is no such heading")
    printed = [path.read_text(encoding="utf-8") for path in tracked(source, "examples/start/*.html")]
    for path, text in texts.items():
        for block in re.findall(r"```html\n(<!doctype.*?)```", text, re.S):
            if block not in printed:
                faults.append(f"{path.relative_to(source)}: an HTML page differs from those of examples/start")
    frontier = list(reached)
    while frontier:
        path = frontier.pop()
        for link in links_of(texts[path]):
            target = (path.parent / link.partition("#")[0]).resolve()
            if target in texts and target not in reached:
                reached.add(target)
                frontier.append(target)
    for header in set(re.findall(r"\b\w+\.h\b", texts[source / "docs/reference/api.md"])):
        if not (source / "include/welkin" / header).exists():
            faults.append(f"docs/reference/api.md: there is no public header {header}")
    navigation = (source / "mkdocs.yml").read_text(encoding="utf-8")
    for path in texts:
        name = path.relative_to(source).as_posix()
        if not name.startswith("docs/"):
            continue
        if path not in reached:
            faults.append(f"{name}: docs/index.md leads nowhere near it")
        if name[len("docs/"):] not in navigation:
            faults.append(f"{name}: mkdocs.yml does not have it")
    for path in tracked(source):
        if path.suffix in (".png", ".svg", ".exr", ".hdr", ".ktx2") or path.name == "CHANGELOG.md":
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for name in set(re.findall(r"(?<![\w/])docs/[\w/]+\.(?:md|png|svg|txt)", text)):
            if not (source / name).exists():
                faults.append(f"{path.relative_to(source)}: names {name}, which is not there")
    return faults


def check_words(source):
    faults = []
    readers = [(path, prose) for path in pages(source)]
    readers += [(path, comments) for path in tracked(source, "include/*.h", "include/*.hpp",
                                                     "bindings/wasm/package/*.d.ts", "examples/**/main.*")]
    readers += [(path, str) for path in tracked(source, "tools/help/*.txt", "tools/engines/*.md")]
    readers += [(path, strings) for path in tracked(source, "tools/*.cpp", "module/*.cpp", "module/*.h", "perf/report/*.cpp",
                                                    "bindings/python/source/*.cpp")]
    plain = [(path, comments) for path in tracked(source, *(f"{folder}/*.{kind}" for kind in ("cpp", "h", "c")
                                                            for folder in ("module", "perf", "tests", "tools")))]
    plain += [(path, comments) for path in tracked(source, "*.mjs", "*.js")]
    plain += [(path, hash_comments) for path in tracked(source, "scripts/*", ".ci/run", "*.sh", "*.py", "*.cmake",
                                                        "*CMakeLists.txt")]
    readers += plain
    for path, words_of in readers:
        name = path.relative_to(source).as_posix()
        text = words_of(path.read_text(encoding="utf-8"))
        lines = text.split("\n")
        if (path, words_of) in plain:
            faults += [f"{name}:{number}: opens with a word that needs the line before: {line[:100]}"
                       for number, line in enumerate(lines, 1) if re.search(OPENINGS, line)]
        for word, instead in FORBIDDEN.items():
            for match in re.finditer(rf"\b(?:{word})\b", text, flags=re.I):
                if not any(name.startswith(where) and (what is None or what == match.group(0).lower())
                           for where, what, _ in EXCEPTIONS):
                    number = text.count("\n", 0, match.start()) + 1
                    faults.append(f"{name}:{number}: '{match.group(0)}' ({instead}): {lines[number - 1].strip()[:100]}")
    return faults


def check_size(source):
    faults = []
    words = 0
    for path in pages(source):
        name = path.relative_to(source).as_posix()
        if name in ("README.md", "docs/index.md", "docs/pictures.md") or name.startswith(
                tuple(f"docs/{folder}/" for folder in USER_FOLDERS) + ("bindings/",)):
            words += len(path.read_text(encoding="utf-8").split())
    if words > MOST_WORDS_FOR_USERS:
        faults.append(f"pages for users have {words} words, more than {MOST_WORDS_FOR_USERS}")
    lines = len((source / "README.md").read_text(encoding="utf-8").splitlines())
    if lines > MOST_LINES_OF_README:
        faults.append(f"README.md has {lines} lines, more than {MOST_LINES_OF_README}")
    rules = len((source / "CONTRIBUTING.md").read_text(encoding="utf-8").split())
    if rules > MOST_WORDS_OF_CONTRIBUTING:
        faults.append(f"CONTRIBUTING.md has {rules} words, more than {MOST_WORDS_OF_CONTRIBUTING}")
    print(f"{words} words for users, {lines} lines of README.md, {rules} words of CONTRIBUTING.md")
    return faults


def check_version(source):
    version = re.search(r"project\(welkin VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text()).group(1)
    major, minor, patch = version.split(".")
    statements = [
        ("include/welkin/core.h", r"#define WELKIN_VERSION_MAJOR (\d+)", major),
        ("include/welkin/core.h", r"#define WELKIN_VERSION_MINOR (\d+)", minor),
        ("include/welkin/core.h", r"#define WELKIN_VERSION_PATCH (\d+)", patch),
        ("include/welkin/core.h", r'#define WELKIN_VERSION_STRING "(.*)"', version),
        ("vcpkg.json", r'"version-semver": "(.*)"', version),
        ("packaging/vcpkg/welkin/vcpkg.json", r'"version-semver": "(.*)"', version),
        ("packaging/conan/conanfile.py", r'version = "(.*)"', version),
        ("bindings/wasm/package/package.json", r'"version": "(.*)"', version),
        ("docs/guides/farm.md", r'"welkin": "(.*?)"', version),
        ("CHANGELOG.md", r"## ([0-9.]+)", version),
        ("examples/CMakeLists.txt", r"find_package\(welkin ([0-9.]+)", f"{major}.{minor}"),
        ("examples/consumer/CMakeLists.txt", r"find_package\(welkin ([0-9.]+)", f"{major}.{minor}"),
        ("examples/sky_in_c/CMakeLists.txt", r"find_package\(welkin ([0-9.]+)", f"{major}.{minor}"),
        ("tests/install/c_alone/CMakeLists.txt", r"find_package\(welkin ([0-9.]+)", f"{major}.{minor}"),
        ("tests/install/core_only/CMakeLists.txt", r"find_package\(welkin ([0-9.]+)", f"{major}.{minor}"),
        ("scripts/test-packages", r"find_package\(welkin ([0-9.]+)", f"{major}.{minor}"),
        # Files that read the version from those above.
        ("bindings/python/setup.py", r"project\\\(welkin (VERSION)", "VERSION"),
        ("bindings/python/source/module.cpp", r'"__version__"\) = (\w+)', "WELKIN_VERSION_STRING"),
        ("cmake/welkin.pc.in", r"Version: (.*)", "@PROJECT_VERSION@"),
        ("cmake/welkin-core.pc.in", r"Version: (.*)", "@PROJECT_VERSION@"),
    ]
    faults = []
    for name, pattern, wanted in statements:
        found = re.search(pattern, (source / name).read_text(encoding="utf-8"))
        if not found or found.group(1) != wanted:
            faults.append(f"{name}: states {found.group(1) if found else 'no version'}, and CMakeLists.txt {version}")
    return faults


def main():
    source = pathlib.Path(sys.argv[1]).resolve()
    if not (source / ".git").exists():
        sys.exit(77)  # an unpacked archive: nothing says which files are the project's
    faults = {"links": check_links, "words": check_words, "size": check_size, "version": check_version}[sys.argv[2]](source)
    for fault in faults:
        print(fault)
    if faults:
        sys.exit(f"{len(faults)} faults")


if __name__ == "__main__":
    main()
