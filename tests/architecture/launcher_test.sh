#!/usr/bin/env bash
# Tests the launcher ./osteon in a made-up checkout, with stand-ins for apt, cmake, ninja and ctest that record their
# calls: what is installed and when, what reaches the built command, what stays quiet, and the answer to each obstacle.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
# The variables that the launcher reads may be set in this test's environment, by the launcher that started ctest.
unset CTEST_PARALLEL_LEVEL CMAKE_BUILD_PARALLEL_LEVEL OSTEON_DATA_DIR OSTEON_SKIP_PACKAGES OSTEON_CGROUPS
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
checkout="$work/a checkout" # with a space
fakes=$work/fakes
export FAKES=$fakes
COMMIT_STEP=$(sed -n 's/^add_custom_target(osteon_commit .*COMMENT "\(.*\)"$/\1/p' "$here/../../session/CMakeLists.txt")
export COMMIT_STEP # done in every build; the launcher does not show it
mkdir "$checkout" "$fakes" "$work/elsewhere"
cp "$here/../../osteon" "$checkout/"
printf '[run]  comment\ncompiler  # why\nlibrary-dev\n\n[test]\noracle-dev\n\n[optional]\nextra-dev\n\n[docs]\nsite-maker\n' >"$checkout/packages.txt"
printf 'ID=debian\nVERSION_ID="12"\nPRETTY_NAME="Debian GNU/Linux 12"\n' >"$work/debian"
export OSTEON_OS_RELEASE=$work/debian

# the console's page, up to date
mkdir -p "$checkout/console/web"
touch "$checkout/console/web/package-lock.json"
cat >"$checkout/console/web/build.sh" <<'F'
#!/usr/bin/env bash
echo "build.sh" >>"$FAKES/page"
[[ ! -e $FAKES/page_broken ]] || { echo "npm error network"; exit 1; }
F
chmod +x "$checkout/console/web/build.sh"

