#!/usr/bin/env bash
# Boots a bare Debian 12 in which the packages are installed (systemd-nspawn), starts the rig in simulation by its units, and
# looks whom their network keeps out. Needs root and the network; SINEW_PRESET as tools/package.
#   booted_test.sh         makes the root by tools/package
#   booted_test.sh ROOT    uses a copy of this one, in which the packages and systemd are
set -euo pipefail
project=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)
limit_s=120

fail() {
  echo "booted: FAILED: $*" >&2
  exit 1
}

# --- What runs inside, as a unit of its own ---

# within LIMIT_S COMMAND...: tries until the command succeeds.
within() {
  local limit=$((SECONDS + $1))
  shift
  until "$@" > /root/tried 2>&1; do
    [ $SECONDS -lt $limit ] || fail "not in time: $*: $(cat /root/tried)"
  done
}

# says TEXT COMMAND...: what the command prints holds the text.
says() {
  local text=$1
  shift
  "$@" > /root/tried 2>&1 || true
  grep -q -e "$text" /root/tried || fail "'$*' does not say '$text': $(cat /root/tried)"
}

by_nobody() { setpriv --reuid=65534 --regid=65534 --clear-groups "$@"; }

inside() {
  ip link add bus0 type veth peer name bus1
  ip link set bus0 up
  # The network comes first, whatever is started.
  systemctl start sinew@surrogate sinew@reference sinew@control sinew-logger
  within 30 sinew arm --reason "by units"
  says 'bus0@.*,UP' sinew enter robot ip -br link
  ! ip -br link show bus0 2> /dev/null || fail "bus0 is outside, too"

  # One that is plugged in later.
  ip link add late0 type veth peer name late1
  within 10 sinew enter robot ip link show late0

  # Whoever is outside hears and reaches nobody, and is said why.
  says "0 participants.*'robot' of user root" by_nobody sinew list
  says "no state provider heard.*'robot' of user root" by_nobody sinew disarm
  says "no state provider heard.*--deployment robot" sinew disarm --deployment none

  # The way in comes back, and its robot has not noticed.
  systemctl kill -s KILL sinew-network.service
  within 30 sinew disarm
  within 10 sinew enter robot ip link show late0
  for unit in sinew@surrogate sinew@reference sinew@control sinew-logger; do
    [ "$(systemctl show -P NRestarts $unit)" = 0 ] || fail "$unit was started again"
  done

  systemctl stop 'sinew@*' sinew-logger sinew-network
  ip link show late0 > /dev/null || fail "late0 does not come back"
  ip -br link show bus0 | grep -q ',UP' || fail "bus0 does not come back"
  [ ! -e /run/sinew-shm ] || fail "shared memory is left: $(ls -la /run/sinew-shm)"
  # shellcheck disable=SC2144
  [ -s /var/lib/sinew/*.mcap ] || fail "nothing is recorded: $(ls /var/lib/sinew)"
  echo "booted: units started, armed, kept apart, stopped"
}

if [ "${1:-}" = --inside ]; then
  trap 'systemctl poweroff' EXIT
  inside
  exit
fi

# --- Outside ---

[ "$(id -u)" -eq 0 ] || fail "must be run by root, to make a root of its own"
folder=$(mktemp -d)
trap 'rm -rf --one-file-system "$folder"' EXIT
bare=$folder/root
if [ $# -gt 0 ]; then
  cp -a "$1" "$bare"
else
  "$project/tools/package" --root "$bare"
  cp /etc/resolv.conf "$bare/etc/"
  apt-config dump Acquire > "$bare/etc/apt/apt.conf.d/90host"
  DEBIAN_FRONTEND=noninteractive chroot "$bare" sh -c \
    'apt-get update && apt-get install -y --no-install-recommends systemd-sysv dbus && systemd-sysusers sinew.conf' \
    > "$folder/log" 2>&1 || fail "systemd: $(tail -n 5 "$folder/log")"
fi

# The rig of the package, with a guard that bears the pauses of a busy machine.
cp -r "$bare"/usr/share/sinew/robots/rig/. "$bare/etc/sinew/"
cp "$bare/etc/sinew/reference_benchmark.yaml" "$bare/etc/sinew/reference.yaml"
cp "$bare/etc/sinew/control_pid.yaml" "$bare/etc/sinew/control.yaml"
sed -i 's/missed_periods: 3$/missed_periods: 100/; s/fault_after_ms: 60$/fault_after_ms: 3000/' "$bare/etc/sinew/surrogate.yaml"
echo 'SINEW_ARGUMENTS=--move bus0 --move late0' > "$bare/etc/sinew/network.env"
cp "${BASH_SOURCE[0]}" "$bare/root/booted_test.sh"
cat > "$bare/etc/systemd/system/booted.service" << END
[Unit]
After=multi-user.target
[Service]
Type=exec
ExecStart=/bin/sh -c 'bash /root/booted_test.sh --inside > /root/out 2>&1'
END
mkdir -p "$bare/etc/systemd/system/multi-user.target.wants"
ln -s ../booted.service "$bare/etc/systemd/system/multi-user.target.wants/"
timeout $limit_s systemd-nspawn --quiet -D "$bare" --register=no --keep-unit --private-network --capability=all --boot \
  > "$folder/boot" 2>&1 || true
cat "$bare/root/out" 2> /dev/null || fail "it did not boot: $(tail -n 20 "$folder/boot")"
tail -n 1 "$bare/root/out" | grep -q '^booted: units' || fail "see above; the units: $(chroot "$bare" journalctl --no-pager -D /var/log/journal -u 'sinew*' 2> /dev/null | tail -n 40)"
