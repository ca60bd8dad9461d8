"""Shipped YAML against the schemas that `osteon schema` makes, by the package jsonschema.

schema_test.py OSTEON SOURCES: the built command, the checkout.
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

import jsonschema
import yaml

command, sources = sys.argv[1], pathlib.Path(sys.argv[2])
config = sources / "config"
# folders below config/, and the schema of their files
kinds = {"cells": "cell", "robots": "robot", "tools": "tool", "scenes": "scene", "materials": "materials",
         "scenarios": "scenario", "sweeps": "sweep", "plans": "plan", "rubrics": "rubric"}
wrong = []


def errors(schema, value):
    """Lists the violations of a schema, each with its key."""
    return [f"{'.'.join(map(str, e.absolute_path))}: {e.message[:200]}"
            for e in jsonschema.Draft7Validator(schema).iter_errors(value)]


def expect(condition, text):
    """Remembers the text as a failure unless the condition holds."""
    if not condition:
        wrong.append(text)


with tempfile.TemporaryDirectory() as schema_folder:
    subprocess.run([command, "--config-root", config, "schema", "--out", schema_folder], check=True,
                   stdout=subprocess.DEVNULL)
    schemas = {file.stem: file.read_text() for file in pathlib.Path(schema_folder).iterdir()}
for name, text in schemas.items():
    shipped = config / "schemas" / f"{name}.json"
    expect(shipped.is_file() and shipped.read_text() == text,
           f"config/schemas/{name}.json is not what the readers say: osteon schema --out config/schemas")
schemas = {name: json.loads(text) for name, text in schemas.items()}
for schema in schemas.values():
    jsonschema.Draft7Validator.check_schema(schema)

count = 0
for folder, kind in kinds.items():
    for file in sorted((config / folder).glob("*.yaml")):
        text = file.read_text()
        for error in errors(schemas[kind], yaml.safe_load(text)):
            wrong.append(f"{folder}/{file.name}: {error}")
        expect(text.startswith(f"# yaml-language-server: $schema=../schemas/{kind}.json\n"),
               f"{folder}/{file.name}: does not begin with its schema")
        count += 1
expect(count > 60, f"only {count} files")

# values that the program refuses must fail the schema too
demo = yaml.safe_load((config / "cells/demo.yaml").read_text())


def refused(change, schema="cell", of=demo):
    """The schema's errors in a copy of a valid file to which the change was applied."""
    value = copy.deepcopy(of)
    change(value)
    return errors(schemas[schema], value)


expect(refused(lambda c: c["limits"].update(max_force_N=2000)), "a force beyond the ceiling passes")
expect(refused(lambda c: c["limits"].update(max_fore_N=200)), "an unknown key passes")
expect(refused(lambda c: c["limits"].pop("max_force_N")), "a missing key passes")
expect(refused(lambda c: c["script"].pop("whirl_period_s")), "a reaming script without its period passes")
expect(refused(lambda c: c["script"].update(peck_count=1)), "a drilling's key passes in a reaming script")
expect(refused(lambda c: c["fri"].update(version="1.17")), "an unknown version passes")
expect(refused(lambda c: c["workspace"].update(sphere_center_mm=[0, 0])), "two of three numbers pass")
short = {"extends": "demo", "limits": {"max_force_N": 80}}
expect(not errors(schemas["cell"], short), "a short cell does not pass")
expect(refused(lambda c: c["limits"].update(max_fore_N=80), of=short), "an unknown key passes in a short cell")

print("\n".join(wrong) or f"{count} files and {len(schemas)} schemas")
sys.exit(1 if wrong else 0)
