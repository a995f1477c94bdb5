#!/usr/bin/env bash
# Tests run, test and ensure.sh with a fake apt, sudo, cmake and ninja in front: nothing is installed, nothing is built.
set -u
source_root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd -P)
box=$(mktemp -d) && box=$(cd "$box" && pwd -P) || exit 1
trap 'rm -rf "$box"' EXIT
unset CI KERF_SCENES
failures=0 checks=0

# A checkout with a space in its name.
root="$box/check out"
mkdir -p "$root/scripts" "$box/fake" "$box/plain" "$box/elsewhere"
cp "$source_root/run" "$source_root/test" "$source_root/CMakeLists.txt" "$root/"
cp "$source_root/scripts/ensure.sh" "$source_root/scripts/packages.tsv" "$root/scripts/"

# What the fakes know: the files installed, unknown, uid; what they were asked: calls.
fake() { cat >"$box/fake/$1" && chmod +x "$box/fake/$1"; }
export BOX=$box KERF_APT_LISTS=$box/apt
fake id <<'END'
#!/bin/sh
cat "$BOX/uid"
END
fake dpkg-query <<'END'
#!/bin/sh
for p; do grep -qx -e "$p" "$BOX/installed" && echo "installed $p"; done
exit 1
END
fake apt-get <<'END'
#!/bin/sh
echo "apt-get $*" >>"$BOX/calls"
case $1 in
  -s) shift 3; for p; do grep -qx -e "$p" "$BOX/unknown" && echo "E: Unable to locate package $p" || echo "Inst $p (1 here)"; done ;;
  update)
    [ -e "$BOX/offline" ] && { echo "W: Failed to fetch"; exit 0; }
    touch "$BOX/apt/main_Packages"
    [ -e "$BOX/lists" ] && cp "$BOX/lists" "$BOX/unknown" ;;
  install)
    [ "${DEBIAN_FRONTEND:-}" = noninteractive ] || echo "no DEBIAN_FRONTEND" >>"$BOX/calls"
    if [ -e "$BOX/broken" ]; then echo "E: the mirror is gone"; exit 100; fi ;;
esac
exit 0
END
fake apt-cache <<'END'
#!/bin/sh
shift 2
for p; do printf 'Package: %s\nInstalled-Size: 2000\nSize: 1000000\n\n' "$p"; done
END
fake sudo <<'END'
#!/bin/sh
[ "$1" = -v ] && exit 0
if [ "$1" = -n ]; then [ -e "$BOX/passwordless" ]; exit; fi
echo sudo >>"$BOX/calls"
exec "$@"
END
fake cmake <<'END'
#!/bin/sh
echo "cmake $*" >>"$BOX/calls"
echo "-- noise of cmake"; echo "-- kerf: embree not found: no oracle"
[ -e "$BOX/no-configure" ] && exit 1
dir="$2/build/release"; mkdir -p "$dir" && touch "$dir/build.ninja"
printf 'CMAKE_HOME_DIRECTORY:INTERNAL=%s\nCMAKE_CACHEFILE_DIR:INTERNAL=%s\n' "$2" "$dir" >"$dir/CMakeCache.txt"
END
fake ninja <<'END'
#!/bin/sh
echo "ninja $3" >>"$BOX/calls"
echo "noise of ninja"
[ -e "$BOX/no-build" ] && { echo "error: it does not compile"; exit 1; }
mkdir -p "$2/bin"
printf '#!/bin/sh\necho "$(pwd)|$*"\ncat\nexit 7\n' >"$2/bin/kerf" && chmod +x "$2/bin/kerf"
END
fake ctest <<'END'
#!/bin/sh
for last; do :; done
printf '<?xml version="1.0"?>\n<testsuite name="x"\n\ttests="9"\n\tfailures="1"\n\tdisabled="1"\n\tskipped="2"\n\ttimestamp="x"\n>\n<testcase name="failures">\n<skipped message="SKIP_RETURN_CODE=77"/>\n<skipped message="Unable to find executable"/>\n</testsuite>\n' >"$last"
echo "ctest $*" >>"$BOX/calls"
exit 8
END

# A system without apt: only the commands that the scripts use.
for command in bash sh awk sed grep cat dirname readlink mkdir rm tr wc tee env head sort nproc flock touch chmod; do
  path=$(command -v "$command") && ln -s "$path" "$box/plain/$command"
done

