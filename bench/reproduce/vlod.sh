#!/bin/bash
# vlod        differences between view cells, and the size and speed of every codec; Table 2 and Figs. 9 and 14 of Chhugani et al. 2005
. "$(dirname "$0")/shared.sh"

codes() {
  local file
  file=$(matrix "$1")
  "$bench" vlod-tables --csv "$part/codes.csv" -- "$file"
}

codes_at_scale() { "$bench" vlod-tables --csv "$part/codes.csv" --scale "$1"; }

# walk FILE
walk() { "$bench" walk-deltas --csv "$part/walk.csv" "$1"; }
walk_of_matrix() {
  local file
  file=$(matrix "$1")
  walk "$file"
}
walk_of_level() { walk "$(level "$1")"; }

# compare CSV MATRIX [OPTION...]: each payload is decoded and compared.
compare() {
  local file
  file=$(matrix "$2")
  "$vismat" compare --orders natural,best --csv "$part/$1" "${@:3}" "$file"
}

worst_rows() { "$bench" row-failures --csv "$part/failures.csv" | grep -E '^row|delimiter'; }

steps() {
  local name share matrices=(oa_koth1.cells oa_koth1.faces ctf_inyard.faces ctf_compromise.cells oa_thor.faces)
  step 'view cells of artificial-1' make_matrix artificial-1
  for share in .0625 .25; do step "codes of differences: power plant at $share of its size" codes_at_scale "$share"; done
  if [ -n "$full" ]; then step --memory 8 'codes of differences: power plant at its full size' codes_at_scale 1; fi
  for name in $(present artificial-1 oa_koth1.cells oa_koth1.faces ctf_compromise.cells); do
    step "codes of differences: $name" codes "$name.differences"
  done
  step 'bytes along walks: artificial-1' walk_of_matrix artificial-1
  for name in $(present oa_koth1 ctf_inyard ctf_compromise); do step "bytes along walks: $name" walk_of_level "$name"; done
  for name in $(present artificial-1.differences artificial-1 "${matrices[@]}"); do
    step "every codec: $name" compare compare.csv "$name"
  done
  for name in $(present oa_koth1.faces ctf_inyard.faces oa_thor.faces); do
    step "every codec with equal columns once: $name" compare compare_distinct.csv "$name" --distinct
  done
  step 'rows that are worst' worst_rows
}

run_steps openarena-081-maps openarena-085-data openarena-088-data
