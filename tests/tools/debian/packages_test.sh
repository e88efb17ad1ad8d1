#!/usr/bin/env bash
# Builds the packages, installs them in a bare Debian 12 without compilers, and runs there what a user runs: the rig in
# simulation, armed and recorded; the live page; close-loop. Needs root and the network; SINEW_PRESET as tools/package.
# Prints the seconds from the begin of installing, downloads excluded, to an armed rig.
set -euo pipefail
project=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)
limit_s=120
fail() {
  echo "packages: FAILED: $*" >&2
  exit 1
}

# --- The second half, in namespaces of its own: what it mounts and starts ends with it; nobody shares its network. ---

# within LIMIT_S COMMAND...: tries until the command succeeds.
within() {
  local limit=$((SECONDS + $1))
  shift
  until "$@" > "$folder/tried" 2>&1; do
    if [ $SECONDS -ge $limit ]; then
      cat "$folder/tried" "$folder"/*.log >&2
      fail "not in time: $*"
    fi
  done
}

# The status line of the answer to a request for the page.
# shellcheck disable=SC2317  # called by within
page() {
  # shellcheck disable=SC2016
  in_root bash -c 'exec 3<> /dev/tcp/127.0.0.1/8765 && printf "GET / HTTP/1.1\r\nHost: 127.0.0.1:8765\r\nConnection: close\r\n\r\n" >&3 &&
    tr -d "\r" <&3' > "$folder/page" && grep -q '^HTTP/1.1 200' "$folder/page" && grep -qi '<html' "$folder/page"
}

in_root() { "${enter[@]}" "$@"; }

in_namespace() {
  bare=$1 folder=$2
  enter=(chroot "$bare" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8)
  local installed_s=$3 program package
  ip link set lo up
  ip link set lo multicast on
  mount -t proc proc "$bare/proc"
  mount -t tmpfs shm "$bare/dev/shm"

  for program in gcc g++ cc c++ clang ld as make cmake ninja; do
    ! in_root sh -c "command -v $program" || fail "$program is in the root, expected no compilers"
  done
  ! in_root dpkg-query -W -f '${Package}\n' | grep -E -e '-dev$|^(gcc|g\+\+|clang|binutils)(-[0-9]+)?$' || fail "packages to build with are in the root"

  # Each program is in its package, runs, and has a page.
  local count=0
  while read -r package program; do
    [ "$(in_root dpkg-query -S "/usr/bin/$program" | cut -d: -f1)" = "$package" ] || fail "$program is not in $package"
    in_root "$program" --help > "$folder/tried" 2>&1 || { cat "$folder/tried" && fail "$program does not run"; }
    compgen -G "$bare/usr/share/man/man[18]/$program.[18].gz" > /dev/null || fail "$program has no manual page"
    count=$((count + 1))
  done < <(sed -n 's/^| `\(sinew-[a-z]*\)` | \(`.*`\) |$/\1 \2/p' "$project/docs/how-to/packages.md" | tr -d '`,' |
    while read -r package programs; do printf "$package %s\n" $programs; done)
  [ $count -eq "$(in_root sh -c 'ls /usr/bin/sinew*' | wc -l)" ] || fail "other programs are installed than docs/how-to/packages.md lists"
  local commands
  # What completion knows is what `sinew --help` lists.
  commands=$(in_root bash -c '. /usr/share/bash-completion/completions/sinew; COMP_WORDS=(sinew ""); COMP_CWORD=1; _sinew; printf "%s\n" "${COMPREPLY[@]}"' | grep -v '^-')
  for program in $commands; do
    [ -s "$bare/usr/share/man/man1/sinew-$program.1.gz" ] || fail "'sinew $program' has no manual page"
  done
  [ "$(wc -w <<< "$commands")" -gt 30 ] || fail "completion offers only: $commands"

  # What the scripts of the package made; nothing is enabled.
  [ "$(in_root stat -c '%U:%G %a' /run/sinew)" = "sinew:sinew 750" ] || fail "/run/sinew is not that of the user sinew"
  [ "$(in_root stat -c '%U:%G %a' /var/lib/sinew)" = "sinew:sinew 755" ] || fail "/var/lib/sinew is not that of the user sinew"
  in_root dpkg-query -W -f '${Conffiles}\n' sinew-core | grep -q ' /etc/sinew/environment ' || fail "/etc/sinew/environment is no conffile"
  grep -q '^ExecStart=/usr/bin/sinew-%i ' "$bare/usr/lib/systemd/system/sinew@.service" || fail "the units start other programs"
  ! find "$bare/etc/systemd" -name '*sinew*' 2> /dev/null | grep . || fail "a unit is enabled"

  # The rig as it is installed, but armed by its operator, and with a guard that bears the pauses of a busy machine.
  in_root cp -r /usr/share/sinew/robots/rig /root/rig
  sed -i 's/missed_periods: 3$/missed_periods: 100/; s/fault_after_ms: 60$/fault_after_ms: 3000/' "$bare/root/rig/surrogate.yaml"
  sed -i 's/, arguments: \[--arm\]//' "$bare/root/rig/deploy_rig.yaml"
  local began=$SECONDS
  "${enter[@]}" sinew launch /root/rig/deploy_rig.yaml --duration 0 --record /root/run.mcap > "$folder/launch.log" 2>&1 &
  local launch=$!
  within 30 in_root sinew arm --reason "installed from packages" --timeout 2
  local armed_s=$((SECONDS - began + installed_s))
  echo "packages: $armed_s s from the begin of installing to an armed rig; limit $limit_s s"
  [ $armed_s -le $limit_s ] || fail "$armed_s s to an armed rig, expected $limit_s s at most"
  "${enter[@]}" sinew view --config /root/rig/view.yaml > "$folder/view.log" 2>&1 &
  local view=$!
  within 15 page
  within 30 in_root sinew list
  kill -TERM $view $launch
  wait $view || fail "sinew view ended with exit code $?: $(tail -n 5 "$folder/view.log")"
  wait $launch || fail "sinew launch ended with exit code $?: $(tail -n 5 "$folder/launch.log")"
  in_root sinew list /root/run.mcap > "$folder/list" || fail "sinew list of the recording: $(cat "$folder/list")"
  in_root python3 -c 'from sinew_recording import Recording
state = Recording("/root/run.mcap")["joint_state"]
assert len(state["robot_state"]) > 100 and len(set(state["robot_state"])) > 1, "expected a robot that became armed"
print("packages:", len(state["robot_state"]), "messages of joint_state recorded")'

  # Which effect is missing from the model?
  cp -r "$project/tests/data/rig_examples/one_effect" "$bare/root/example"
  in_root sinew model from-rig /root/example/rig.json --out /root/example/model.yaml > "$folder/model.log" 2>&1 ||
    fail "sinew model from-rig: $(cat "$folder/model.log")"
  in_root sinew close-loop --model /root/example/model.yaml --map /root/rig/csv_map.yaml --train /root/example/train_{1,2,3}.csv \
    --held-out /root/example/sealed.csv --out /root/result > "$folder/close_loop.log" 2>&1 ||
    fail "sinew close-loop: $(tail -n 20 "$folder/close_loop.log")"
  in_root python3 -c 'import json, sinew
found = [effect.name for effect in sinew.read_report("/root/result").effects]
assert sinew.check_data("/root/example/train_1.csv", "/root/example/model.yaml", map="/root/rig/csv_map.yaml").ok
hidden = json.load(open("/root/example/truth.json"))["effects"]
assert found and found == [effect["name"] for effect in hidden], f"found {found}, hidden was {hidden}"
print("packages: close-loop found", *found)'
  grep -q '<svg' "$bare/root/result/report.html" || fail "the report has no pictures"

  # What a purge takes away, and what it leaves.
  touch "$bare/var/lib/sinew/kept.mcap"
  in_root dpkg --purge sinew-view sinew-sim sinew-core python3-sinew > "$folder/tried" 2>&1 || fail "purging: $(cat "$folder/tried")"
  [ -e "$bare/var/lib/sinew/kept.mcap" ] || fail "a purge deletes recordings"
  ! find "$bare/usr" "$bare/etc/sinew" -name '*sinew*' 2> /dev/null | grep . || fail "a purge leaves files"
}

if [ "${1:-}" = --in-namespace ]; then
  shift
  in_namespace "$@"
  exit
fi

# --- The first half ---

[ "$(id -u)" -eq 0 ] || fail "must be run by root, to make a root of its own"
folder=$(mktemp -d)
trap 'rm -rf --one-file-system "$folder"' EXIT
"$project/tools/package" --root "$folder/root" | tee "$folder/packages"
installed_s=$(sed -n 's/^installed in \([0-9]*\) s.*/\1/p' "$folder/packages")

# libsinew-dev in a folder, and the outside project that uses it.
preset=${SINEW_PRESET:-release}
dpkg-deb -x "$project/build/$preset/packages"/libsinew-dev_*.deb "$folder/dev"
cmake -S "$project/tests/install/consumer" -B "$folder/consumer" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$folder/dev/usr" > "$folder/cmake" 2>&1 || fail "the consumer: $(cat "$folder/cmake")"
cmake --build "$folder/consumer" > "$folder/cmake" 2>&1 || fail "the consumer: $(tail -n 20 "$folder/cmake")"

unshare --mount --net --pid --fork --kill-child --mount-proc -- \
  bash "${BASH_SOURCE[0]}" --in-namespace "$folder/root" "$folder" "$installed_s"