# begin WHAT: a fresh system with nothing installed, for a user who is not root.
begin() {
  what=$1
  rm -rf "$root/build" "$box"/{calls,lists,apt,broken,offline,passwordless,no-configure,no-build}
  mkdir "$box/apt" && touch "$box/apt/main_Packages"
  : >"$box/calls"
  : >"$box/installed"
  : >"$box/unknown"
  echo 1000 >"$box/uid"
}
all_of() { awk -F '\t' -v g=" $* " '!/^#/ && index(g, " " $1 " ") { print $3 }' "$root/scripts/packages.tsv"; }

# go COMMAND...: from another folder, without a terminal; leaves $status, $out, $err.
go() {
  status=0
  (cd "$box/elsewhere" && PATH="$box/fake:$PATH" "$@") </dev/null >"$box/out" 2>"$box/err" || status=$?
  out=$(cat "$box/out") err=$(cat "$box/err")
}
check() {
  checks=$((checks + 1))
  "$@" && return
  failures=$((failures + 1))
  printf 'FAILED: %s: %s\n  status: %s\n  out: %s\n  err: %s\n  calls: %s\n' "$what" "$*" "$status" "$out" "$err" "$(cat "$box/calls")"
}
is() { [ "$1" = "$2" ]; }
says() { grep -qF -e "$2" <<<"$1"; }
called() { grep -qxF -e "$1" "$box/calls"; }
not() { ! "$@"; }
installs() { grep -qF -e "apt-get install" "$box/calls"; }

begin "nothing missing"
all_of run >"$box/installed"
go "$root/run" a "b c"
check is "$status" 7
check is "$out" "$box/elsewhere|a b c"
check not says "$err" missing
check not says "$err" noise
check not grep -q apt-get "$box/calls"

what="the second time is quiet and looks at nothing else"
: >"$box/calls"
go "$root/run" --yes --version
check is "$out" "$box/elsewhere|--version"
check is "$err" ""
check is "$(cat "$box/calls")" "ninja kerf_cli"

what="no argument renders the bundled scene; standard input is the program's; a symlink will do"
ln -sf "$root/run" "$box/elsewhere/link"
(cd "$box/elsewhere" && echo input | PATH="$box/fake:$PATH" CDPATH=$box bash link) >"$box/out" 2>"$box/err"
check is "$(cat "$box/out")" "$box/elsewhere|render $root/scenes/pavilion.yaml --size 720x480 --spp 16 --compare binned_sah"$'\n'input

what="the build folder of another checkout"
sed -i.bak 's|^CMAKE_HOME_DIRECTORY.*|CMAKE_HOME_DIRECTORY:INTERNAL=/nowhere|' "$root/build/release/CMakeCache.txt"
go "$root/run" a
check called "cmake -S $root --preset release --fresh"
check is "$status" 7

what="a build that fails shows its log"
touch "$box/no-build"
go "$root/run" a
check is "$status" 1
check is "$out" ""
check says "$err" "it does not compile"

begin "no terminal, no root: says the line, installs nothing"
grep -vx -e cmake -e ninja-build <(all_of run) >"$box/installed"
go "$root/run" --version
check is "$status" 1
check says "$err" "  sudo apt-get install --no-install-recommends cmake ninja-build"
check says "$err" "2 packages: 3 MB to download, 5 MB on disk"
check not installs
check is "$out" ""

begin "no terminal, no root, --yes, but sudo wants a password"
go "$root/run" --yes --version
check is "$status" 1
check not installs

begin "--yes with a sudo that wants none"
touch "$box/passwordless"
go "$root/run" --yes --version
check called sudo
check installs
check is "$status" 7

begin "CI=true as root installs exactly what is missing"
echo 0 >"$box/uid"
grep -vx -e cmake -e libhwy-dev <(all_of run) >"$box/installed"
go env CI=true "$root/run" --version
check called "apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=600 cmake libhwy-dev"
check not called sudo
check not called "no DEBIAN_FRONTEND"
check is "$out" "$box/elsewhere|--version"

begin "root without a terminal: nobody to ask, as in a container"
echo 0 >"$box/uid"
go "$root/run" --version
check installs
check is "$status" 7

begin "./test needs more, ./test --all most"
echo 0 >"$box/uid"
go "$root/test" --yes --packages-only
check grep -q "apt-get install .*libgtest-dev" "$box/calls"
check not grep -q "apt-get install .*clang-tidy" "$box/calls"
go "$root/test" --yes --all --packages-only
check grep -q "apt-get install .*clang-tidy" "$box/calls"

