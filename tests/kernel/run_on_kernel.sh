#!/bin/bash
# Runs a test program where SocketCAN and joysticks are real: on this kernel if it has vcan, else under qemu (software
# emulation) with Debian's kernel, its modules for both and the program in an initramfs. Ends with the program's exit code; 77 means skipped,
# and the last line says why (tests/support/skip.h has the words it begins with), as does FOLDER/skipped.
#   run_on_kernel.sh [--with PROGRAM]... [--results FOLDER] PROGRAM CACHE_FOLDER
# The program finds the interface in SINEW_CAN_INTERFACE, the programs of --with in the folder SINEW_PROGRAMS; what it
# writes to the folder SINEW_RESULTS is in FOLDER afterwards.
set -euo pipefail
companions=()
results=
while [ $# -gt 2 ]; do
  case $1 in
    --with) companions+=("$(realpath "$2")") ;;
    --results) results=$2 ;;
    *)
      echo "unknown option $1" >&2
      exit 2
      ;;
  esac
  shift 2
done
program=$(realpath "$1")
cache=$2
skip() {
  echo "$*" > "$results/skipped"
  echo "SKIPPED: $*"
  exit 77
}

work=$(mktemp -d)
# shellcheck disable=SC2317  # called by the trap
clean_up() {
  [ ! -e "$work/interface" ] || ip link del sinewvcan0 2> /dev/null || true
  rm -rf "$work"
}
trap clean_up EXIT
mkdir -p "$cache"
: "${results:=$work/results}"
rm -rf "$results"
mkdir -p "$results"

# Directly, where an interface can be made. candump and cangen take part.
if command -v candump cangen ip > /dev/null && ip link add dev sinewvcan0 type vcan 2> /dev/null; then
  touch "$work/interface"
  echo "vcan of this kernel ($(uname -r))"
  ip link set sinewvcan0 up
  mkdir "$work/programs"
  for companion in "${companions[@]}"; do ln -s "$companion" "$work/programs/"; done
  status=0
  SINEW_CAN_INTERFACE=sinewvcan0 SINEW_PROGRAMS=$work/programs SINEW_RESULTS=$(realpath "$results") \
    "$program" || status=$?
  exit $status
fi

for tool in qemu-system-x86_64 busybox cpio candump cangen; do
  command -v $tool > /dev/null ||
    skip "package: no $tool; apt-get install --no-install-recommends qemu-system-x86 busybox-static cpio can-utils"
done
[ "$(uname -m)" = x86_64 ] || skip "kernel: no vcan, and the emulated machine is of x86_64, not of $(uname -m)"

# The kernel package is fetched once and unpacked, never installed. Modules are in the order in which they are loaded;
# virtio_blk is the disk on which the results leave the machine.
modules=(can can-raw can-dev vcan uinput joydev
  virtio_ring virtio virtio_pci_legacy_dev virtio_pci_modern_dev virtio_pci virtio_blk)
package=$(apt-cache depends linux-image-amd64 2> /dev/null | awk '/Depends/{print $2; exit}') || true
[ -n "$package" ] || skip "package: apt knows no linux-image-amd64; apt-get update"
kernel=$cache/$package
if [ "$(cat "$kernel/complete" 2> /dev/null)" != "${modules[*]}" ]; then
  rm -rf "$kernel"
  mkdir -p "$kernel"
  (cd "$kernel" && apt-get download -q -o APT::Sandbox::User=root "$package") > "$kernel/download.log" 2>&1 ||
    skip "package: $package cannot be downloaded: $(tail -1 "$kernel/download.log")"
  wanted=('./boot/vmlinuz-*')
  for module in "${modules[@]}"; do wanted+=("*/$module.ko*"); done
  dpkg-deb --fsys-tarfile "$kernel"/*.deb | tar -x -C "$kernel" --wildcards "${wanted[@]}"
  rm "$kernel"/*.deb
  echo "${modules[*]}" > "$kernel/complete"
fi

root=$work/root
mkdir -p "$root"/{bin,sbin,lib/modules,proc,sys,dev,tmp,results,usr/bin,etc,programs}
install_program() {  # with the libraries it needs, where it looks for them
  local file=$1 target=$2
  cp "$file" "$root$target"
  local library
  for library in $(ldd "$file" 2> /dev/null | grep -o '/[^ ]*' || true); do
    mkdir -p "$root$(dirname "$library")"
    cp -Lu "$library" "$root$library"
  done
}
install_program "$(command -v busybox)" /bin/busybox
install_program "$(command -v candump)" /usr/bin/candump
install_program "$(command -v cangen)" /usr/bin/cangen
install_program "$program" /bin/test-program
for companion in "${companions[@]}"; do install_program "$companion" "/programs/$(basename "$companion")"; done
for module in "${modules[@]}"; do
  cp "$(find "$kernel" -name "$module.ko")" "$root/lib/modules/"
done
# DDS finds its participants by multicast over lo, and hands data over in /dev/shm.
cat > "$root/init" <<INIT
#!/bin/busybox sh
/bin/busybox --install -s /bin
export PATH=/bin:/sbin:/usr/bin
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev
mkdir -p /dev/shm; mount -t tmpfs shm /dev/shm
for module in ${modules[*]}; do insmod /lib/modules/\$module.ko; done
ip link set lo up; ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo
ip link add dev vcan0 type vcan; ip link set vcan0 up
echo "kernel \$(uname -r)"
SINEW_CAN_INTERFACE=vcan0 SINEW_PROGRAMS=/programs SINEW_RESULTS=/results GTEST_COLOR=no /bin/test-program
echo "exit code \$?"
tar -c -C /results . > /dev/vda; sync
poweroff -f
INIT
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet) > "$work/initrd"
truncate -s 256M "$work/disk"
# The machine's clock counts its own instructions (1000 to a microsecond), not our time: however busy this machine is,
# nothing in there is starved or late. Waiting takes no time.
timeout "${SINEW_KERNEL_TIMEOUT_S:-1100}" qemu-system-x86_64 -kernel "$kernel"/boot/vmlinuz-* -initrd "$work/initrd" \
  -nographic -no-reboot -nic none -m 1024 -icount shift=0,sleep=off -rtc clock=vm \
  -drive "file=$work/disk,format=raw,if=virtio" -append "console=ttyS0 quiet panic=-1 no_timer_check mitigations=off" < /dev/null |
  sed -u -e 's/\r//g' -e 's/\x1b\[[0-9;?]*[a-zA-Z]//g' | tee "$work/console" || true
grep -q '^exit code ' "$work/console" || { echo "the emulated machine did not finish"; exit 1; }
tar -x -C "$results" -f "$work/disk"
exit "$(sed -n 's/^exit code \([0-9]*\).*/\1/p' "$work/console" | tail -1)"
