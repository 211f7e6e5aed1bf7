# shellcheck shell=bash
# Sourced by ./check and ./reproduce, from the project's root: what both need before they can begin.

say() { printf '%s\n' "$*" >&2; }

# Installs what packages.txt names and dpkg does not have; asks no registry where nothing is missing.
install_packages() {
  command -v dpkg-query >/dev/null || { say "packages.txt names Debian 12 packages, and this system has no dpkg"; return 1; }
  local wanted installed missing log as_root=()
  wanted=$(sed 's/#.*//' packages.txt | xargs -n1 | sort -u)
  # shellcheck disable=SC2086  # one word a package
  installed=$({ dpkg-query -W -f='${db:Status-Status} ${Package}\n' $wanted 2>/dev/null || true; } | sed -n 's/^installed //p' | sort -u)
  missing=$(comm -23 <(echo "$wanted") <(echo "$installed") | xargs)
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { say "missing packages, and neither root nor sudo to install them: $missing"; return 1; }
    as_root=(sudo)
  fi
  say "installing $(wc -w <<<"$missing") packages: $missing"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0)
  # shellcheck disable=SC2086
  log=$({ "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends $missing; } 2>&1 </dev/null) && return 0
  tail -n 20 <<<"$log" >&2
  say "apt could not install: $missing"
  return 1
}

# build PRESET [TARGET...]: configures and builds; the configuration's words are shown only where it fails.
build() {
  local preset=$1 log
  shift
  log=$(cmake --preset "$preset" 2>&1) || { say "$log"; return 1; }
  cmake --build --preset "$preset" -j "$(nproc)" ${1:+--target "$@"}
}

# clock SECONDS: "2 min 05 s"
clock() { if [ "$1" -lt 60 ]; then echo "$1 s"; else printf '%d min %02d s\n' $(($1 / 60)) $(($1 % 60)); fi; }
