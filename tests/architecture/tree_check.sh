#!/usr/bin/env bash
# tree_check.sh CHECK ROOT [BUILD]: one check of the whole tree. Exit 0 passed, 1 failed (one place a line), 77 skipped.
#
#   format   C++ is as clang-format leaves it           shell    shell scripts are shellcheck-clean
#   paths    no file names a folder of one machine      headers  every header compiles alone (BUILD: CMake's binary folder)
set -euo pipefail
check=$1 root=$2 build=${3:-} here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
cd "$root"

# Lists the tree's files as git has them; without git (an unpacked archive) all but builds, results, hidden folders. What
# others wrote (third_party/) stays as they wrote it.
tree_files() { all_files "$@" | grep -zv '/third_party/' || true; }
all_files() {
  if [[ -e .git ]] && command -v git >/dev/null; then
    # Untracked files count too, so that the check works before the commit. The checkout may belong to another owner.
    git -c safe.directory='*' ls-files -z --cached --others --exclude-standard -- "$@"
  else
    local names=() name
    for name in "$@"; do names+=(${names[@]+-o} -name "$name"); done
    find . \( -path './.?*' -o -path ./build -o -path './*out' \) -prune -o -type f \( "${names[@]:--true}" \) -printf '%P\0'
  fi
}

# Only files that still exist: git also lists files that were deleted in the working tree.
existing() { while IFS= read -r -d '' f; do if [[ -f $f ]]; then printf '%s\0' "$f"; fi; done; }

need() { command -v "$1" >/dev/null || { echo "skipped: no $1 here (packages.txt, section test)"; exit 77; }; }

case $check in
  format)
    need clang-format
    if ! found=$(tree_files '*.h' '*.cpp' | existing | xargs -0 -r clang-format --dry-run -Werror 2>&1); then
      # One line per file: the place of the first difference.
      grep -E ': (error|warning): ' <<<"$found" | sort -s -u -t: -k1,1 || printf '%s\n' "$found"
      echo "clang-format -i those files (.clang-format holds the style)"
      exit 1
    fi
    ;;
  shell)
    need shellcheck
    mapfile -d '' -t files < <(tree_files | existing)
    scripts=()
    for f in "${files[@]}"; do
      first=''
      IFS= read -r -n 64 first <"$f" 2>/dev/null || true
      if [[ $f == *.sh || $first =~ ^'#!'.*[/\ ](ba|da)?sh$ ]]; then scripts+=("$f"); fi
    done
    [[ ${#scripts[@]} -gt 0 ]] || { echo "no shell script found in $root"; exit 1; }
    shellcheck "${scripts[@]}"
    ;;
  paths)
    # Written so that this line does not match itself. Temporary folders come from mktemp or TempDir().
    pattern='(^|[^A-Za-z0-9._~}/-])/(wor[k]|tm[p]|hom[e]|roo[t])/[A-Za-z0-9_.]'
    if tree_files | existing | xargs -0 -r grep -nIE -- "$pattern" /dev/null; then
      echo "paths of one machine: take them from an argument, the environment, or the file's own place"
      exit 1
    fi
    ;;
  headers)
    need python3
    need clang++
    mapfile -t headers < <(tree_files '*.h' | existing | tr '\0' '\n' | grep -v '^tests/' | sort -u)
    mapfile -t unlisted < <(printf '%s\n' "${headers[@]}" | comm -23 - <(sort -u "$build/listed_headers.txt"))
    [[ ${#unlisted[@]} -eq 0 ]] || {
      printf '%s:1: in neither HEADERS nor PRIVATE_HEADERS of an osteon_library(), nor in an osteon_list_headers()\n' "${unlisted[@]}"
      exit 1
    }
    printf '%s\n' "${headers[@]}" | "$here/headers_alone.py" "$root" "$build"
    ;;
  *)
    echo "tree_check.sh: found '$check', accepted format, shell, paths or headers" >&2
    exit 2
    ;;
esac
