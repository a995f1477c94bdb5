# shellcheck shell=bash
# Sourced by run, test and .ci/run: packages, configuring, building, counting results. Everything here talks on standard
# error; standard output belongs to the program or to the tests. Kept to bash 3.2, which is what macOS has.

set -u
unset CDPATH
export PATH # a bash started without PATH has one of its own, which cmake and ninja would not see
kerf_root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd -P)
kerf_yes=
[ "${CI:-}" = true ] && kerf_yes=1

say() { printf 'kerf: %s\n' "$*" >&2; }
die() {
  say "$@"
  exit 1
}
has() { command -v "$1" >/dev/null 2>&1; }

# ---- Steps: one at a time, logged to build/NAME.log

# One line that changes while a step runs.
show_last_line() {
  local line
  while IFS= read -r line; do printf '\r\033[K%s' "${line:0:78}"; done
  printf '\r\033[K'
}

# step NAME COMMAND...: no standard input (it is the program's), descriptor 9 closed (a compiler cache that stays alive
# would keep the lock).
step() {
  local log=$kerf_root/build/$1.log
  shift
  mkdir -p "$kerf_root/build" || die "cannot write to $kerf_root/build"
  if [ -t 2 ]; then
    "$@" </dev/null 2>&1 9>&- | tee "$log" 9>&- | show_last_line >&2
    return "${PIPESTATUS[0]}"
  fi
  "$@" </dev/null >"$log" 2>&1 9>&-
}

show_log() { cat "$kerf_root/build/$1.log" >&2; }

# ---- Packages

# rows COLUMN GROUP...: the words of one column of packages.tsv, each once.
rows() {
  local column=$1
  shift
  awk -F '\t' -v column="$column" -v groups=" $* " '
    /^#/ { next }
    !names { for (i = 1; i <= NF; i++) at[$i] = i; names = 1; next }
    index(groups, " " $at["group"] " ") && $at[column] != "-" && !seen[$at[column]]++ { print $at[column] }
  ' "$kerf_root/scripts/packages.tsv"
}

# cell APT COLUMN: one field of the row of a package.
cell() {
  awk -F '\t' -v apt="$1" -v column="$2" '
    /^#/ { next }
    !names { for (i = 1; i <= NF; i++) at[$i] = i; names = 1; next }
    $at["apt"] == apt { print $at[column] }
  ' "$kerf_root/scripts/packages.tsv"
}

# without "WORDS" "THESE": the words that are not among these.
without() {
  local word left=
  for word in $1; do
    case " $2 " in *" $word "*) ;; *) left="$left $word" ;; esac
  done
  printf '%s\n' "${left# }"
}

# ensure_packages GROUP...: returns when all are there (or apt has never heard of them and they are optional).
ensure_packages() {
  if has apt-get && has dpkg-query; then
    ensure_with_apt "$@"
  else
    ensure_without_apt "$@"
  fi
}

# The other folder is for test_ensure.sh.
has_lists() { compgen -G "${KERF_APT_LISTS:-/var/lib/apt/lists}/*_Packages*" >/dev/null; }

simulate() { LC_ALL=C apt-get -s install --no-install-recommends "$@" 2>&1; }

# unknown_to_apt SIMULATION: the packages that apt has never heard of.
unknown_to_apt() {
  sed -n -e 's/^E: Unable to locate package //p' \
    -e "s/^E: Package '\(.*\)' has no installation candidate/\1/p" <<<"$1" | tr '\n' ' '
}

# needed PACKAGE...: those that Kerf cannot do without.
needed() {
  local package
  for package; do [ "$(cell "$package" need)" != needed ] || printf '%s ' "$package"; done
}

# shellcheck disable=SC2086  # lists of package names: split on purpose
ensure_with_apt() {
  local wanted installed missing unknown become="" simulation line
  wanted=$(rows apt "$@" | tr '\n' ' ')
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p' | tr '\n' ' ')
  missing=$(without "$wanted" "$installed")
  [ -n "$missing" ] || return 0

  # become: what stands before apt-get; "no" if there is no way to become root from here.
  local terminal="" prefix="sudo "
  on_terminal && terminal=1
  if [ "$(id -u)" = 0 ]; then
    prefix=
  elif ! has sudo; then
    become=no prefix=root:
  elif [ -n "$terminal" ] || { [ -n "$kerf_yes" ] && sudo -n true 2>/dev/null; }; then
    become=sudo
  else
    become=no
  fi

  # Fresh systems and containers have no package lists, or not the right ones: there is nothing to ask about yet.
  local update=
  simulation=$(simulate $missing)
  unknown=$(unknown_to_apt "$simulation")
  if ! has_lists || [ -n "$(needed $unknown)" ]; then
    update=1
    if [ "$become" != no ]; then
      say "reading the package lists (apt-get update)"
      # Without a network apt-get update only warns.
      { as_root update apt-get update && has_lists; } || apt_failed update
      update=
      simulation=$(simulate $missing)
      unknown=$(unknown_to_apt "$simulation")
    fi
  fi
  if [ -n "$unknown" ] && [ -z "$update" ]; then
    [ -z "$(needed $unknown)" ] || die "apt knows no package named $(needed $unknown)(for: $*); this system is too old or too new"
    say "not known to apt here, going on without: $unknown"
    missing=$(without "$missing" "$unknown")
    [ -n "$missing" ] || return 0
    simulation=$(simulate $missing)
  fi

  line="${prefix}apt-get install --no-install-recommends $missing"
  [ -z "$update" ] || line="${prefix}apt-get update && $line"
  [ "$prefix" != root: ] || line="su -c '${line//root:/}'"

  say "missing: $missing"
  [ -n "$update" ] || say "$(sizes "$simulation")"
  if [ "$become" = no ]; then
    say "to install, type:"
    printf '  %s\n' "$line" >&2
    exit 1
  fi
  if [ -n "$terminal" ] && [ -z "$kerf_yes" ]; then
    case $(ask "install now? [Y/n]") in
      yes | [Yy]*) ;;
      *)
        say "nothing was installed; to do it yourself, type:"
        printf '  %s\n' "$line" >&2
        exit 1
        ;;
    esac
  fi
  say "installing"
  local install="as_root install apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=600 $missing"
  # Lists that are some weeks old name files that the mirror no longer has.
  $install || { as_root update apt-get update && $install; } || apt_failed install
}

