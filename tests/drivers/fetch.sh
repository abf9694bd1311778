#!/bin/sh
# SPDX-License-Identifier: MIT
# Brings what tests/drivers/boot.sh boots: the distribution's kernel with the modules of serial
# ports on USB, busybox and udev. They are unpacked into a folder, nothing is installed.
#
# usage: fetch.sh FOLDER
#   leaves vmlinuz, modules/ (in the order they are to be loaded) and root/ there
set -eu

folder=$1
[ -e "$folder/vmlinuz" ] && exit 0

rm -rf "$folder"
mkdir -p "$folder/debs" "$folder/modules" "$folder/root"
cd "$folder/debs"
# The package of the architecture depends on that of its newest kernel.
kernel=$(apt-cache depends linux-image-amd64 | sed -n 's/.*Depends: \(linux-image-[^ ]*\)/\1/p')
[ -n "$kernel" ] || {
    echo 'no linux-image-amd64 in the package lists (apt-get update)' >&2
    exit 1
}
# As root apt-get says that it could not become another user for this folder: no matter.
apt-get -qq download "$kernel" busybox-static udev libkmod2 >download.log 2>&1 || {
    cat download.log >&2
    exit 1
}
for package in busybox-static udev libkmod2; do
    dpkg-deb -x "$package"_*.deb ../root
done

wanted='usb/common/usb-common usb/core/usbcore usb/host/xhci-hcd usb/host/xhci-pci
    usb/serial/usbserial usb/serial/ftdi_sio'
for module in $wanted; do
    set -- "$@" "./lib/modules/${kernel#linux-image-}/kernel/drivers/$module.ko"
done
shift
dpkg-deb --fsys-tarfile "$kernel"_*.deb | tar -x -C .. "$@" "./boot/vmlinuz-${kernel#linux-image-}"
cd ..
number=0
for module in "$@"; do
    number=$((number + 1))
    mv "$module" "modules/$number-${module##*/}"
done
mv "boot/vmlinuz-${kernel#linux-image-}" vmlinuz
rm -r boot lib debs
