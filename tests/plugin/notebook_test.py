"""Runs a notebook's code cells in their order, as a kernel would, without Jupyter. Run by install_test.sh.

    notebook_test.py NOTEBOOK

The notebook must hold no stored outputs, so that it never shows figures of another version.
"""

import contextlib
import io
import json
import os
import sys
import tempfile
from pathlib import Path


def main(path):
    notebook = json.loads(path.read_text())
    assert notebook["nbformat"] == 4, f"nbformat: found {notebook['nbformat']}, accepted 4"
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    scope, printed = {"__name__": "__main__"}, io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(printed):
        os.chdir(folder)
        for number, cell in enumerate(cells, 1):
            assert cell["outputs"] == [] and cell["execution_count"] is None, f"code cell {number}: found stored outputs"
            exec(compile("".join(cell["source"]), f"{path.name}, code cell {number}", "exec"), scope)
        os.chdir("/")
    print(printed.getvalue(), end="")
    # the figures that the notebook's text mentions
    assert scope["largest_N"] > 10 and scope["removed_mm3"][-1] > 100, "nothing was cut"
    assert scope["mesh"]["watertight"] and scope["cut"] > 0 and scope["triangles"] > 1000
    assert scope["found"]["items"] and scope["found"]["under_m3"] > 0
    assert scope["F"][2] > 1 and scope["moved_mm"][2] < -0.01, "the bone does not give way"
    print(f"{len(cells)} code cells of {path.name} run")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
