#!/bin/bash
# Runs test programs, one after the other, where SocketCAN and joysticks are real: on this kernel if it has vcan, else in
# one boot of Debian's kernel under qemu (software emulation), with its modules for both and the programs in an initramfs.
#   run_on_kernel.sh BUILD_FOLDER [COMPANION]... TEST=PROGRAM...
# leaves of each test, whatever becomes of the others, BUILD_FOLDER/kernel_results/TEST/console, which ends with the exit
# code, and BUILD_FOLDER/test_results/TEST.xml. A program finds its interface in SINEW_CAN_INTERFACE, the companions in the
# folder SINEW_PROGRAMS; what it writes to the folder SINEW_RESULTS is in kernel_results/TEST as well.
#   run_on_kernel.sh --show BUILD_FOLDER/kernel_results/TEST
# prints the console of one test and ends with its exit code. In both, 77 means skipped: the last line says why
# (tests/support/skip.h has the words it begins with), as does kernel_results/TEST/skipped.
set -euo pipefail
if [ "$1" = --show ]; then
  [ ! -e "$2/skipped" ] || { echo "SKIPPED: $(cat "$2/skipped")" && exit 77; }
  cat "$2/console"
  status=$(sed -n '$s/^exit code //p' "$2/console")
  exit "${status:?the program did not end; KernelBoot shows the machine}"
fi

