#!/bin/bash
# Runs a test program where SocketCAN is real: on this kernel if it has vcan, else under qemu (software emulation) with
# Debian's kernel, its CAN modules and the program in an initramfs. Ends with the program's exit code; 77 means skipped,
# and the last line says why.
#   run_on_kernel.sh PROGRAM CACHE_FOLDER
set -euo pipefail
program=$(realpath "$1")
cache=$2
skip() { echo "SKIPPED: $*"; exit 77; }

mkdir -p "$cache"
# Directly, where an interface can be made. candump and cangen take part.
if command -v candump cangen ip > /dev/null && ip link add dev sinewvcan0 type vcan 2> /dev/null; then
  echo "vcan of this kernel ($(uname -r))"
  ip link set sinewvcan0 up
  status=0
  SINEW_CAN_INTERFACE=sinewvcan0 "$program" || status=$?
  ip link del sinewvcan0 2> /dev/null || true
  exit $status
fi

for tool in qemu-system-x86_64 busybox cpio candump cangen; do
  command -v $tool > /dev/null ||
    skip "no $tool; apt-get install --no-install-recommends qemu-system-x86 busybox-static cpio can-utils"
done
[ "$(uname -m)" = x86_64 ] || skip "the programs are of $(uname -m), the emulated machine of x86_64"

# The kernel package is fetched once and unpacked, never installed.
package=$(apt-cache depends linux-image-amd64 2> /dev/null | awk '/Depends/{print $2; exit}') || true
[ -n "$package" ] || skip "apt knows no linux-image-amd64; apt-get update"
kernel=$cache/$package
if [ ! -e "$kernel/complete" ]; then
  rm -rf "$kernel"
  mkdir -p "$kernel"
  (cd "$kernel" && apt-get download -q -o APT::Sandbox::User=root "$package") > "$kernel/download.log" 2>&1 ||
    skip "$package cannot be downloaded: $(tail -1 "$kernel/download.log")"
  dpkg-deb --fsys-tarfile "$kernel"/*.deb | tar -x -C "$kernel" --wildcards './boot/vmlinuz-*' \
    '*/net/can/can.ko*' '*/net/can/can-raw.ko*' '*/drivers/net/can/dev/can-dev.ko*' '*/drivers/net/can/vcan.ko*'
  rm "$kernel"/*.deb
  touch "$kernel/complete"
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
mkdir -p "$root"/{bin,sbin,lib/modules,proc,sys,dev,tmp,usr/bin,etc}
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
for module in can can-raw can-dev vcan; do
  cp "$(find "$kernel" -name "$module.ko")" "$root/lib/modules/"
done
cat > "$root/init" <<'INIT'
#!/bin/busybox sh
/bin/busybox --install -s /bin
export PATH=/bin:/sbin:/usr/bin
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev
for module in can can-raw can-dev vcan; do insmod /lib/modules/$module.ko; done
ip link set lo up
ip link add dev vcan0 type vcan; ip link set vcan0 up
echo "kernel $(uname -r)"
SINEW_CAN_INTERFACE=vcan0 GTEST_COLOR=no /bin/test-program
echo "exit code $?"
poweroff -f
INIT
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) > "$work/initrd.gz"
timeout 85 qemu-system-x86_64 -kernel "$kernel"/boot/vmlinuz-* -initrd "$work/initrd.gz" -nographic \
  -no-reboot -nic none -m 512 -append "console=ttyS0 quiet panic=-1" < /dev/null |
  sed -u -e 's/\r//g' -e 's/\x1b\[[0-9;?]*[a-zA-Z]//g' | tee "$work/console"
grep -q '^exit code ' "$work/console" || { echo "the emulated machine did not finish"; exit 1; }
exit "$(sed -n 's/^exit code \([0-9]*\).*/\1/p' "$work/console" | tail -1)"