# Standard input may be the program's and standard error a file, with somebody there all the same.
on_terminal() { [ -t 0 ] || [ -t 2 ]; }

# ask QUESTION: the answer; yes if it is empty.
ask() {
  local answer
  { printf 'kerf: %s ' "$1" >/dev/tty && read -r answer </dev/tty; } 2>/dev/null || answer=no
  printf '%s\n' "${answer:-yes}"
}

# sizes SIMULATION: what apt would fetch and unpack. Summed from its records: apt-get itself tells only when it is about
# to install, and then it does not always ask.
sizes() {
  local names
  names=$(sed -n 's/^Inst \([^ ]*\) .*/\1/p' <<<"$1")
  # shellcheck disable=SC2086
  LC_ALL=C apt-cache show --no-all-versions $names 2>/dev/null | awk -v n="$(wc -w <<<"$names")" '
    /^Size:/ { download += $2 }
    /^Installed-Size:/ { disk += $2 }
    END {
      if (download) printf "with all they need %d package%s: %d MB to download, %d MB on disk\n", n, n == 1 ? "" : "s",
        download / 1e6 + 1, disk * 1024 / 1e6 + 1
      else print "their size is not known"
    }'
}

as_root() {
  local name=$1 sudo=
  shift
  if [ "$(id -u)" != 0 ]; then
    # The password is asked for here, in the open: the step below shows one line at a time.
    sudo="sudo"
    if on_terminal; then sudo -v || die "sudo was refused"; fi
  fi
  # dpkg looks for ldconfig in folders that a user's PATH may lack.
  # shellcheck disable=SC2086
  step "$name" $sudo env DEBIAN_FRONTEND=noninteractive "PATH=$PATH:/usr/sbin:/sbin" "$@"
}

apt_failed() {
  show_log "$1"
  die "apt-get $1 failed; what it said stands above"
}

# Without apt we install nothing. Missing commands stop here; libraries may stand anywhere, so CMake decides about them,
# and table_of_missing tells their names when it fails.
ensure_without_apt() {
  kerf_groups="$*"
  local apt commands="" others=""
  for apt in $(rows apt "$@"); do
    found "$(cell "$apt" found_by)" && continue
    case $(cell "$apt" need),$(cell "$apt" found_by) in
      needed,*.h | needed,*.hpp | optional,*) others="$others $apt" ;;
      *) commands="$commands $apt" ;;
    esac
  done
  if [ -n "$commands" ]; then
    table_of_missing
    exit 1
  fi
  [ -z "$others" ] || say "there is no apt here, so nothing is installed; going on without what was not found:$others"
}

# found PROBES: is one of these commands, headers or Python modules here?
found() {
  local probe folder
  for probe in ${1//|/ }; do
    case $probe in
      *.h | *.hpp)
        for folder in /usr/include /usr/local/include /opt/homebrew/include "${CONDA_PREFIX:-/usr}/include"; do
          [ -e "$folder/$probe" ] && return 0
        done
        ;;
      py:*) python3 -c "import ${probe#py:}" >/dev/null 2>&1 && return 0 ;;
      *) has "$probe" && return 0 ;;
    esac
  done
  return 1
}

table_of_missing() {
  local apt missing=""
  # shellcheck disable=SC2086
  for apt in $(rows apt $kerf_groups); do
    found "$(cell "$apt" found_by)" || missing="$missing $apt"
  done
  [ -n "$missing" ] || return 0
  say "not found here, and there is no apt to install it with; install these by hand:"
  printf '  %-20s %-10s %-20s %-16s %-16s %s\n' "Debian, Ubuntu" need Fedora Arch Homebrew for >&2
  for apt in $missing; do
    printf '  %-20s %-10s %-20s %-16s %-16s %s\n' "$apt" "$(cell "$apt" need)" "$(cell "$apt" fedora)" \
      "$(cell "$apt" arch)" "$(cell "$apt" homebrew)" "$(cell "$apt" purpose)" >&2
  done
}