build=$(realpath "$1")
results=$build/kernel_results
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$build/test_results" "$work/programs"
rm -rf "$results"
tests=()
for argument in "${@:2}"; do
  name=$(basename "${argument%%=*}")
  ln -s "$(realpath "${argument#*=}")" "$work/programs/$name"
  [[ $argument == *=* ]] || continue
  tests+=("$name")
  mkdir -p "$results/$name"
  rm -f "$build/test_results/$name.xml"
done
skip() {
  for name in "${tests[@]}"; do echo "$*" > "$results/$name/skipped"; done
  echo "SKIPPED: $*"
  exit 77
}
# The emulated machine's shell runs this too. Each program has an interface of its own and ends in ten minutes of its clock.
run_test() {
  echo "test $1"
  export SINEW_RESULTS=$results/$1
  mkdir -p "$SINEW_RESULTS"
  ip link del "$SINEW_CAN_INTERFACE" 2> /dev/null
  ip link add dev "$SINEW_CAN_INTERFACE" type vcan && ip link set "$SINEW_CAN_INTERFACE" up
  timeout -s KILL 600 "$SINEW_PROGRAMS/$1" "--gtest_output=xml:$SINEW_RESULTS/result.xml"
  printf '\nexit code %d\n' $?
}
part_results() {  # of one console and one folder, among the tests
  for name in "${tests[@]}"; do
    sed -n "/^test $name\$/,/^exit code /p" "$work/console" > "$results/$name/console"
    [ ! -e "$results/$name/result.xml" ] || mv "$results/$name/result.xml" "$build/test_results/$name.xml"
  done
}

# Directly, where an interface can be made. candump and cangen take part.
export SINEW_CAN_INTERFACE=sinewvcan0 SINEW_PROGRAMS=$work/programs
if command -v candump cangen ip > /dev/null && ip link add dev $SINEW_CAN_INTERFACE type vcan 2> /dev/null; then
  trap 'ip link del $SINEW_CAN_INTERFACE; rm -rf "$work"' EXIT
  echo "vcan of this kernel ($(uname -r))"
  for name in "${tests[@]}"; do run_test "$name" 2>&1 || true; done | tee "$work/console"
  part_results
  exit
fi

for tool in qemu-system-x86_64 busybox cpio candump cangen; do
  command -v $tool > /dev/null ||
    skip "package: no $tool; apt-get install --no-install-recommends qemu-system-x86 busybox-static cpio can-utils"
done
[ "$(uname -m)" = x86_64 ] || skip "kernel: no vcan, and the emulated machine is of x86_64, not of $(uname -m)"

# The kernel package is fetched once and unpacked, never installed. Modules are in the order in which they are loaded;
# virtio_blk is the disk on which the results leave the machine.
modules=(can can-raw can-dev vcan slcan uinput joydev
  virtio_ring virtio virtio_pci_legacy_dev virtio_pci_modern_dev virtio_pci virtio_blk)
package=$(apt-cache depends linux-image-amd64 2> /dev/null | awk '/Depends/{print $2; exit}') || true
[ -n "$package" ] || skip "package: apt knows no linux-image-amd64; apt-get update"
kernel=$build/kernel/$package
if [ "$(cat "$kernel/complete" 2> /dev/null)" != "vmlinux ${modules[*]}" ]; then
  rm -rf "$kernel"
  mkdir -p "$kernel"
  (cd "$kernel" && apt-get download -q -o APT::Sandbox::User=root "$package") > "$kernel/download.log" 2>&1 ||
    skip "package: $package cannot be downloaded: $(tail -1 "$kernel/download.log")"
  wanted=('./boot/vmlinuz-*')
  for module in "${modules[@]}"; do wanted+=("*/$module.ko*"); done
  dpkg-deb --fsys-tarfile "$kernel"/*.deb | tar -x -C "$kernel" --wildcards "${wanted[@]}"
  rm "$kernel"/*.deb
  # The ELF file inside starts seconds earlier: the emulated machine is slow to unpack it.
  mv "$kernel"/boot/vmlinuz-* "$kernel/vmlinuz"
  start=$(LC_ALL=C grep -abo -m 1 $'\xFD7zXZ' "$kernel/vmlinuz" | cut -d : -f 1) || true
  tail -c "+$((start + 1))" "$kernel/vmlinuz" | xz -dc --single-stream > "$kernel/vmlinux" ||
    mv "$kernel/vmlinuz" "$kernel/vmlinux"
  echo "vmlinux ${modules[*]}" > "$kernel/complete"
fi

root=$work/root
mkdir -p "$root"/{bin,lib/modules,proc,sys,dev,tmp,usr/bin,programs}
install_program() {  # without symbols; with the libraries it needs, where it looks for them
  strip -o "$root$2" "$1"
  local library
  for library in $(ldd "$1" 2> /dev/null | grep -o '/[^ ]*' || true); do
    mkdir -p "$root$(dirname "$library")"
    cp -Lu "$library" "$root$library"
  done
}
install_program "$(command -v busybox)" /bin/busybox
install_program "$(command -v candump)" /usr/bin/candump
install_program "$(command -v cangen)" /usr/bin/cangen
for program in "$work"/programs/*; do install_program "$program" "/programs/$(basename "$program")"; done
for module in "${modules[@]}"; do cp "$(find "$kernel" -name "$module.ko")" "$root/lib/modules/"; done
# DDS finds its participants by multicast over lo, and hands data over in /dev/shm. What a program leaves running is
# killed, and the disk has the results so far after each program.
cat > "$root/init" <<INIT
#!/bin/busybox sh
/bin/busybox --install -s /bin
export PATH=/bin:/usr/bin GTEST_COLOR=no SINEW_CAN_INTERFACE=vcan0 SINEW_PROGRAMS=/programs results=/results
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev
mkdir -p /dev/shm /dev/pts; mount -t tmpfs shm /dev/shm; mount -t devpts pts /dev/pts
for module in ${modules[*]}; do insmod /lib/modules/\$module.ko; done
ip link set lo up; ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo
echo "kernel \$(uname -r)"
$(declare -f run_test)
for name in ${tests[*]}; do
  run_test \$name
  kill -9 -1
  tar -c -C /results . > /dev/vda; sync
done
poweroff -f
INIT
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet) > "$work/initrd"
truncate -s 256M "$work/disk"
# The machine's clock counts its own instructions (1000 to a microsecond), not our time: however busy this machine is,
# nothing in there is starved or late. Waiting takes no time, but spinning does: noapictimer leaves out a calibration.
timeout "${SINEW_KERNEL_TIMEOUT_S:-1100}" qemu-system-x86_64 -kernel "$kernel/vmlinux" -initrd "$work/initrd" \
  -nographic -no-reboot -nic none -m 1024 -icount shift=0,sleep=off -rtc clock=vm \
  -drive "file=$work/disk,format=raw,if=virtio" \
  -append "console=ttyS0 quiet panic=-1 no_timer_check mitigations=off noapictimer cryptomgr.notests" < /dev/null |
  sed -u -e 's/\r//g' -e 's/\x1b\[[0-9;?]*[a-zA-Z]//g' |
  tee "$work/console" || true
tar -xm -C "$results" -f "$work/disk" || true
part_results
