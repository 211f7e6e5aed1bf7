#!/bin/bash
# zach2003    Tables 1 and 2 of Zach and Karner 2003; --full takes every level that Debian packages
. "$(dirname "$0")/shared.sh"

# The columns of these matrices are the nodes of a tree of boxes, although their names do not say so.
own=out/zach2003/$([ -n "$full" ] && echo full || echo short)/.matrices

# import_level PLACE [PACKAGE]: a level's matrices, PACKAGE to tell namesakes apart. A Doom level has no faces.
import_level() {
  local kind kinds='cells faces' name
  name=$(basename "${1##*:}" .bsp)${2:+@$2}
  [[ $1 == *.bsp ]] || kinds=cells
  for kind in $kinds; do
    "$vismat" import "$1" --matrix "$kind" --tree bounds --nodes -o "$own/$name.$kind.bsp.h5" || return
  done
}

# tables MATRIX...: every payload is decoded and compared.
tables() {
  "$bench" zach-tables --out "$part" "$@" | tee "$part/zach_tables.txt" | grep --line-buffered '^[^ ]'
  /usr/bin/python3 bench/reproduce/table_structure.py "$@" >"$part/zach2003_structure.csv"
}

tables_of_city() {
  local file
  file=$(matrix "$1")
  tables "$file"
}

tables_of_level() {
  mkdir -p "$own"
  import_level "$(level "$1")"
  tables "$own/$1".*.bsp.h5
}

tables_of_package() {
  local name=${1#openarena-}
  mkdir -p "$own"
  rm -f "$own"/*"@$name".*
  every_level "$1" import_named "$name"
  tables "$own"/*"@$name".*.bsp.h5
}
import_named() { import_level "$2" "$1"; }

known_figures() { /usr/bin/python3 bench/reproduce/known_figures.py "$vismat" "$(level "$1")"; }

steps() {
  local name
  for name in $(present oa_koth1); do step "known figures of $name" known_figures "$name"; done
  for name in artificial-1 artificial-2; do step "tables of $name" tables_of_city "$name"; done
  if [ -n "$full" ]; then
    for name in $(every_package); do step "tables of the levels of $name" tables_of_package "$name"; done
  else
    for name in $(present oa_koth1 ctf_inyard czest2ctf czest3ctf E1M1 MAP01); do step "tables of $name" tables_of_level "$name"; done
  fi
}

if [ -n "$full" ]; then run_steps; else run_steps openarena-081-maps freedoom; fi