# ---- Building

# Two builds in one folder would write the same files; the second waits.
lock_build() {
  mkdir -p "$kerf_root/build" || die "cannot write to $kerf_root/build"
  has flock || return 0
  exec 9>"$kerf_root/build/.lock" || die "cannot write to $kerf_root/build"
  flock -n 9 || {
    say "waiting for another build to end"
    flock 9
  }
}
unlock_build() { exec 9>&-; }

# configured PRESET: is there a build folder, and is it that of this checkout and not one that was copied along?
configured() {
  local folder=$kerf_root/build/$1 source
  [ -f "$folder/build.ninja" ] || return 1
  source=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$folder/CMakeCache.txt" 2>/dev/null)
  [ "$source" -ef "$kerf_root" ] && [ "$(sed -n 's/^CMAKE_CACHEFILE_DIR:INTERNAL=//p' "$folder/CMakeCache.txt")" -ef "$folder" ]
}

# configure PRESET
configure() {
  local fresh=
  configured "$1" || fresh=--fresh
  # shellcheck disable=SC2086
  if ! step "configure-$1" cmake -S "$kerf_root" --preset "$1" $fresh; then
    show_log "configure-$1"
    local least version
    least=$(sed -n 's/^cmake_minimum_required(VERSION \([0-9.]*\).*/\1/p' "$kerf_root/CMakeLists.txt")
    version=$(cmake --version | sed -n '1s/[^0-9]*\([0-9.]*\).*/\1/p')
    if [ "$(printf '%s\n' "$least" "$version" | sort -V | head -n 1)" != "$least" ]; then
      say "CMake $least or newer is needed, this is $version"
    fi
    [ -z "${kerf_groups:-}" ] || table_of_missing
    say "configuring failed; what CMake said stands above"
    return 1
  fi
  # What is switched off for want of a library is said, not hidden in a log.
  sed -n 's/^-- kerf: /kerf: /p' "$kerf_root/build/configure-$1.log" >&2
}

# build PRESET [TARGET...]
build() {
  local preset=$1
  shift
  step "build-$preset" ninja -C "$kerf_root/build/$preset" "$@"
}

# configure_and_build PRESET [TARGET...]: aloud.
configure_and_build() {
  say "building ($1)"
  configure "$1" && { build "$@" || {
    show_log "build-$1"
    say "the build failed; what was said stands above"
    return 1
  }; }
}

# ---- Tests

processors() { nproc 2>/dev/null || getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2; }

# run_ctest PRESET ARGUMENTS...: on standard output.
run_ctest() {
  local preset=$1
  shift
  rm -f "$kerf_root/build/$preset/tests.xml"
  (cd "$kerf_root" && ctest --preset "$preset" -j "$(processors)" --no-tests=error "$@" \
    --output-junit "$kerf_root/build/$preset/tests.xml")
}

# counts PRESET...: the sum over the last run of each, "passed failed skipped".
counts() {
  local preset
  for preset in "$@"; do cat "$kerf_root/build/$preset/tests.xml" 2>/dev/null; done | awk '
    function number(name) { return match($0, "[ \t]" name "=\"[0-9]+\"") ? substr($0, RSTART + length(name) + 3, RLENGTH - length(name) - 4) + 0 : 0 }
    /<testsuite / { inside = 1 }
    inside {
      all += number("tests"); failed += number("failures"); skipped += number("skipped") + number("disabled")
      if (/>/) inside = 0
    }
    # No program, no fixture, no file: ctest files it under skipped, but fails.
    /<skipped message="/ && !/"SKIP_/ { failed++; skipped-- }
    END { print all - failed - skipped, failed + 0, skipped + 0 }'
}

# failed PRESET...: the tests of the last run of each that did not pass, by name, and the last that each of them said.
failed() {
  local preset
  for preset in "$@"; do
    awk -v preset="$preset" '
      function tell(   i) {
        print preset ": " name
        for (i = said > 30 ? said - 29 : 1; i <= said; i++) print "    " line[i]
      }
      /<testcase / {
        said = inside = 0
        name = $0
        sub(/.*<testcase name="/, "", name)
        sub(/".*/, "", name)
        is_bad = /status="fail"/
        if (is_bad && /\/>[ \t]*$/) tell()
      }
      !is_bad { next }
      /<system-out>/ { inside = 1; sub(/.*<system-out>/, "") }
      inside { line[++said] = $0; sub(/<\/system-out>.*/, "", line[said]) }
      /<\/system-out>/ { inside = 0 }
      /<\/testcase>/ { tell(); is_bad = 0 }' "$kerf_root/build/$preset/tests.xml" 2>/dev/null
  done | sed -e 's/&lt;/</g' -e 's/&gt;/>/g' -e 's/&quot;/"/g' -e 's/&apos;/'"'"'/g' -e 's/&amp;/\&/g'
}

closing_line() {
  local passed failed skipped
  read -r passed failed skipped < <(counts "$@")
  printf '%s passed, %s failed, %s skipped\n' "$passed" "$failed" "$skipped"
}
