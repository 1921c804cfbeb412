#!/usr/bin/env bash
# Installs the Debian packages of the given lists that are missing. Works as root and with sudo.
set -euo pipefail

stop() {
  echo "deps: $1" >&2
  exit 1
}
as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

command -v dpkg-query apt-get >/dev/null || stop "this system has no apt-get; install by hand what stands in: $*"

missing=()
for package in $(sed 's/#.*//' "$@" | awk '{print $1}'); do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "deps: nothing to install"
  exit 0
fi

echo "deps: installing ${missing[*]}"
[ "$(id -u)" -eq 0 ] || command -v sudo >/dev/null ||
  stop "installing needs root or sudo; as root run: apt-get install ${missing[*]}"
as_root apt-get update -q || stop "apt-get update failed: is there a network, and may $(id -un) install packages?"
as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" ||
  stop "apt-get could not install: ${missing[*]}"
echo "deps: installed ${#missing[@]} packages"
