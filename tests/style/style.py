#!/usr/bin/env python3
"""Style of the tree: code as clang-format 14 writes it, and no line of text wider than 110 columns.

    style.py          lists what is not so, and fails
    style.py --fix    mends it: formats code, wraps the prose of Markdown files

Tables, code blocks, links that stand alone and lines without a space to break at are left as they are.
"""
import concurrent.futures
import itertools
import pathlib
import re
import subprocess
import sys
import textwrap

WIDTH = 110
ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE = (".cpp", ".h", ".glsl")
TEXT = (".txt", ".cmake", ".in", ".sh", ".py", ".yml")
LIST_ITEM = re.compile(r"^(\s*)([-*+]|\d+\.)(\s+)")


def files():
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=False,
                            capture_output=True, text=True)
    if listed.returncode != 0:  # an unpacked archive
        found = [p.relative_to(ROOT) for p in ROOT.rglob("*") if p.is_file()]
        return sorted(p for p in found if p.parts[0] not in ("build", "out"))
    return [p for p in map(pathlib.Path, listed.stdout.split("\n")) if str(p) != "." and (ROOT / p).is_file()]


def wrapped_markdown(text):
    """Paragraphs and list items refilled to WIDTH; everything else untouched."""
    out, paragraph, hang = [], [], ""

    def flush():
        nonlocal paragraph
        if paragraph:
            first = LIST_ITEM.match(paragraph[0])
            start = first.group(0) if first else re.match(r"\s*", paragraph[0]).group(0)
            words = " ".join(line.strip() for line in paragraph)
            if first:
                words = words[len(first.group(0).strip()):].strip()
            out.extend(textwrap.wrap(words, WIDTH, initial_indent=start, subsequent_indent=hang,
                                     break_long_words=False, break_on_hyphens=False))
        paragraph = []

    fenced = False
    for line in text.split("\n"):
        if line.lstrip().startswith("```"):
            flush()
            fenced = not fenced
            out.append(line)
        elif fenced or not line.strip() or line.lstrip().startswith(("|", "#", "<", "!", ">", "---")):
            flush()
            out.append(line)
        elif LIST_ITEM.match(line):
            flush()
            hang = " " * len(LIST_ITEM.match(line).group(0))
            paragraph = [line]
        elif not paragraph and line.startswith("    "):  # an indented code block
            out.append(line)
        elif paragraph:
            paragraph.append(line)
        else:
            hang = re.match(r"\s*", line).group(0)
            paragraph = [line]
    flush()
    return "\n".join(out)


def formatted_code(path):
    # GLSL is formatted as C++: clang-format picks the language by the suffix.
    name = f"{path}.cpp" if path.suffix == ".glsl" else str(path)
    return subprocess.run(["clang-format", f"--assume-filename={name}"], input=(ROOT / path).read_text(),
                          cwd=ROOT, check=True, capture_output=True, text=True).stdout


def too_wide(line, markdown):
    if len(line) <= WIDTH:
        return False
    if markdown and (line.lstrip().startswith("|") or line.startswith("    ")):
        return False
    return " " in line.strip()[:-1] and not re.match(r"\s*(#|//|-)?\s*\S+$", line)


def main():
    fix = "--fix" in sys.argv[1:]
    faults = []
    code = [p for p in files() if p.suffix in CODE]
    with concurrent.futures.ThreadPoolExecutor() as pool:
        for path, formatted in zip(code, pool.map(formatted_code, code)):
            text = (ROOT / path).read_text()
            if formatted == text:
                continue
            if fix:
                (ROOT / path).write_text(formatted)
                continue
            pairs = itertools.zip_longest(text.split("\n"), formatted.split("\n"))
            number = next(i for i, (a, b) in enumerate(pairs, 1) if a != b)
            faults.append(f"{path}:{number}: not as clang-format writes it")
    for path in files():
        markdown = path.suffix == ".md"
        if not markdown and path.suffix not in CODE + TEXT:
            continue
        text = (ROOT / path).read_text()
        if markdown and fix and (new := wrapped_markdown(text)) != text:
            (ROOT / path).write_text(new)
            text = new
        fenced = False
        for number, line in enumerate(text.split("\n"), 1):
            fenced ^= markdown and line.lstrip().startswith("```")
            if not fenced and too_wide(line, markdown):
                faults.append(f"{path}:{number}: {len(line)} columns; {WIDTH} are the most")
    for fault in faults:
        print(fault)
    if faults:
        print(f"{len(faults)} faults; ./loden.sh format mends what a program can mend")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
