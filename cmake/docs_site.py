"""Hooks of mkdocs that turn pages written for GitHub into pages of the site (mkdocs.yml).

The two differ in three points. Links that leave docs/ lead nowhere on the site: they become the name of the file
in the repository. Lists are indented by their marker's width on GitHub, by four spaces here. Headings get their
anchors by GitHub's rule, against which tests/app/doc_pages.cpp checks the pages' links as well.
"""

import os
import re

from mkdocs.exceptions import PluginError

# Markdown: the line before and after a code block; a list item's indentation, marker and space; a link's label, target
# and anchor (no picture); code within a line.
_FENCE = re.compile(r"^\s*(```|~~~)")
_ITEM = re.compile(r"^( *)([-*+]|\d+\.)( +)(?=\S)")
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
_SPAN = re.compile(r"(`[^`]*`)")


def slug(text, separator):
    """A heading's anchor: lower case, without punctuation, hyphens for spaces."""
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", separator)


def on_config(config):
    """Lets the table of contents make anchors by GitHub's rule."""
    config["mdx_configs"].setdefault("toc", {})["slugify"] = slug
    return config


def on_nav(nav, config, files):
    """Checks that every page of docs/ is in the navigation exactly once."""
    named = [page.file.src_path for page in nav.pages]
    for path in sorted(file.src_path for file in files.documentation_pages()):
        if named.count(path) != 1:
            raise PluginError(f"mkdocs.yml: docs/{path} stands {named.count(path)} times in nav, accepted once")
    return nav


def _replace_outside_link(match, page, repository):
    """Replaces a link that leaves docs/ by the name of its target."""
    label, target = match.group(1), match.group(2)
    path = os.path.normpath(os.path.join("docs", os.path.dirname(page), target)).replace(os.sep, "/")
    if "://" in target or target.startswith("mailto:") or path.startswith("docs/"):
        return match.group(0)
    if not os.path.exists(os.path.join(repository, path)):
        raise PluginError(f"docs/{page}: found a link to {target}, and nothing there")
    plain = label.strip("`")
    return f"`{path}`" if plain.lstrip("./") in path else f"{label} (`{path}`)"


def _replace_outside_links(line, page, repository):
    """A line of Markdown with _replace_outside_link applied to its links; a line with a link inside code stays."""
    parts = _SPAN.split(line)
    if any("](" in part for part in parts[1::2]):
        return line
    # search the whole line, since a label may contain a code span
    return _LINK.sub(lambda match: _replace_outside_link(match, page, repository), line)


def _reindent_lists(lines):
    """Indents lists by four spaces a level and puts a blank line before a list, as python-markdown requires."""
    # levels: for each open list, the column at which the text of its items begins
    out, levels, fenced, after_blank, in_text = [], [], False, True, False
    for line in lines:
        if not line.strip():
            out.append(line)
            after_blank, in_text = True, False
            continue
        indent = len(line) - len(line.lstrip(" "))
        fence, item = _FENCE.match(line), None if fenced else _ITEM.match(line)
        if not fenced and (item or after_blank or fence):
            while levels and levels[-1] > indent:
                levels.pop()
        if item and indent - (levels[-1] if levels else 0) >= 4:
            item = None  # four columns beyond the list: a code block
        outer = levels[-1] if levels else 0
        new_line = " " * (4 * len(levels) + max(indent - outer, 0)) + line.lstrip(" ")
        if item:
            if in_text and not levels and not after_blank:
                out.append("")
            levels.append(indent + len(item.group(2)) + len(item.group(3)))
            new_line = " " * (4 * (len(levels) - 1)) + line.lstrip(" ")
        out.append(new_line)
        if fence:
            fenced = not fenced
        in_text = not fenced and not item and not fence and not line.lstrip().startswith(("|", "#"))
        after_blank = False
    return out


def on_page_markdown(markdown, page, config, files):
    """Converts a page: its links outside code blocks, and its lists."""
    repository = os.path.dirname(config["config_file_path"])
    lines, fenced = [], False
    for line in markdown.split("\n"):
        if _FENCE.match(line):
            fenced = not fenced
        lines.append(line if fenced else _replace_outside_links(line, page.file.src_path, repository))
    return "\n".join(_reindent_lists(lines))
