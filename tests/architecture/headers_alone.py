#!/usr/bin/env python3
"""headers_alone.py ROOT BUILD: shows that each header whose name stands on standard input (one a line, from ROOT)
compiles alone. Exit 0: each does. 1: one does not; the compiler's message names it.

BUILD is CMake's binary folder: its compile_commands.json, if there is one, names the folders of #include lines, and
headers_alone.txt there lists what has passed, so that only what has changed since is compiled again.

clang++ only parses (-fsyntax-only). Most of the work is Eigen and the standard library, so that work is shared where
this hides nothing. A header may stand in a file behind another that it includes itself: what is declared before it, it
includes as well. In the same way a header may find a set of headers parsed that it includes. (A header that needs what
it does not include, but includes a header that needs it as well, is no exception: there the included one is found.)
This holds as long as all #include lines stand before the code, which is checked too.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

# Sets of headers that many others include, the largest first. A header finds the first of them parsed whose headers it
# includes.
SETS = [['<CLI/CLI.hpp>', 'config/reading/cell_config.h'], ['config/reading/cell_config.h'], ['<CLI/CLI.hpp>'],
        ['control/tick_record.h'], ['kinematics/spatial.h', '<filesystem>'], ['kinematics/spatial.h'], ['<filesystem>'],
        ['<string>']]
OPTIONS = ['-std=c++20', '-w']
INCLUDE = re.compile(r' *# *include +([<"])([^>"]+)[>"]')
CODE = re.compile(r' *[^ #/]| */[^/]')


class Tree:
    """The headers below a folder, and what each includes."""

    def __init__(self, root, folders):
        self.root, self.folders, self.closures, self.texts = root, folders, {}, {}

    def text(self, header):
        if header not in self.texts:
            self.texts[header] = (self.root / header).read_text(encoding='utf-8')
        return self.texts[header]

    def resolve(self, name, includer):
        """The file of the tree that an #include line of `includer` names, from the root; None outside the tree."""
        for folder in [self.root / pathlib.Path(includer).parent, self.root, *self.folders]:
            path = pathlib.Path(os.path.normpath(folder / name))
            if path.is_file() and self.root in path.parents:
                return str(path.relative_to(self.root))
        return None

    def included(self, header):
        """All that a header includes, itself as well: files of the tree as their names, others as <name>."""
        if header not in self.closures:
            self.closures[header] = found = {header}
            for line in self.text(header).splitlines():
                if match := INCLUDE.match(line):
                    inner = self.resolve(match[2], header)
                    found |= self.included(inner) if inner else {f'<{match[2]}>'}
        return self.closures[header]


def late_includes(tree, headers):
    """The #include lines that stand behind code."""
    for header in headers:
        code = False
        for number, line in enumerate(tree.text(header).splitlines(), 1):
            if INCLUDE.match(line) and code:
                yield f'{header}:{number}: an #include behind code: put it before ({pathlib.Path(__file__).name} relies on it)'
            code = code or bool(CODE.match(line))


def include_options(build):
    """The options of all compilations that name folders of #include lines."""
    options = {}
    if (build / 'compile_commands.json').is_file():
        for entry in json.loads((build / 'compile_commands.json').read_text(encoding='utf-8')):
            words = shlex.split(entry['command'])
            for word, following in zip(words, words[1:] + ['']):
                if word.startswith('-I'):
                    options[word] = [word]
                elif word == '-isystem':
                    options[following] = [word, following]
    return [word for pair in options.values() for word in pair]


def files_of(tree, headers):
    """@returns pairs of a set (None: none) and the headers of one file, in the order of their #include lines."""
    files = {}
    for header in sorted(headers, key=lambda name: (len(tree.included(name)), name)):
        included = tree.included(header)
        parsed = next((i for i, wanted in enumerate(SETS) if included >= set(wanted)), None)
        behind = [file for file in files.get(parsed, []) if file[-1] in included]
        if behind:
            max(behind, key=lambda file: len(tree.included(file[-1]))).append(header)
        else:
            files.setdefault(parsed, []).append([header])
    return [(parsed, file) for parsed, some in files.items() for file in some]


def include_lines(headers):
    return ''.join(f'#include {name}\n' if name.startswith('<') else f'#include "{name}"\n' for name in headers)


def main():
    root, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    options = [f'-I{root}', *include_options(build), *OPTIONS]
    tree = Tree(root, [pathlib.Path(option[2:]) for option in options if option.startswith('-I')])
    headers = sys.stdin.read().split()
    if late := list(late_includes(tree, headers)):
        print('\n'.join(late))
        return 1

    version = subprocess.run(['clang++', '--version'], capture_output=True, text=True, check=True).stdout
    log = build / 'headers_alone.txt'
    passed = set(log.read_text(encoding='utf-8').split()) if log.is_file() else set()
    files = {}  # by a hash of all that its compilation reads, but for other libraries' headers
    for parsed, file in files_of(tree, headers):
        names = sorted(set().union(*(tree.included(header) for header in file)))
        read = [version, *options, str(SETS), *file, *(tree.text(name) for name in names if name[0] != '<')]
        files[hashlib.sha256('\0'.join(read).encode()).hexdigest()] = (parsed, file)

    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        def compile_text(name, text, more):
            source = pathlib.Path(folder) / name
            source.write_text(text, encoding='utf-8')
            run = subprocess.run(['clang++', *options, *more, source], capture_output=True, text=True, check=False)
            return '' if run.returncode == 0 else f'{text}{run.stderr}'

        todo = {key: entry for key, entry in files.items() if key not in passed}
        parsed_sets = {i: pool.submit(compile_text, f'set{i}.hpp', include_lines(SETS[i]),
                                      ['-fpch-instantiate-templates', '-x', 'c++-header', '-o', f'{folder}/set{i}.pch'])
                       for i in sorted({parsed for parsed, _ in todo.values() if parsed is not None})}
        wrong = [set_.result() for set_ in parsed_sets.values()]
        jobs = {}
        for key, (parsed, file) in todo.items():
            finds_parsed = [] if parsed is None else ['-include-pch', f'{folder}/set{parsed}.pch']
            jobs[key] = pool.submit(compile_text, f'{key}.cpp', include_lines(file), ['-fsyntax-only', *finds_parsed])
        wrong += [job.result() for job in jobs.values()]
        log.write_text('\n'.join(key for key in files if key not in jobs or not jobs[key].result()), encoding='utf-8')
    print(f'{len(headers)} headers in {len(files)} files, {len(todo)} compiled')
    print(''.join(wrong), end='')
    return 1 if any(wrong) else 0


if __name__ == '__main__':
    sys.exit(main())
