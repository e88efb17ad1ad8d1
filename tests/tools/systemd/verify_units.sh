#!/bin/bash
# Installs the units into a folder as `cmake --install --prefix` does and lets systemd-analyze verify them. Programs are
# empty scripts there: systemd only looks whether they can be run. Exit code 77: skipped, and the last line says why.
#   verify_units.sh INSTALL_SCRIPT (tools/systemd/cmake_install.cmake of the build) CMAKE
set -euo pipefail
install_script=$1
cmake=$2
fail() { echo "FAILED: $*"; exit 1; }

prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
"$cmake" -DCMAKE_INSTALL_PREFIX="$prefix" -P "$install_script" > /dev/null
units=$prefix/lib/systemd/system
for file in "$units"/{sinew.target,sinew@.service,sinew-logger.service,sinew-estop.service,sinew-can@.service,sinew-deployment@.service,sinew-network.service} \
            "$units"/sinew@can-bridge.service.d/order.conf "$prefix"/lib/{sysusers.d,tmpfiles.d}/sinew.conf \
            "$prefix"/lib/udev/rules.d/85-sinew-can.rules; do
  [ -s "$file" ] || fail "$file is not installed"
  if grep -n '@[A-Z_]*@' "$file"; then fail "$file: a name was not filled in"; fi
done
grep -q "^ExecStart=$prefix/bin/sinew-%i " "$units/sinew@.service" || fail "sinew@.service starts no program of the prefix"

command -v systemd-analyze > /dev/null ||
  { echo "SKIPPED: package: no systemd-analyze; apt-get install --no-install-recommends systemd"; exit 77; }
# What the drop-in names, too: a name that is no program would never be waited for, silently.
names=$(grep -oh 'sinew@[a-z-]*\.service' "$units/sinew@can-bridge.service.d/order.conf" "$units/sinew-can@.service" | sort -u)
mkdir -p "$prefix/bin"
for name in $names sinew@logger.service sinew@estop.service; do
  program=${name#sinew@}
  printf '#!/bin/sh\n' > "$prefix/bin/sinew-${program%.service}"
done
printf '#!/bin/sh\n' > "$prefix/bin/sinew"
chmod +x "$prefix"/bin/*
export SYSTEMD_UNIT_PATH=$units:
# Words about other units of this machine are not ours.
said=$(systemd-analyze verify sinew.target sinew-network.service sinew-logger.service sinew-estop.service sinew-can@can0.service sinew-deployment@robot.service $names 2>&1) || status=$?
echo "$said"
[ "${status:-0}" -eq 0 ] || fail "systemd-analyze verify ends with $status"
if grep -i sinew <<< "$said"; then fail "systemd-analyze verify has something to say"; fi
# It must be able to fail: an unknown key, a program that is not there.
sed 's/^WatchdogSec=/WatchDogSec=/' "$units/sinew@.service" > "$units/sinewbroken@.service"
systemd-analyze verify sinewbroken@control.service 2>&1 | grep -q WatchDogSec || fail "an unknown key is not noticed"
rm "$prefix/bin/sinew-control"
if systemd-analyze verify sinew@control.service > /dev/null 2>&1; then fail "a missing program is not noticed"; fi

grep -q '^RuntimeDirectory=sinew$' "$units/sinew@can-bridge.service.d/order.conf" || fail "no folder for the estop's socket"

# --realtime asks for SCHED_FIFO and locked memory.
for unit in sinew@.service sinew-logger.service sinew-estop.service sinew-deployment@.service; do
  grep -q '^LimitMEMLOCK=infinity$' "$units/$unit" || fail "$unit: memory cannot be locked"
  grep -q '^IPAddressDeny=any$' "$units/$unit" || fail "$unit: every network reaches it"
  allowed=$(sed -n 's/^IPAddressAllow=//p' "$units/$unit")
  [ "$allowed" = "localhost 239.255.0.1" ] || fail "$unit: '$allowed' is let through, expected loopback and discovery there"
  limit=$(sed -n 's/^LimitRTPRIO=//p' "$units/$unit")
  [ "${limit:-0}" -ge 48 ] || fail "$unit: LimitRTPRIO is ${limit:-0}, --realtime asks for up to 48"
  if grep -E '^(RestrictRealtime|PrivateIPC)=yes' "$units/$unit"; then
    fail "$unit: that takes SCHED_FIFO or /dev/shm away"
  fi
  grep -q '^PrivateNetwork=yes$' "$units/$unit" || fail "$unit: other users of the machine reach it"
  # Alone in its network it would hear nobody.
  [ "$(grep -c '^\(Wants\|After\|JoinsNamespaceOf\)=sinew-network.service$' "$units/$unit")" -eq 3 ] ||
    fail "$unit: its network is not that of the others"
  if grep -q '^Requires=.*sinew-network' "$units/$unit"; then fail "$unit: ends with the way into its network"; fi
done
if command -v systemd-sysusers > /dev/null; then
  mkdir -p "$prefix/root/etc"
  systemd-sysusers --root="$prefix/root" "$prefix/lib/sysusers.d/sinew.conf" > /dev/null 2>&1 || true
  said=$(systemd-sysusers --dry-run --root="$prefix/root" - < "$prefix/lib/sysusers.d/sinew.conf" 2>&1) ||
    fail "systemd-sysusers: $said"
fi
echo "the units are fine for $(systemd-analyze --version | head -1)"
