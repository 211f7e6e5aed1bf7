#!/bin/bash
# lossy       merged view cells and objects, clusters and subsets: bytes against added entries; Table 3 of Zach and Karner 2003
. "$(dirname "$0")/shared.sh"

# curves MATRIX [OPTION...]: each coded matrix is compared with its source.
curves() {
  local file
  file=$(matrix "$1")
  "$bench" lossy-tables --csv "$part/curves.csv" "${@:2}" "$file"
}

# every_level_of PACKAGE: what the view cells of each level see of one another.
every_level_of() {
  local cells
  cells=$(mktemp -d out/matrices/part/levels-XXXXXX)
  every_level "$1" import_cells "$cells" "${1#openarena-}"
  "$bench" lossy-tables --csv "$part/levels.csv" --lost .05 --sides both --codecs xz "$cells"/*
  rm -r "$cells"
}
import_cells() { "$vismat" import "$3" --matrix cells --tree none -o "$1/$(basename "${3##*:}" .bsp)@$2.cells.bsp.h5"; }

failures() {
  local name files=()
  for name in "$@"; do files+=("$(matrix "$name")"); done
  "$bench" lossy-failures --out "$part" "${files[@]}"
}

subsets() {
  local file
  file=$(matrix "$1")
  "$bench" gotsman-tables --csv "$part/gotsman.csv" "$file"
}

# clusters SECONDS MATRIX, clusters SECONDS --scale SHARE
clusters() {
  local seconds=$1 file
  shift
  if [ "$1" != --scale ]; then
    file=$(matrix "$1")
    set -- "$file"
  fi
  "$bench" panne-search --csv "$part/panne.csv" --seconds "$seconds" "$@"
}

steps() {
  local name share seconds=15 failing
  local artificial=(artificial-1 artificial-2) nodes=(oa_koth1.cells.nodes oa_koth1.faces.nodes)
  local matrices=(oa_koth1.cells oa_koth1.faces ctf_inyard.faces ctf_compromise.cells oa_thor.faces)
  if [ -n "$full" ]; then
    seconds=300
    nodes+=({ctf_inyard,ctf_compromise,oa_thor}.{cells,faces}.nodes)
    matrices+=(ctf_inyard.cells ctf_compromise.faces oa_thor.cells)
  fi
  for name in "${artificial[@]}"; do step "view cells of $name" make_matrix "$name"; done
  for name in $(present "${artificial[@]}" "${nodes[@]}" "${matrices[@]}"); do step "bytes against added entries: $name" curves "$name"; done
  if [ -n "$full" ]; then
    for name in $(every_package); do step "5 % lost: every level of $name" every_level_of "$name"; done
  fi
  for name in $(present artificial-1 ${full:+artificial-2} "${matrices[@]}"); do
    step "grouping by seeds: $name" curves "$name" --no-lossless --methods seeds --sides cells --lost .05
  done
  for name in $(present oa_koth1.cells oa_koth1.faces ctf_compromise.cells); do
    step "merged and then in clusters: $name" curves "$name" --codecs panne --sides cells,both
  done
  mapfile -t failing < <(present artificial-1 oa_koth1.cells oa_koth1.cells.nodes)
  step 'where merging fails' failures "${failing[@]}"
  if [ -n "$full" ]; then set -- "${artificial[@]}" "${matrices[@]}"; else set -- artificial-1 oa_koth1.cells oa_koth1.faces; fi
  for name in $(present "$@"); do step "subsets over a tree of view cells: $name" subsets "$name"; done
  for name in $(present "${artificial[@]}" "${matrices[@]}"); do step "search for clusters: $name" clusters $seconds "$name"; done
  for share in .015625 ${full:+.0625}; do step "search for clusters: power plant at $share of its size" clusters $seconds --scale "$share"; done
}

if [ -n "$full" ]; then run_steps; else run_steps openarena-081-maps openarena-085-data openarena-088-data; fi
