#!/bin/bash
# layout      orders of columns and rows with lower bounds, section 6.1 and Figs. 6 and 12 of Chhugani et al. 2005; --full goes up to the paper's size
. "$(dirname "$0")/shared.sh"

# orders SIDE MATRIX
orders() {
  local file
  file=$(matrix "$2")
  "$bench" orders --out "$part" --side "$1" "$file"
}

distances() {
  local file
  file=$(matrix "$1")
  "$bench" distance-statistics --out "$part" "$file"
}

distances_of_synthetic() { "$bench" distance-statistics --out "$part" --scale .0625; }

# scale SCENE SHARE [--harder]: one size of the synthetic scenes.
scale() { "$bench" order-scale --scene "$1" --scale "$2" ${3:+"$3"} --csv "$part/scale_$1${3-}_$2.csv"; }

disk_walk() { "$bench" disk-walk --csv "$part/disk_walk.csv" "$(level "$1")"; }

flann() { "$bench" flann-recall --csv "$part/flann_recall.csv"; }

failures() {
  local name files=()
  for name in "$@"; do files+=("$(matrix "$name")"); done
  "$bench" order-failures --out "$part" "${files[@]}"
}

steps() {
  local name scene share matrices
  matrices=(artificial-1 artificial-2 ctf_compromise.cells oasago2.faces oa_koth1.cells oa_koth1.faces ctf_inyard.faces czest3ctf.cells)
  if [ -n "$full" ]; then
    matrices+=(ctf_compromise.faces oasago2.cells ctf_inyard.cells czest2ctf.cells oa_thor.cells czest2ctf.faces oa_thor.faces czest3ctf.faces)
  fi
  for name in artificial-1 artificial-2; do step "view cells of $name" make_matrix "$name"; done
  for name in $(present "${matrices[@]}"); do step "orders of columns: $name" orders columns "$name"; done
  for name in $(present artificial-1 ${full:+artificial-2} oa_koth1.cells oa_koth1.faces); do step "orders of rows: $name" orders rows "$name"; done
  for name in $(present artificial-1 artificial-2 ctf_compromise.cells oasago2.faces oa_koth1.cells oa_koth1.faces); do
    step "distances between points: $name" distances "$name"
  done
  step 'distances between points: synthetic scenes' distances_of_synthetic
  for scene in power-plant city; do
    for share in .015625 .0625 ${full:+.25}; do
      step "cost against size: $scene at $share of its size" scale "$scene" "$share"
      step "cost against size: harder $scene at $share of its size" scale "$scene" "$share" --harder
    done
  done
  if [ -n "$full" ]; then
    for scene in power-plant city; do step --memory 12 "cost against size: $scene at its full size" scale "$scene" 1; done
  fi
  for name in $(present oa_koth1 ctf_inyard oasago2 ctf_compromise); do step "disk reads on walks: $name" disk_walk "$name"; done
  step 'recall of FLANN' flann
  mapfile -t matrices < <(present artificial-1 czest3ctf.cells)
  step 'where orders fail' failures "${matrices[@]}"
}

run_steps openarena-081-maps openarena-085-data openarena-088-data