begin "no package lists: update first"
echo 0 >"$box/uid"
all_of run >"$box/unknown"
: >"$box/lists"
go "$root/run" --yes --version
check called "apt-get update"
check installs
check is "$status" 7

begin "no package lists, and only an optional one missing: not taken for unknown"
echo 0 >"$box/uid"
rm "$box/apt/main_Packages"
grep -vx -e libstb-dev <(all_of run) >"$box/installed"
echo libstb-dev >"$box/unknown"
: >"$box/lists"
go "$root/run" --yes --version
check called "apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=600 libstb-dev"

begin "no package lists, no network"
echo 0 >"$box/uid"
rm "$box/apt/main_Packages"
all_of run >"$box/unknown"
touch "$box/offline"
go "$root/run" --yes --version
check is "$status" 1
check says "$err" "W: Failed to fetch"
check says "$err" "apt-get update failed"

begin "no package lists, no root"
all_of run >"$box/unknown"
go "$root/run" --version
check is "$status" 1
check says "$err" "  sudo apt-get update && sudo apt-get install --no-install-recommends g++ cmake"

begin "an optional package that apt does not know is left out"
echo 0 >"$box/uid"
echo libstb-dev >"$box/unknown"
grep -vx -e libstb-dev -e libfmt-dev <(all_of run) >"$box/installed"
go "$root/run" --yes --version
check called "apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=600 libfmt-dev"
check says "$err" "going on without: libstb-dev"
check is "$status" 7

begin "a needed package that apt does not know"
echo 0 >"$box/uid"
echo libhwy-dev | tee "$box/unknown" >"$box/lists"
go "$root/run" --yes --version
check is "$status" 1
check says "$err" "apt knows no package named libhwy-dev"
check not installs

begin "apt fails"
echo 0 >"$box/uid"
touch "$box/broken"
go "$root/run" --yes --version
check is "$status" 1
check says "$err" "the mirror is gone"
check says "$err" "apt-get install failed"

# ask ANSWER: on a terminal.
ask() {
  status=0
  (cd "$box/elsewhere" && echo "$1" | PATH="$box/fake:$PATH" SHELL=/bin/bash script -qec "'$root/run' a" /dev/null) >"$box/out" 2>&1 || status=$?
  out=$(cat "$box/out") err=""
}
if script -qec true /dev/null </dev/null >/dev/null 2>&1; then
  begin "asked on a terminal: no"
  ask n
  check says "$out" "install now?"
  check says "$out" "  sudo apt-get install"
  check not installs
  check is "$status" 1
  begin "asked on a terminal: yes"
  ask y
  check installs
  check called sudo
  check is "$status" 7
fi

# go_plain COMMAND...: without apt, with the fakes that are linked in.
go_plain() {
  status=0
  (cd "$box/elsewhere" && PATH="$box/plain" "$@") </dev/null >"$box/out" 2>"$box/err" || status=$?
  out=$(cat "$box/out") err=$(cat "$box/err")
}
begin "no apt, no CMake: names for Fedora, Arch and Homebrew"
go_plain "$root/run" --version
check is "$status" 1
check grep -Eq 'ninja-build +needed +ninja-build +ninja +ninja ' "$box/err"
check grep -Eq 'g\+\+ +needed +gcc-c\+\+ +gcc +- ' "$box/err"
check is "$(cat "$box/calls")" ""

begin "no apt, but the commands: goes on; where CMake fails, the names"
for command in cmake ninja; do ln -s "$box/fake/$command" "$box/plain/$command"; done
ln -s "$box/fake/cmake" "$box/plain/c++"
go_plain "$root/run" --version
check is "$status" 7
rm -rf "$root/build"
touch "$box/no-configure"
go_plain "$root/run" --version
check is "$status" 1
check says "$err" "configuring failed"

begin "./test counts, and fails with its tests"
all_of run test >"$box/installed"
go env KERF_SCENES=here "$root/test" -R "Box stays whole"
check is "$out" "5 passed, 2 failed, 2 skipped"
check is "$status" 8
check says "$err" "kerf: embree not found: no oracle"
check grep -q -e "-LE large -R Box stays whole" "$box/calls"
go "$root/test" --help
check is "$status" 0
check says "$out" "Usage: ./test"

[ "$failures" = 0 ] && echo "$checks checks passed" || echo "$failures of $checks checks failed"
[ "$failures" = 0 ]
