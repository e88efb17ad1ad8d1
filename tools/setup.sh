# shellcheck shell=bash
# Set-up that tools/demo, tools/test, tools/lint and tools/package share: packages, versions, configure, build. Sourced, not run;
# `root` is the folder of the project.
: "${root:?}"

say() { printf '\n== %s\n' "$*"; }

# timed NAME COMMAND...: adds a line "NAME SECONDS" to the file SINEW_TIMES, where it is set.
timed() {
  local name=$1 began=$SECONDS
  shift
  "$@"
  echo "$name $((SECONDS - began))" >> "${SINEW_TIMES:-/dev/null}"
}

package_lists=("$root"/tools/{run_packages,packages}.txt)
# The preset that is to be built may need another compiler: for_preset PRESET, before install_packages.
for_preset() { [ "$1" = release ] || package_lists+=("$root/tools/sanitizer_packages.txt"); }
packages() { sed 's/#.*//' "${package_lists[@]}" | tr -s '[:space:]' '\n' | sed '/^$/d'; }

missing_packages() {
  local package
  for package in $(packages); do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] ||
      echo "$package"
  done
}

# Installs what is missing of the lists; without the right to do so, says how.
install_packages() {
  local missing
  missing=$(missing_packages | tr '\n' ' ')
  if [ -z "$missing" ]; then
    say "Packages: all of ${package_lists[*]#"$root/"} are installed"
    return
  fi
  if [ "$(id -u)" -ne 0 ]; then
    echo "Missing packages: $missing" >&2
    echo "Install them with:" >&2
    echo "  sudo apt-get install --no-install-recommends $missing" >&2
    exit 1
  fi
  say "Packages: installing $missing"
  export DEBIAN_FRONTEND=noninteractive
  local log
  log=$(mktemp)
  # shellcheck disable=SC2046
  if ! { apt-get update && apt-get install -y --no-install-recommends $(packages); } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    echo "The packages could not be installed; the last lines of apt-get stand above." >&2
    exit 1
  fi
  rm -f "$log"
}

show_versions() {
  say "Versions"
  # shellcheck disable=SC2046
  dpkg-query -W -f='  ${Package} ${Version}\n' $(packages)
}

# configure PRESET [CMAKE-OPTION...]: for programs alone `$(without_tests PRESET)`. A tree that has tests keeps them.
without_tests() { [ -e "$root/build/$1/CMakeCache.txt" ] || echo -DSINEW_BUILD_TESTS=OFF; }
configure() {
  local preset=$1
  shift
  say "Configuring build/$preset"
  cmake --preset "$preset" -S "$root" "$@" | grep -v -e '^-- Detecting' -e '^-- Check for' -e 'Performing Test'
}

# build PRESET [TARGET...]: of what was configured.
build() {
  local preset=$1 began=$SECONDS targets=()
  shift
  say "Building build/$preset on $(nproc) cores${*:+: $*}"
  [ $# -eq 0 ] || targets=(--target "$@")
  (cd "$root" && cmake --build --preset "$preset" -j "$(nproc)" "${targets[@]}")
  echo "built in $((SECONDS - began)) s; programs are in build/$preset/bin"
}
