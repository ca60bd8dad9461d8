#!/usr/bin/env python3
"""Checks that each function that the library exports is in each binding, by the table of docs/bindings.md.

    bindings_test.py SOURCE

Each name of symbols.txt has one row; a call that the table names is there, and the C function behind it is called; C#
and Python declare each function with as many parameters as osteon.h. A cell with – means that the host leaves the
function out; LEFT_OUT has the reasons.
"""

import re
import sys
from pathlib import Path

HOSTS = ("Python", "Unity", "Godot", "Unreal")
SUPERSEDED = ("osteon_bone_params_default", "osteon_tool_params_default", "osteon_settings_default",
              "osteon_plan_params_default", "osteon_guidance_params_default")
# functions that a host's users do not reach, with the reason
LEFT_OUT = {
    "Python": {**{name: "the _init of the same struct serves" for name in SUPERSEDED}},
    "Unity": {},
    "Godot": {
        **{name: "fills a struct of the plug-in's own" for name in SUPERSEDED},
        "osteon_abi": "the add-on carries its library", "osteon_result_text": "failures are texts",
        "osteon_bone_material": "the mesh has the tissues' colours",
        "osteon_session_set_log": "another thread would call a script: engine(), next_event(), last_error() instead",
    },
    "Unreal": {
        **{name: "fills a struct of the plug-in's own" for name in SUPERSEDED},
        "osteon_abi": "the plug-in carries its library", "osteon_result_text": "failures are texts",
        "osteon_bone_material": "the mesh has the tissues' colours",
        "osteon_session_set_log": "another thread would call a Blueprint: OnSceneEvent, OnRefused and the log instead",
        "osteon_session_step": "the component runs in wall time", "osteon_session_surface_wait": "a game never waits",
    },
}


def read(folder, *patterns):
    """The joined text of all files that match."""
    return "\n".join(path.read_text() for pattern in patterns for path in sorted(folder.glob(pattern)))


def count(parameters):
    """Number of parameters of a declaration; commas inside brackets do not count."""
    parameters = re.sub(r"\([^()]*\)|\[[^\[\]]*\]", "", parameters).strip()
    return 0 if parameters in ("", "void") else parameters.count(",") + 1


# The next three: number of parameters of each function that the C header, Native.cs or _library.py declares.

def header_parameters(header):
    return {name: count(text) for name, text in re.findall(r"OSTEON_API [\w ]+?[ *]+(osteon_\w+)\(([^;]*)\);", header)}


def unity_parameters(native):
    return {name: count(text) for name, text in re.findall(r"extern \w+ (osteon_\w+)\(([^;]*)\);", native)}


def python_parameters(module):
    table = module[module.index("for _name, _result, _arguments in ["):]
    return {"osteon_" + name: count(text) for name, text in re.findall(r'\("(\w+)", [\w.]+, \[(.*)\]\)', table)}


def table_rows(page):
    """The page's table: a dict of host and cell for each C function."""
    rows = {}
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| `osteon_") and len(cells) == 1 + len(HOSTS):
            name = cells[0].strip("`")
            if name in rows:
                raise SystemExit(f"docs/bindings.md: found {name} twice")
            rows[name] = dict(zip(HOSTS, cells[1:]))
    return rows


def main(source):
    plugin, failures = source / "plugin", []
    symbols = (source / "tests/plugin/symbols.txt").read_text().split()
    rows = table_rows((source / "docs/bindings.md").read_text())
    package = plugin / "unity/com.osteon.cutting"
    hosts = read(plugin, "include/osteon_host*.h")
    godot, unreal = read(plugin, "godot/src/*"), read(plugin, "unreal/OsteonCutting/Source/OsteonCutting/*/*")
    native = read(package, "Runtime/Native.cs")
    text = {"Python": read(plugin, "python/osteon/*.py"), "Unity": read(package, "Runtime/*.cs"),
            "Godot": hosts + godot, "Unreal": hosts + unreal}
    offers = {  # whether a host's users can call this name
        "Python": lambda call: re.search(rf"^ *(def|class) {call}\b", text["Python"], re.M),
        "Unity": lambda call: re.search(rf"\bpublic [^;={{(]*\b{call}\b", text["Unity"]),
        "Godot": lambda call: f'>("{call}")' in godot,
        "Unreal": lambda call: re.search(rf"U(FUNCTION|PROPERTY)\([^\n]*\)\s+[^;]*?\b{call}\b", unreal),
    }
    for name in sorted(set(symbols) - set(rows)):
        failures.append(f"docs/bindings.md has no row of {name}")
    for name in sorted(set(rows) - set(symbols)):
        failures.append(f"docs/bindings.md has a row of {name}, which the library does not show")
    for name, row in rows.items():
        for host, cell in row.items():
            left_out = name in LEFT_OUT[host]
            if (cell == "–") != left_out:
                failures.append(f"{host}: {name}: found {cell}, accepted {'–' if left_out else 'a call'} (LEFT_OUT of this test)")
            if cell == "–":
                continue
            for call in re.findall(r"`([\w.]+)`", cell) or [cell]:
                if not offers[host](call.split(".")[-1]):
                    failures.append(f"{host}: {name}: found no {call}")
            called = rf"osteon\.{name}\b|_lib\.{name}\b|\b{name}\b"
            if not re.search(called, text[host]):
                failures.append(f"{host}: {name} is called nowhere")
    wanted = header_parameters(read(plugin, "include/osteon.h"))
    for binding, found in (("Native.cs", unity_parameters(native)), ("_library.py", python_parameters(text["Python"]))):
        for name in symbols:
            if name not in wanted:
                failures.append(f"osteon.h declares no {name}")
            elif name not in found:
                if binding == "Native.cs" or name not in LEFT_OUT["Python"]:
                    failures.append(f"{binding} declares no {name}")
            elif found[name] != wanted[name]:
                failures.append(f"{binding}: {name}: found {found[name]} parameters, accepted {wanted[name]}")
    for failure in failures:
        print(failure)
    print(f"{len(symbols)} functions, {len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