# fake NAME: makes the stand-in for a program, from a script on stdin.
fake() { cat >"$fakes/$1"; chmod +x "$fakes/$1"; }
fake npm <<'F'
#!/usr/bin/env bash
F
fake dpkg-query <<'F'
#!/usr/bin/env bash
sed 's/$/ installed/' "$FAKES/installed" 2>/dev/null; exit 1
F
fake apt-get <<'F'
#!/usr/bin/env bash
echo "apt-get $*" >>"$FAKES/calls"; echo "Setting up"
[[ ! -e /proc/$$/fd/9 ]] || echo "lock held" >>"$FAKES/calls"
if [[ -e $FAKES/apt_broken ]]; then echo "E: no network"; exit 100; fi
if [[ -e $FAKES/no_extra && $* == *extra-dev* ]]; then echo "E: Unable to locate package extra-dev"; exit 100; fi
if [[ " $* " == *" install "* ]]; then printf '%s\n' "${@##-*}" | grep -E '^(compiler|library-dev|oracle-dev|extra-dev|site-maker)$' >>"$FAKES/installed"; fi
F
fake sudo <<'F'
#!/usr/bin/env bash
[[ ! -e $FAKES/sudo_refuses ]] || exit 1
[[ $1 != -n ]] || shift
"$@"
F
fake nproc <<'F'
#!/usr/bin/env bash
cat "$FAKES/cores"
F
echo 1 >"$fakes/cores"
fake cmake <<'F'
#!/usr/bin/env bash
echo "cmake $*" >>"$FAKES/calls"; echo "-- Configuring done"
[[ ! -e /proc/$$/fd/9 ]] || echo "lock held" >>"$FAKES/calls"
while [[ $# -gt 0 ]]; do
  case $1 in -S) root=$2; shift ;; -DOSTEON_TESTS=*) tests=${1#*=} ;; esac
  shift
done
mkdir -p "$root/build/release"
printf 'CMAKE_HOME_DIRECTORY:INTERNAL=%s\nOSTEON_TESTS:BOOL=%s\n' "$root" "$tests" >"$root/build/release/CMakeCache.txt"
touch "$root/build/release/build.ninja"
F
fake ninja <<'F'
#!/usr/bin/env bash
echo "ninja $*" >>"$FAKES/calls"
[[ ! -e /proc/$$/fd/9 ]] || echo "lock held" >>"$FAKES/calls"
mkdir "$FAKES/one_at_a_time" || { echo "FAILED: two at once"; exit 1; }
trap 'rmdir "$FAKES/one_at_a_time"' EXIT
trap 'exit 2' TERM
if [[ -e $FAKES/slow ]]; then touch "$FAKES/started"; for ((i = 0; i < 300; ++i)); do sleep 0.1; [[ -e $FAKES/slow ]] || break; done; fi
if [[ -e $FAKES/broken ]]; then echo "[1/2] ok"; echo "FAILED: law.o"; echo "law.cpp:7: error: no such law"; exit 1; fi
echo "ninja: Entering directory"; echo "[1/2] $COMMIT_STEP"
if [[ ${*: -1} == osteon_studies ]]; then exit; fi
if [[ -x $2/app/osteon ]]; then exit; fi
echo "[2/2] Linking"
mkdir -p "$2/app"
# A command that still held the build's lock would keep every other launcher waiting.
# shellcheck disable=SC2016
printf '#!/usr/bin/env bash\n[[ ! -e /proc/$$/fd/9 ]] || echo "lock held"\nif [[ $1 == --executable-of ]]; then [[ $2 == tune ]] && echo osteon-studies || echo osteon; exit; fi\necho "cwd=$PWD root=$OSTEON_ROOT"; printf "<%%s>" "$@"; exit ${RC:-0}\n' >"$2/app/osteon"
chmod +x "$2/app/osteon"
F
fake ctest <<'F'
#!/usr/bin/env bash
echo "ctest $*, $CTEST_PARALLEL_LEVEL at once" >>"$FAKES/calls"; [[ ! -e /proc/$$/fd/9 ]] || echo "lock held"; echo "100% tests passed"; exit "${RC:-0}"
F
fake mkdocs <<'F'
#!/usr/bin/env bash
echo "mkdocs $*" >>"$FAKES/calls"
[[ ! -e /proc/$$/fd/9 ]] || echo "lock held" >>"$FAKES/calls"
[[ ! -e $FAKES/bad_page ]] || { echo "WARNING  -  a link to 'x.md', which is not found in the documentation files."; exit 1; }
F

failures=0
fail() { echo "FAILED: $1"; printf 'exit %s\nstdout: %s\nstderr: %s\ncalls: %s\n' "$rc" "$out" "$err" "$(calls)"; failures=1; }
calls() { cat "$fakes/calls" 2>/dev/null || true; }
as_user=() # for run: a prefix of the command

# run COMMAND …: sets rc, out and err to exit code, stdout and stderr; the count of the stand-ins' calls starts here.
run() {
  rm -f "$fakes/calls"
  rc=0
  PATH=$fakes:$PATH "${as_user[@]}" "$@" >"$work/out" 2>"$work/err" </dev/null || rc=$?
  out=$(<"$work/out") err=$(<"$work/err")
}
# expect CLAIM CONDITION …: fails this test if the condition, a command, is false.
expect() { local name=$1; shift; "$@" || fail "$name"; }
# shellcheck disable=SC2317  # called through expect
has() { [[ $1 == *"$2"* ]]; }
# shellcheck disable=SC2317
lacks() { ! has "$@"; }
# shellcheck disable=SC2317
equal() { [[ $1 == "$2" ]]; }

cd "$work/elsewhere"
run "$checkout/osteon" demo --seconds '3 s'
expect 'first start ends well' equal "$rc" 0
expect 'stdout is the command'\''s alone, in the caller'\''s folder' equal "$out" "cwd=$work/elsewhere root=$checkout
<demo><--seconds><3 s>"
expect 'the step of every build is known' test -n "$COMMIT_STEP"
expect 'its build is told of' has "$err" 'building: 2 of 2'
expect 'what the demo needs is installed' has "$(calls)" 'install --no-install-recommends compiler library-dev'
expect 'what only tests need is not' lacks "$(calls)" oracle-dev
expect 'without test packages, no tests are configured' has "$(calls)" -DOSTEON_TESTS=OFF
expect 'the command alone is built' has "$(calls)" osteon_app
expect 'no step has the lock, nor what it leaves running' lacks "$(calls)" 'lock held'

run "$checkout/osteon" demo
expect 'a second start is silent' equal "$err" ''
expect 'a cell does without the studies' lacks "$(calls)" osteon_studies
run "$checkout/osteon" tune demo
expect 'a study builds the second executable' has "$(calls)" osteon_studies
expect 'and reaches the command' has "$out" '<tune><demo>'
run "$checkout/osteon" demo
expect 'a second start asks neither apt nor cmake' equal "$(calls | cut -d' ' -f1)" ninja

ln -s "$checkout/osteon" "$work/link"
RC=1 run "$work/link"
expect 'through a link, without arguments: help' has "$out" '<--help>'
expect 'the exit code is the command'\''s' equal "$rc" 1

touch "$fakes/no_extra"
RC=8 run "$checkout/osteon" test -R 'a b'
expect 'an optional package that is not to be had stops nothing' has "$err" 'extra-dev is not to be had'
expect 'tests bring their packages' has "$(calls)" 'install --no-install-recommends oracle-dev'
expect 'tests are configured' has "$(calls)" -DOSTEON_TESTS=ON
expect 'ctest gets the arguments' has "$(calls)" "ctest --test-dir $checkout/build/release --output-on-failure -R a b"
expect 'as many at once as there are cores' has "$(calls)" ', 1 at once'
expect 'the exit code is ctest'\''s' equal "$rc" 8
expect 'the closing line is ctest'\''s' equal "$out" '100% tests passed'
rm "$fakes/no_extra"
run "$checkout/osteon" test
expect 'and is not asked for again' lacks "$(calls)" extra-dev
rm "$checkout/build/.not_installed"
run "$checkout/osteon" test
expect 'an optional package that is to be had is installed' has "$(calls)" 'install --no-install-recommends extra-dev'
CMAKE_BUILD_PARALLEL_LEVEL=16 run "$checkout/osteon" test
expect 'but four at most' has "$(calls)" ', 4 at once'
CTEST_PARALLEL_LEVEL=7 run "$checkout/osteon" test
expect 'a number that was given stays' has "$(calls)" ', 7 at once'
run "$checkout/osteon" demo
expect 'the demo keeps the tests'\'' configuration' equal "$(calls | cut -d' ' -f1)" ninja

touch "$fakes/page_broken"
run "$checkout/osteon" demo
expect 'a cell runs without its page' equal "$rc" 0
expect 'and it is said' has "$err" "page could not be built"
rm -f "$fakes/page"
run "$checkout/osteon" demo
expect 'once: it is not tried again within the hour' equal "$err" ''
touch -d '2 hours ago' "$checkout/build/release/console/.refused"
rm "$fakes/page_broken"
run "$checkout/osteon" demo
expect 'but later it is' test -s "$fakes/page"
rm "$fakes/page"
run "$checkout/osteon" tune demo
expect 'a study needs no page' test ! -e "$fakes/page"
run "$checkout/osteon" cell demo
expect 'a simulated cell alone has its page' test -s "$fakes/page"

run "$checkout/osteon" docs
expect 'the site brings its packages' has "$(calls)" 'install --no-install-recommends site-maker'
expect 'the site is made of its configuration' has "$(calls)" "mkdocs build --strict --clean --config-file $checkout/mkdocs.yml"
expect 'its first page is named' equal "$out" "$checkout/build/site/index.html"
expect 'nothing is compiled for it' lacks "$(calls)" ninja
run "$checkout/osteon" docs extra
expect 'the site takes no arguments' equal "$rc" 2
expect 'and says which it was given' has "$err" "found 'extra'"
touch "$fakes/bad_page"
run "$checkout/osteon" docs
expect 'a page that is not right exits 2' equal "$rc" 2
expect 'and the reason is shown' has "$err" 'not found in the documentation files'
rm "$fakes/bad_page"

touch "$fakes/broken"
run "$checkout/osteon" demo
expect 'a failed build exits 2' equal "$rc" 2
expect 'and shows the error' has "$err" 'law.cpp:7: error: no such law'
expect 'and where the log is' has "$err" "$checkout/build/osteon.log"
expect 'and runs nothing' equal "$out" ''
rm "$fakes/broken"

# Two launchers at once take turns: the stand-in for ninja fails if two run at once.
touch "$fakes/slow"
PATH=$fakes:$PATH "$checkout/osteon" one >"$work/one" 2>&1 &
for ((i = 0; i < 100; ++i)); do [[ ! -e $fakes/started ]] || break; sleep 0.1; done
PATH=$fakes:$PATH "$checkout/osteon" two >"$work/two" 2>&1 &
for ((i = 0; i < 100; ++i)); do ! grep -q waiting "$work/two" || break; sleep 0.1; done
rm "$fakes/slow" "$fakes/started"
wait
rc=- out=$(<"$work/one") err=$(<"$work/two")
expect 'the first of two runs' has "$out" '<one>'
expect 'the second says that it waits, then runs' equal "$(sed -n 's/.*waiting.*/waits/p; s/^<two>$/runs/p' <<<"$err")" $'waits\nruns'

# After an end in the middle of a build (Ctrl-C; here SIGTERM, as background jobs ignore SIGINT) it starts as usual.
touch "$fakes/slow"
PATH=$fakes:$PATH setsid "$checkout/osteon" demo >"$work/out" 2>"$work/err" &
stopped=$!
for ((i = 0; i < 100; ++i)); do [[ ! -e $fakes/started ]] || break; sleep 0.1; done
kill -TERM -- "-$stopped"
rc=0
wait "$stopped" || rc=$?
rm -f "$fakes/slow" "$fakes/started"
out=$(<"$work/out") err=$(<"$work/err")
expect 'interrupted: exit 130' equal "$rc" 130
expect 'interrupted: says so' has "$err" interrupted
run "$checkout/osteon" demo
expect 'after an interruption the next start works' has "$out" '<demo>'

# `clean` removes the lock's file while another launcher waits: that one starts over, with a lock that others see.
exec 8>"$checkout/build/.lock"
flock 8
PATH=$fakes:$PATH "$checkout/osteon" demo >"$work/out" 2>"$work/err" 8>&- &
for ((i = 0; i < 100; ++i)); do ! grep -q waiting "$work/err" || break; sleep 0.1; done
rm -rf "$checkout/build"
exec 8>&-
rc=0
wait "$!" || rc=$?
out=$(<"$work/out") err=$(<"$work/err")
expect 'who waited for a build that was removed: exit 0' equal "$rc" 0
expect 'who waited for a build that was removed builds anew' has "$out" '<demo>'
expect 'and under a lock that others see' test -e "$checkout/build/.lock"

# A container's memory, which /proc/meminfo does not show: 5.0 GB minus 2.0 GB in use, 0.5 GB of them file cache.
mkdir "$work/cgroups"
echo 5000000000 >"$work/cgroups/memory.max"
echo 2000000000 >"$work/cgroups/memory.current"
printf 'anon 1\ninactive_file 500000000\n' >"$work/cgroups/memory.stat"
echo 8 >"$fakes/cores"
OSTEON_CGROUPS=$work/cgroups run "$checkout/osteon" demo
expect 'as many compilers as the control group has memory for' has "$(calls)" '-j 2 '
echo max >"$work/cgroups/memory.max"
OSTEON_CGROUPS=$work/cgroups run "$checkout/osteon" demo
expect 'a control group without a limit limits nothing' lacks "$(calls)" '-j 2 '
echo 1 >"$fakes/cores"

# Another release has other versions under the same names.
printf 'ID=ubuntu\nVERSION_ID="24.04"\nPRETTY_NAME="Ubuntu 24.04 LTS"\n' >"$work/ubuntu"
OSTEON_OS_RELEASE=$work/ubuntu run "$checkout/osteon" demo
expect 'another release where nothing is missing: it runs' has "$out" '<demo>'
mv "$fakes/installed" "$fakes/kept"
OSTEON_OS_RELEASE=$work/ubuntu run "$checkout/osteon" demo
expect 'another release: exit 2' equal "$rc" 2
expect 'another release: its name' has "$err" 'Ubuntu 24.04 LTS, not Debian 12'
expect 'another release: nothing installed' equal "$(calls)" ''
mv "$fakes/kept" "$fakes/installed"

# A run as root leaves files that the owner cannot overwrite.
if [[ $EUID -eq 0 ]]; then
  chmod a+rx "$work"
  chmod -R a+rwX "$fakes"
  chown -R 65534 "$checkout"
  chown -R 0 "$checkout/build"
  as_user=(setpriv --reuid 65534 --clear-groups)
  run "$checkout/osteon" demo
  expect 'after a run as root: exit 2' equal "$rc" 2
  expect 'after a run as root: whose it is' has "$err" "cannot write to $checkout/build: it belongs to root"
  expect 'after a run as root: what to do' has "$err" "sudo chown -R"
  as_user=()
  chown -R 0 "$checkout"
fi

mv "$checkout" "$work/moved"
checkout=$work/moved
run "$checkout/osteon" demo
expect 'a checkout that moved is configured afresh' has "$(calls)" "cmake --fresh -S $checkout"

: >"$fakes/installed"
touch "$fakes/apt_broken"
run "$checkout/osteon" demo
expect 'a failed installation exits 2' equal "$rc" 2
expect 'with apt'\''s words' has "$err" 'E: no network'
rm "$fakes/apt_broken"

# Without rights: prints the one command to run.
touch "$fakes/sudo_refuses"
chmod -R a+rwX "$work"
if [[ $EUID -eq 0 ]]; then as_user=(setpriv --reuid 65534 --clear-groups); fi
run "$checkout/osteon" demo
expect 'without rights: exit 2' equal "$rc" 2
expect 'without rights: the line to run' has "$err" 'apt-get install -y --no-install-recommends compiler library-dev'
expect 'without rights: nothing tried' equal "$(calls)" ''

# Not Debian: a PATH with neither dpkg-query nor apt-get.
mkdir "$work/bin"
for tool in bash env dirname readlink mkdir stat id flock sed sort comm paste fold wc cut grep tac head tail nproc awk cat stty rm; do
  ln -s "$(command -v "$tool")" "$work/bin/$tool"
done
for tool in cmake ninja; do ln -s "$fakes/$tool" "$work/bin/"; done
as_user=(env "PATH=$work/bin")
run "$checkout/osteon" demo
expect 'not Debian: exit 2' equal "$rc" 2
expect 'not Debian: the packages by name' has "$err" 'compiler library-dev'
as_user=(env "PATH=$work/bin:$PATH" OSTEON_SKIP_PACKAGES=1)
run "$checkout/osteon" demo
expect 'not Debian, equivalents installed: it runs' has "$out" '<demo>'

as_user=()
expect 'there is a build to remove' test -e "$checkout/build"
run "$checkout/osteon" clean
expect 'clean exits 0' equal "$rc" 0
expect 'clean removes build/' test ! -e "$checkout/build"

# A checkout that cannot be written. Root can write everywhere, so root changes to another user first.
chmod a-w "$checkout"
if [[ $EUID -eq 0 ]]; then as_user=(setpriv --reuid 65534 --clear-groups); fi
run "$checkout/osteon" demo
expect 'a read-only checkout: exit 2' equal "$rc" 2
expect 'a read-only checkout: says what is wrong' has "$err" "cannot write to $checkout"
chmod u+w "$checkout"

exit "$failures"
